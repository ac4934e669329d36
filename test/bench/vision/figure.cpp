// The figure of a run: time against accuracy, and every measure side by side.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include "bench/vision/report.h"
#include "evaluation/figures/canvas.h"

namespace vismem {
namespace {

constexpr int kWidth = 1240;
constexpr double kMargin = 24.0;
constexpr double kTitle = 9.5;
constexpr double kText = 7.5;
constexpr double kPlotHeight = 300.0;
constexpr double kRow = 22.0;
constexpr Rgb kOurColor = colors::kEstimate;
constexpr Rgb kPeerColor = colors::kFaintInk;

std::string number(double value, int digits) {
  char text[32];
  std::snprintf(text, sizeof text, "%.*f", digits, value);
  return text;
}

const PhotographTable* tableOf(const VisionResults& results, const std::string& size) {
  for (const auto& table : results.photographs) {
    if (table.size == size) return &table;
  }
  return nullptr;
}

/// Places for labels of points in a scatter: right of the point, moved up or down where something is already.
class Places {
 public:
  void take(const Eigen::Vector2d& low, const Eigen::Vector2d& high) { taken_.emplace_back(low, high); }
  /// @return the left end of the text's base line.
  Eigen::Vector2d free(const Eigen::Vector2d& point, double width) {
    for (int step = 0;; ++step) {
      const double shift = (step % 2 == 0 ? 1.0 : -1.0) * kStep * ((step + 1) / 2);
      const Eigen::Vector2d at = point + Eigen::Vector2d(step == 0 ? 8.0 : 16.0, 4.0 + shift);
      const Eigen::AlignedBox2d box(at - Eigen::Vector2d(2, 9), at + Eigen::Vector2d(width + 2, 3));
      const bool hit = std::any_of(taken_.begin(), taken_.end(),
                                   [&](const Eigen::AlignedBox2d& other) { return other.intersects(box); });
      if (hit && step < kSteps) continue;
      taken_.push_back(box);
      return at;
    }
  }

