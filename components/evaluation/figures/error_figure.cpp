#include "evaluation/figures/error_figure.h"

#include <algorithm>
#include <cmath>

#include "common/config/text_format.h"
#include "common/geometry/angles.h"
#include "evaluation/figures/canvas.h"

namespace vismem {
namespace {

constexpr int kWidth = 1120;
constexpr int kHeight = 700;

/// Errors that are drawn at least [m, deg]: a logarithm has no zero.
constexpr double kLeastPosition_m = 0.001;
constexpr double kLeastHeading_deg = 0.01;

/// A plot of one error on a logarithmic scale.
struct Panel {
  double top_px;
  double bottom_px;
  double end_s;               ///< of the time axis
  std::vector<double> ticks;  ///< the first at the bottom, the last at the top
  static constexpr double kLeft_px = 92.0;
  static constexpr double kRight_px = 1080.0;

  double u(double seconds) const { return kLeft_px + (kRight_px - kLeft_px) * seconds / end_s; }
  double v(double value) const {
    const double low = ticks.front();
    const double high = ticks.back();
    const double fraction = std::log(std::clamp(value, low, high) / low) / std::log(high / low);
    return bottom_px + (top_px - bottom_px) * fraction;
  }
};

double endOf(const ErrorFigure& figure) {
  const auto& errors = figure.score.errors;
  if (errors.empty()) return 1.0;
  return std::max(0.1, toSeconds(errors.back().stamp_us - figure.score.start_us));
}

Panel positionPanel(const ErrorFigure& figure) {
  std::vector<double> values{figure.limits.right_within_m};
  for (const PoseError& e : figure.score.errors) {
    if (e.position_m) values.push_back(std::max(*e.position_m, kLeastPosition_m));
  }
  return {96.0, 356.0, endOf(figure), logarithmicTicks(values)};
}

Panel headingPanel(const ErrorFigure& figure) {
  std::vector<double> values{radToDeg(figure.limits.right_within_rad)};
  for (const PoseError& e : figure.score.errors) {
    if (e.heading_rad) values.push_back(std::max(radToDeg(*e.heading_rad), kLeastHeading_deg));
  }
  return {404.0, 640.0, endOf(figure), logarithmicTicks(values)};
}

/// The time axis: its unit and the distance of its marks.
struct TimeScale {
  const char* unit;
  double unit_s;
  double step;  ///< in units
};

TimeScale timeScale(double end_s) {
  constexpr double kMostMarks = 14.0;
  TimeScale scale{"s", 1.0, 0.1};
  if (end_s > 600.0) scale = {"min", 60.0, 1.0};
  if (end_s > 36'000.0) scale = {"h", 3600.0, 1.0};
  const double end = end_s / scale.unit_s;
  for (int i = 0; end / scale.step > kMostMarks; ++i) scale.step *= i % 3 == 1 ? 2.5 : 2.0;
  return scale;
}

void drawAxes(Canvas& canvas, const Panel& panel, const std::string& title, double limit) {
  const TimeScale time = timeScale(panel.end_s);
  for (int i = 0; i * time.step * time.unit_s <= panel.end_s * (1.0 + 1e-9); ++i) {
    const double u = panel.u(i * time.step * time.unit_s);
    canvas.line({u, panel.top_px}, {u, panel.bottom_px}, colors::kGrid);
    canvas.text(formatted("%g", i * time.step), {u, panel.bottom_px + 17.0}, 8.5, colors::kFaintInk,
                Align::kCentre);
  }
  for (const double tick : panel.ticks) {
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

/// @param longest_gap_s a longer time without a pose parts the curve.
void drawCurve(Canvas& canvas, const Panel& panel, const std::vector<Point>& points, double longest_gap_s) {
  std::vector<Eigen::Vector2d> piece;
  double last_s = 0.0;
  for (const Point& p : points) {
    if (!p.value || (!piece.empty() && p.seconds - last_s > longest_gap_s)) {
      canvas.polyline(piece, colors::kEstimate, 1.6);
      piece.clear();
    }
    const double u = panel.u(p.seconds);
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

void drawSettled(Canvas& canvas, const Panel& panel, double settled_s, double mean,
                 const std::string& mean_text) {
  const double u = panel.u(settled_s);
  canvas.line({u, panel.top_px}, {u, panel.bottom_px}, colors::kTruth, 1.8);
  const double v = panel.v(mean);
  canvas.line({u, v}, {Panel::kRight_px, v}, colors::kTruth, 1.8);
  // Beside the title, where no curve is.
  canvas.text(mean_text, {Panel::kRight_px, panel.top_px - 9.0}, 9.5, colors::kTruth, Align::kRight, true);
}

}  // namespace

std::vector<double> logarithmicTicks(const std::vector<double>& values) {
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  // Half a step of a decade is a factor of about 3.
  const int low = static_cast<int>(std::floor(2.0 * std::log10(*least) + 1e-6));
  const int high = std::max(low + 2, static_cast<int>(std::ceil(2.0 * std::log10(*most) + 0.05)));
  std::vector<double> ticks;
  for (int half = low; half <= high; ++half) {
    const int decade = half >= 0 ? half / 2 : -((1 - half) / 2);
    ticks.push_back((half - 2 * decade == 0 ? 1.0 : 3.0) * std::pow(10.0, decade));
  }
  return ticks;
}

Eigen::Vector2d positionErrorPx(const ErrorFigure& figure, double seconds, double error_m) {
  const Panel panel = positionPanel(figure);
  return {panel.u(seconds), panel.v(error_m)};
}

Eigen::Vector2d headingErrorPx(const ErrorFigure& figure, double seconds, double error_rad) {
  const Panel panel = headingPanel(figure);
  return {panel.u(seconds), panel.v(radToDeg(error_rad))};
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
  const Panel position_panel = positionPanel(figure);
  const Panel heading_panel = headingPanel(figure);
  std::string subtitle = "no pose could be compared with the truth";
  if (score.settled_after_s) {
    subtitle = formatted("settled after %.1f s (green)", *score.settled_after_s);
  } else if (!score.errors.empty()) {
    subtitle = "not settled";
  }
  canvas.text(subtitle + ", dashed: what counts as right", {Panel::kLeft_px, 58.0}, 10.0, colors::kFaintInk);

  drawAxes(canvas, position_panel, "position error [m]", figure.limits.right_within_m);
  drawAxes(canvas, heading_panel, "heading error [deg]", radToDeg(figure.limits.right_within_rad));
  canvas.text(std::string("time since the start [") + timeScale(position_panel.end_s).unit + "]",
              {0.5 * (Panel::kLeft_px + Panel::kRight_px), heading_panel.bottom_px + 40.0}, 10.0,
              colors::kInk, Align::kCentre);
  const double mean_step_s =
      position.empty() ? 0.0 : position_panel.end_s / static_cast<double>(position.size());
  const double longest_gap_s = std::max(1.0, 3.0 * mean_step_s);
  drawCurve(canvas, position_panel, position, longest_gap_s);
  drawCurve(canvas, heading_panel, heading, longest_gap_s);
  if (score.settled_after_s && score.position_error_m) {
    drawSettled(canvas, position_panel, *score.settled_after_s, *score.position_error_m,
                formatted("mean from there on %.3f m", *score.position_error_m));
    drawSettled(canvas, heading_panel, *score.settled_after_s, radToDeg(*score.heading_error_rad),
                formatted("mean from there on %.2f deg", radToDeg(*score.heading_error_rad)));
  }
  return canvas.finish();
}

}  // namespace vismem
