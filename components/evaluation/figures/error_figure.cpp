#include "evaluation/figures/error_figure.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "common/geometry/angles.h"
#include "evaluation/figures/canvas.h"

namespace vismem {
namespace {

constexpr int kWidth = 1120;
constexpr int kHeight = 700;

/// A plot of one error on a logarithmic scale.
struct Panel {
  double top_px;
  double bottom_px;
  double low;   ///< value at the bottom
  double high;  ///< value at the top
  static constexpr double kLeft_px = 92.0;
  static constexpr double kRight_px = 1080.0;

  double u(double seconds, double end_s) const { return kLeft_px + (kRight_px - kLeft_px) * seconds / end_s; }
  double v(double value) const {
    const double fraction = std::log(std::clamp(value, low, high) / low) / std::log(high / low);
    return bottom_px + (top_px - bottom_px) * fraction;
  }
};

constexpr Panel kPosition{96.0, 356.0, 0.01, 30.0};
constexpr Panel kHeading{404.0, 640.0, 0.1, 180.0};

std::string formatted(const char* format, double value) {
  char text[64];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

double timeStep(double end_s) {
  for (const double step : {0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 30.0, 60.0, 120.0, 300.0, 600.0}) {
    if (end_s / step <= 14.0) return step;
  }
  return std::ceil(end_s / 14.0);
}

void drawAxes(Canvas& canvas, const Panel& panel, double end_s, const std::vector<double>& ticks,
              const std::string& title, double limit) {
  const double step = timeStep(end_s);
  for (int i = 0; i * step <= end_s * (1.0 + 1e-9); ++i) {
    const double u = panel.u(i * step, end_s);
    canvas.line({u, panel.top_px}, {u, panel.bottom_px}, colors::kGrid);
    canvas.text(formatted("%g", i * step), {u, panel.bottom_px + 17.0}, 8.5, colors::kFaintInk,
                Align::kCentre);
  }
  for (const double tick : ticks) {
    const double v = panel.v(tick);
    canvas.line({Panel::kLeft_px, v}, {Panel::kRight_px, v}, colors::kGrid);
    canvas.text(formatted("%g", tick), {Panel::kLeft_px - 8.0, v + 4.0}, 8.5, colors::kFaintInk,
                Align::kRight);
  }
  const double v = panel.v(limit);
  canvas.dashedLine({Panel::kLeft_px, v}, {Panel::kRight_px, v}, colors::kLost, 1.2);
  canvas.rectangle({Panel::kLeft_px, panel.top_px}, {Panel::kRight_px, panel.bottom_px}, colors::kFaintInk);
  canvas.text(title, {Panel::kLeft_px, panel.top_px - 9.0}, 10.0, colors::kInk, Align::kLeft, true);
}

struct Point {
  double seconds = 0.0;
  std::optional<double> value;
};

void drawCurve(Canvas& canvas, const Panel& panel, double end_s, const std::vector<Point>& points) {
  constexpr double kLongestGap_s = 1.0;
  std::vector<Eigen::Vector2d> piece;
  double last_s = 0.0;
  for (const Point& p : points) {
    if (!p.value || (!piece.empty() && p.seconds - last_s > kLongestGap_s)) {
      canvas.polyline(piece, colors::kEstimate, 1.6);
      piece.clear();
    }
    const double u = panel.u(p.seconds, end_s);
    if (!p.value) {
      canvas.line({u, panel.top_px}, {u, panel.top_px + 9.0}, colors::kLost, 1.5);
      continue;
    }
    piece.emplace_back(u, panel.v(*p.value));
    last_s = p.seconds;
    canvas.disc(piece.back(), 1.7, colors::kEstimate);
  }
  canvas.polyline(piece, colors::kEstimate, 1.6);
}

void drawSettled(Canvas& canvas, const Panel& panel, double end_s, double settled_s, double mean,
                 const std::string& mean_text) {
  const double u = panel.u(settled_s, end_s);
  canvas.line({u, panel.top_px}, {u, panel.bottom_px}, colors::kTruth, 1.8);
  const double v = panel.v(mean);
  canvas.line({u, v}, {Panel::kRight_px, v}, colors::kTruth, 1.8);
  const double width = canvas.textWidth(mean_text, 9.5, true);
  const Eigen::Vector2d at(Panel::kRight_px - 8.0, panel.bottom_px - 10.0);
  canvas.fill({at + Eigen::Vector2d(-width - 5, -15), at + Eigen::Vector2d(5, -15),
               at + Eigen::Vector2d(5, 6), at + Eigen::Vector2d(-width - 5, 6)},
              colors::kPaper, 0.9);
  canvas.text(mean_text, at, 9.5, colors::kTruth, Align::kRight, true);
}

}  // namespace

Eigen::Vector2d positionErrorPx(double seconds, double end_s, double error_m) {
  return {kPosition.u(seconds, end_s), kPosition.v(error_m)};
}

Eigen::Vector2d headingErrorPx(double seconds, double end_s, double error_rad) {
  return {kHeading.u(seconds, end_s), kHeading.v(radToDeg(error_rad))};
}

cv::Mat drawErrors(const ErrorFigure& figure) {
  const LocalizationScore& score = figure.score;
  Canvas canvas(kWidth, kHeight);
  canvas.text(figure.title, {Panel::kLeft_px, 34.0}, 14.5, colors::kInk, Align::kLeft, true);
  std::vector<Point> position;
  std::vector<Point> heading;
  for (const PoseError& e : score.errors) {
    const double t = toSeconds(e.stamp_us - score.start_us);
    position.push_back({t, e.position_m});
    heading.push_back({t, e.heading_rad ? std::optional(radToDeg(*e.heading_rad)) : std::nullopt});
  }
  const double end_s = position.empty() ? 1.0 : std::max(0.1, position.back().seconds);
  std::string subtitle = "no pose could be compared with the truth";
  if (score.settled_after_s) {
    subtitle = formatted("settled after %.1f s (green)", *score.settled_after_s);
  } else if (!score.errors.empty()) {
    subtitle = "not settled";
  }
  canvas.text(subtitle + ", dashed: what counts as right", {Panel::kLeft_px, 58.0}, 10.0, colors::kFaintInk);

  drawAxes(canvas, kPosition, end_s, {0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0}, "position error [m]",
           figure.limits.right_within_m);
  drawAxes(canvas, kHeading, end_s, {0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 90.0, 180.0}, "heading error [deg]",
           radToDeg(figure.limits.right_within_rad));
  canvas.text("time since the start [s]",
              {0.5 * (Panel::kLeft_px + Panel::kRight_px), kHeading.bottom_px + 40.0}, 10.0, colors::kInk,
              Align::kCentre);
  drawCurve(canvas, kPosition, end_s, position);
  drawCurve(canvas, kHeading, end_s, heading);
  if (score.settled_after_s && score.position_error_m) {
    drawSettled(canvas, kPosition, end_s, *score.settled_after_s, *score.position_error_m,
                formatted("mean from there on %.3f m", *score.position_error_m));
    drawSettled(canvas, kHeading, end_s, *score.settled_after_s, radToDeg(*score.heading_error_rad),
                formatted("mean from there on %.2f deg", radToDeg(*score.heading_error_rad)));
  }
  return canvas.finish();
}

}  // namespace vismem