 private:
  static constexpr double kStep = 6.0;
  static constexpr int kSteps = 40;
  std::vector<Eigen::AlignedBox2d> taken_;
};

/// Milliseconds on a logarithmic scale against F2.
void drawScatter(Canvas& canvas, const Eigen::Vector2d& low, const Eigen::Vector2d& high,
                 const SpeedTable& speed, const PhotographTable& accuracy) {
  struct Point {
    std::string name;
    double ms;
    double f2;
  };
  std::vector<Point> points;
  for (const auto& row : accuracy.rows) {
    const double ms = speed.msOf(row.detector);
    if (ms > 0.0) points.push_back({row.detector, ms, row.all.at[1].f()});
  }
  if (points.empty()) return;
  double from = 1e9;
  double to = 0.0;
  for (const auto& point : points) {
    from = std::min(from, point.ms);
    to = std::max(to, point.ms);
  }
  const double log_from = std::floor(std::log10(from) * 2.0) / 2.0;
  const double log_to = std::ceil(std::log10(to) * 2.0 + 0.6) / 2.0;
  const Eigen::Vector2d plot_low = low + Eigen::Vector2d(44, 26);
  const Eigen::Vector2d plot_high = high - Eigen::Vector2d(8, 34);
  const double f_low = 0.25;
  const double f_high = 0.85;
  const auto at = [&](double ms, double f2) {
    return Eigen::Vector2d(
        plot_low.x() + (std::log10(ms) - log_from) / (log_to - log_from) * (plot_high.x() - plot_low.x()),
        plot_high.y() - (f2 - f_low) / (f_high - f_low) * (plot_high.y() - plot_low.y()));
  };
  canvas.text(speed.size + ": F at 2 px against time", {low.x(), low.y() + 12}, kTitle, colors::kInk,
              Align::kLeft, true);
  for (double f2 = f_low + 0.05; f2 <= f_high + 1e-9; f2 += 0.1) {
    canvas.line({plot_low.x(), at(1, f2).y()}, {plot_high.x(), at(1, f2).y()}, colors::kGrid);
    canvas.text(number(f2, 1), {plot_low.x() - 6, at(1, f2).y() + 4}, kText, colors::kFaintInk,
                Align::kRight);
  }
  for (int decade = -3; decade <= 4; ++decade) {
    for (const int digit : {1, 2, 5}) {
      const double ms = digit * std::pow(10.0, decade);
      if (std::log10(ms) < log_from - 1e-9 || std::log10(ms) > log_to + 1e-9) continue;
      const double x = at(ms, f_low).x();
      canvas.line({x, plot_low.y()}, {x, plot_high.y()}, colors::kGrid);
      canvas.text(number(ms, ms < 0.1 ? 2
                             : ms < 1 ? 1
                                      : 0),
                  {x, plot_high.y() + 13}, kText, colors::kFaintInk, Align::kCentre);
    }
  }
  canvas.text("ms per image, one thread", {0.5 * (plot_low.x() + plot_high.x()), plot_high.y() + 28}, kText,
              colors::kFaintInk, Align::kCentre);
  Places places;
  std::sort(points.begin(), points.end(), [](const auto& a, const auto& b) { return a.f2 > b.f2; });
  for (const auto& point : points) {
    const Eigen::Vector2d px = at(point.ms, point.f2);
    places.take(px - Eigen::Vector2d::Constant(5.0), px + Eigen::Vector2d::Constant(5.0));
  }
  for (const auto& point : points) {
    const bool ours = point.name == kOurs;
    const Eigen::Vector2d px = at(point.ms, point.f2);
    canvas.disc(px, ours ? 5.0 : 3.5, ours ? kOurColor : kPeerColor);
    const double width = canvas.textWidth(point.name, kText, ours);
    const Eigen::Vector2d text = places.free(px, width);
    if (text.x() > px.x() + 9.0) canvas.line(px, text + Eigen::Vector2d(-2, -3), colors::kFaintInk, 0.7);
    canvas.text(point.name, text, kText, ours ? kOurColor : colors::kInk, Align::kLeft, ours);
  }
}

/// One measure of all detectors.
struct Column {
  std::string title;
  std::string note;  ///< which way is better
  std::map<std::string, double> values;
  int digits = 2;
};

std::vector<Column> columnsOf(const VisionResults& results) {
  std::vector<Column> columns;
  for (const auto& table : results.speed) {
    Column ms{"ms " + table.size, "less is better", {}, 2};
    for (const auto& row : table.rows) ms.values[row.detector] = row.ms;
    columns.push_back(std::move(ms));
  }
  for (const auto& table : results.photographs) {
    Column f1{"F 1 px", table.size + ", more", {}, 3};
    Column f2{"F 2 px", table.size + ", more", {}, 3};
    Column structural{"sF 5 px", table.size + ", more", {}, 3};
    Column fragments{"fragments", table.size + ", less", {}, 2};
    Column repeated{"repeated 1 px", table.size + ", more", {}, 3};
    for (const auto& row : table.rows) {
      f1.values[row.detector] = row.all.at[0].f();
      f2.values[row.detector] = row.all.at[1].f();
      structural.values[row.detector] = row.all.structural.f();
      fragments.values[row.detector] = row.all.fragments;
      repeated.values[row.detector] = row.repeatability.orthogonalShare();
    }
    for (Column* column : {&f1, &f2, &structural, &fragments, &repeated})
      columns.push_back(std::move(*column));
  }
  if (!results.exact.empty()) {
    Column rms3{"RMS px, noise 3", "exact edges, less", {}, 3};
    Column rms10{"RMS px, noise 10", "exact edges, less", {}, 3};
    for (const auto& row : results.exact) {
      rms3.values[row.detector] = row.rms_px_at_noise_3;
      rms10.values[row.detector] = row.rms_px_at_noise_10;
    }
    columns.push_back(std::move(rms3));
    columns.push_back(std::move(rms10));
  }
  return columns;
}

void drawColumn(Canvas& canvas, const Eigen::Vector2d& low, double width, const Column& column,
                const std::vector<std::string>& names) {
  double largest = 0.0;
  for (const auto& [name, value] : column.values) largest = std::max(largest, value);
  canvas.text(column.title, {low.x(), low.y() + 10}, kText, colors::kInk, Align::kLeft, true);
  canvas.text(column.note, {low.x(), low.y() + 24}, kText - 1.0, colors::kFaintInk);
  const double bar = width - 46.0;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto value = column.values.find(names[i]);
    if (value == column.values.end()) continue;
    const double y = low.y() + 34.0 + kRow * static_cast<double>(i);
    const double length = largest > 0.0 ? std::max(1.0, bar * value->second / largest) : 1.0;
    const bool ours = names[i] == kOurs;
    canvas.fill({{low.x(), y}, {low.x() + length, y}, {low.x() + length, y + 13}, {low.x(), y + 13}},
                ours ? kOurColor : kPeerColor, ours ? 1.0 : 0.55);
    canvas.text(number(value->second, column.digits), {low.x() + length + 4, y + 10}, kText,
                ours ? kOurColor : colors::kInk, Align::kLeft, ours);
  }
}

}  // namespace

cv::Mat drawFigure(const VisionResults& results) {
  std::vector<std::pair<const SpeedTable*, const PhotographTable*>> scatters;
  for (const auto& speed : results.speed) {
    if (const auto* accuracy = tableOf(results, speed.size)) scatters.emplace_back(&speed, accuracy);
  }
  const std::vector<Column> columns = columnsOf(results);
  constexpr int kPerRow = 6;
  constexpr double kNames = 100.0;
  std::vector<std::string> names;
  for (const auto& entry : measuredDetectors()) {
    const bool measured = std::any_of(columns.begin(), columns.end(), [&](const Column& column) {
      return column.values.count(entry.name) > 0;
    });
    if (measured) names.push_back(entry.name);
  }
  const double block = 34.0 + kRow * static_cast<double>(names.size()) + 22.0;
  const int blocks = static_cast<int>((columns.size() + kPerRow - 1) / kPerRow);
  const double top = 62.0;
  const double scatter_height = scatters.empty() ? 0.0 : kPlotHeight + 20.0;
  Canvas canvas(kWidth, static_cast<int>(top + scatter_height + block * blocks + 8.0));
  canvas.text("Line segment detectors, same run", {kMargin, 28}, 12.0, colors::kInk, Align::kLeft, true);
  canvas.text(results.machine, {kMargin, 46}, kText, colors::kFaintInk);
  const double each = (kWidth - 2 * kMargin) / std::max<std::size_t>(1, scatters.size());
  for (std::size_t i = 0; i < scatters.size(); ++i) {
    const double x = kMargin + each * static_cast<double>(i);
    drawScatter(canvas, {x, top}, {x + each - 16, top + kPlotHeight}, *scatters[i].first,
                *scatters[i].second);
  }
  const double width = (kWidth - 2 * kMargin - kNames) / kPerRow;
  for (int b = 0; b < blocks; ++b) {
    const double y = top + scatter_height + block * b;
    for (std::size_t i = 0; i < names.size(); ++i) {
      const bool ours = names[i] == kOurs;
      canvas.text(names[i], {kMargin, y + 34.0 + kRow * static_cast<double>(i) + 10}, kText,
                  ours ? kOurColor : colors::kInk, Align::kLeft, ours);
    }
    for (int c = 0; c < kPerRow; ++c) {
      const auto index = static_cast<std::size_t>(b * kPerRow + c);
      if (index >= columns.size()) break;
      drawColumn(canvas, {kMargin + kNames + width * c, y}, width - 8.0, columns[index], names);
    }
  }
  return canvas.finish();
}

}  // namespace vismem
