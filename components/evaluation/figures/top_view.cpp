#include "evaluation/figures/top_view.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "common/geometry/angles.h"
#include "evaluation/figures/canvas.h"

namespace vismem {
namespace {

constexpr double kMargin_px = 56.0;
constexpr double kHeader_px = 74.0;
constexpr double kLegend_px = 268.0;
constexpr double kPlotWidth_px = 1000.0;
constexpr double kPlotHeight_px = 820.0;
/// The published pose jumps when another race wins: jumps are not drawn as a path.
constexpr double kJump_m = 0.5;
/// Remembered segments not seen for longer are drawn paler.
constexpr StampUs kRecentlySeen_us = 3 * kSecondUs;
/// Of the memory's colour where a segment was not seen lately.
constexpr double kPale = 0.45;

void drawGrid(Canvas& canvas, const TopViewFrame& frame, double width_m, double height_m) {
  const double step = gridStep(frame.px_per_m);
  for (double x = std::ceil(frame.low_world.x() / step) * step; x <= frame.low_world.x() + width_m;
       x += step) {
    const double u = frame.toPx({x, 0.0}).x();
    canvas.line({u, frame.low_px.y()}, {u, frame.high_px.y()}, colors::kGrid, 1.0);
    canvas.text(metresText(x), {u, frame.high_px.y() + 18.0}, 8.5, colors::kFaintInk, Align::kCentre);
  }
  for (double y = std::ceil(frame.low_world.y() / step) * step; y <= frame.low_world.y() + height_m;
       y += step) {
    const double v = frame.toPx({0.0, y}).y();
    canvas.line({frame.low_px.x(), v}, {frame.high_px.x(), v}, colors::kGrid, 1.0);
    canvas.text(metresText(y), {frame.low_px.x() - 7.0, v + 4.0}, 8.5, colors::kFaintInk, Align::kRight);
  }
}

void drawScaleBar(Canvas& canvas, const TopViewFrame& frame) {
  const double length = gridStep(frame.px_per_m);
  const Eigen::Vector2d b = frame.high_px - Eigen::Vector2d(18.0, 18.0);
  const Eigen::Vector2d a = b - Eigen::Vector2d(length * frame.px_per_m, 0.0);
  canvas.fill({a + Eigen::Vector2d(-9, -24),
               {b.x() + 9, a.y() - 24},
               b + Eigen::Vector2d(9, 9),
               {a.x() - 9, b.y() + 9}},
              colors::kPaper, 0.85);
  canvas.line(a, b, colors::kInk, 2.5);
  for (const auto& end : {a, b}) {
    canvas.line(end - Eigen::Vector2d(0, 5), end + Eigen::Vector2d(0, 5), colors::kInk, 2.0);
  }
  canvas.text(metresText(length), 0.5 * (a + b) - Eigen::Vector2d(0, 9), 9.5, colors::kInk, Align::kCentre);
}

void drawPath(Canvas& canvas, const TopViewFrame& frame, const Trajectory& path, Rgb color, double width,
              double longest_step_m) {
  std::vector<Eigen::Vector2d> piece;
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (i > 0 && (path[i].pose.position() - path[i - 1].pose.position()).norm() > longest_step_m) {
      canvas.polyline(piece, color, width);
      piece.clear();
    }
    piece.push_back(frame.toPx(path[i].pose.position()));
  }
  canvas.polyline(piece, color, width);
}

void drawEstimate(Canvas& canvas, const TopViewFrame& frame, const TopView& view) {
  Trajectory before;
  Trajectory after;
  for (const StampedPose& p : view.estimate) {
    const bool settled = view.settled_us && p.stamp_us >= *view.settled_us;
    (settled || view.truth.empty() ? after : before).push_back(p);
  }
  for (const StampedPose& p : before) {
    canvas.disc(frame.toPx(p.pose.position()), 2.5, colors::kEstimate, 0.35);
  }
  drawPath(canvas, frame, after, colors::kEstimate, 2.0, kJump_m);
}

/// A triangle that points ahead. @param size from the middle to the tip [px].
void drawPose(Canvas& canvas, const TopViewFrame& frame, const Pose2& pose, double size, Rgb color,
              double opacity) {
  const Eigen::Vector2d centre = frame.toPx(pose.position());
  const auto corner = [&](double angle, double radius) {
    return Eigen::Vector2d(centre.x() + radius * std::cos(pose.theta + angle),
                           centre.y() - radius * std::sin(pose.theta + angle));
  };
  canvas.fill({corner(0.0, size), corner(2.5, 0.8 * size), corner(std::numbers::pi, 0.35 * size),
               corner(-2.5, 0.8 * size)},
              color, opacity);
}

void drawView(Canvas& canvas, const TopViewFrame& frame, const Pose2& robot, const ViewCone& view) {
  std::vector<Eigen::Vector2d> sector{frame.toPx(robot.position())};
  for (int i = 0; i <= 24; ++i) {
    const double angle = view.heading_rad + view.opening_rad * (i / 24.0 - 0.5);
    sector.push_back(
        frame.toPx(robot.position() + view.range_m * Eigen::Vector2d(std::cos(angle), std::sin(angle))));
  }
  canvas.fill(sector, {250, 205, 60}, 0.30);
}

Rgb mixed(Rgb color, Rgb with, double share) {
  const auto mix = [share](int a, int b) {
    return static_cast<int>(std::lround(share * a + (1.0 - share) * b));
  };
  return {mix(color.r, with.r), mix(color.g, with.g), mix(color.b, with.b)};
}

Rgb memoryColor(const LabelledSegment& segment) {
  return segment.unseen_us <= kRecentlySeen_us ? colors::kMemory
                                               : mixed(colors::kMemory, colors::kPaper, kPale);
}

/// In the order of last sight, so that segments seen lately are drawn on top.
void drawMemory(Canvas& canvas, const TopViewFrame& frame, std::vector<LabelledSegment> memory) {
  std::stable_sort(memory.begin(), memory.end(), [](const LabelledSegment& a, const LabelledSegment& b) {
    return a.unseen_us > b.unseen_us;
  });
  for (const LabelledSegment& s : memory) {
    const Eigen::Vector2d a = frame.toPx(s.world.a.head<2>());
    const Eigen::Vector2d b = frame.toPx(s.world.b.head<2>());
    if (!s.confirmed) {
      canvas.dashedLine(a, b, memoryColor(s));
      continue;
    }
    canvas.line(a, b, memoryColor(s), 2.0);
    canvas.disc(a, 2.2, memoryColor(s));
    canvas.disc(b, 2.2, memoryColor(s));
  }
}

class Legend {
 public:
  Legend(Canvas& canvas, const Eigen::Vector2d& at) : canvas_(canvas), at_(at) {}

  void heading(const std::string& text) {
    at_.y() += 8.0;
    canvas_.text(text, at_ + Eigen::Vector2d(0, 4), 9.5, colors::kFaintInk, Align::kLeft, true);
    at_.y() += 23.0;
  }
  void stroke(const std::string& text, Rgb color, double width) {
    canvas_.line(at_, at_ + Eigen::Vector2d(30, 0), color, width);
    label(text);
  }
  void dashes(const std::string& text, Rgb color) {
    canvas_.dashedLine(at_, at_ + Eigen::Vector2d(30, 0), color);
    label(text);
  }
  void mark(const std::string& text, Rgb color, double opacity) {
    canvas_.disc(at_ + Eigen::Vector2d(15, 0), 5.0, color, opacity);
    label(text);
  }
  void area(const std::string& text, Rgb color, double opacity) {
    canvas_.fill({at_ + Eigen::Vector2d(2, -6), at_ + Eigen::Vector2d(28, -6), at_ + Eigen::Vector2d(28, 6),
                  at_ + Eigen::Vector2d(2, 6)},
                 color, opacity);
    label(text);
  }

 private:
  void label(const std::string& text) {
    canvas_.text(text, at_ + Eigen::Vector2d(40, 5), 10.0);
    at_.y() += 24.0;
  }
  Canvas& canvas_;
  Eigen::Vector2d at_;
};

std::map<Label, Rgb> labelColors(const SegmentMap& map) {
  std::set<Label> labels;
  for (const MapSegment& s : map.segments) labels.insert(s.label);
  std::map<Label, Rgb> colors;
  for (const Label& label : labels) colors.emplace(label, categoryColor(static_cast<int>(colors.size())));
  return colors;
}

void drawLegend(Canvas& canvas, const TopViewFrame& frame, const TopView& view,
                const std::map<Label, Rgb>& label_colors) {
  Legend legend(canvas, {frame.high_px.x() + 26.0, frame.low_px.y() + 6.0});
  if (!label_colors.empty()) {
    legend.heading("MAP");
    for (const auto& [label, color] : label_colors) legend.stroke(label, color, 4.0);
  }
  legend.heading("PATHS");
  if (!view.truth.empty()) legend.stroke("truth", colors::kTruth, 3.0);
  if (!view.odometry.empty()) legend.stroke("odometry", colors::kOdometry, 2.0);
  if (!view.estimate.empty()) {
    legend.stroke("estimate", colors::kEstimate, 2.0);
    if (!view.truth.empty()) legend.mark("estimate, not settled", colors::kEstimate, 0.35);
  }
  legend.heading("AT THE END");
  if (!view.memory.empty()) {
    legend.stroke("memory (" + std::to_string(view.memory.size()) + ")", colors::kMemory, 2.5);
    const bool any_pale = std::any_of(view.memory.begin(), view.memory.end(), [](const LabelledSegment& s) {
      return s.unseen_us > kRecentlySeen_us;
    });
    const auto unconfirmed = std::count_if(view.memory.begin(), view.memory.end(),
                                           [](const LabelledSegment& s) { return !s.confirmed; });
    if (unconfirmed > 0)
      legend.dashes("not confirmed (" + std::to_string(unconfirmed) + ")", colors::kMemory);
    if (any_pale) legend.stroke("seen over 3 s ago", mixed(colors::kMemory, colors::kPaper, kPale), 2.5);
  }
  if (view.robot) legend.mark("robot, estimated", colors::kEstimate, 1.0);
  if (view.true_robot) legend.mark("robot, true", colors::kTruth, 1.0);
  if (view.races.size() > 1) legend.mark("other races", colors::kLost, 0.6);
  if (view.robot && view.view) legend.area("field of view", {250, 205, 60}, 0.45);
}

}  // namespace

TopViewFrame topViewFrame(const TopView& view) {
  Eigen::AlignedBox2d all;
  const auto add = [&](const Segment3& s) { all.extend(s.floor().a).extend(s.floor().b); };
  const auto addPath = [&](const Trajectory& path) {
    for (const StampedPose& p : path) all.extend(p.pose.position());
  };
  for (const MapSegment& s : view.map.segments) add(s.world);
  addPath(view.truth);
  if (view.map.segments.empty()) {
    addPath(view.odometry);
    addPath(view.estimate);
    for (const LabelledSegment& s : view.memory) add(s.world);
  }
  if (all.isEmpty()) all = {Eigen::Vector2d::Zero(), Eigen::Vector2d::Ones()};
  const double border = view.map.segments.empty() ? 0.3 : 0.6;
  const Eigen::Vector2d low = all.min() - Eigen::Vector2d::Constant(border);
  const Eigen::Vector2d size = all.max() - all.min() + Eigen::Vector2d::Constant(2.0 * border);
  TopViewFrame frame;
  frame.px_per_m = std::min(kPlotWidth_px / size.x(), kPlotHeight_px / size.y());
  frame.low_world = low;
  frame.low_px = {kMargin_px + 8.0, kHeader_px};
  // A narrow world still leaves room for the title.
  const double width = std::max(size.x() * frame.px_per_m, 420.0);
  frame.low_world.x() -= 0.5 * (width / frame.px_per_m - size.x());
  frame.high_px = frame.low_px + Eigen::Vector2d(width, size.y() * frame.px_per_m);
  return frame;
}

cv::Mat drawTopView(const TopView& view) {
  const TopViewFrame frame = topViewFrame(view);
  const double height = std::max(frame.high_px.y() + 36.0, kHeader_px + 470.0);
  Canvas canvas(static_cast<int>(std::ceil(frame.high_px.x() + kLegend_px)),
                static_cast<int>(std::ceil(height)));
  canvas.text(view.title, {kMargin_px + 8.0, 32.0}, 14.5, colors::kInk, Align::kLeft, true);
  canvas.text(view.subtitle, {kMargin_px + 8.0, 56.0}, 10.0, colors::kFaintInk);

  const Eigen::Vector2d size_m = (frame.high_px - frame.low_px) / frame.px_per_m;
  drawGrid(canvas, frame, size_m.x(), size_m.y());
  canvas.restrictTo(frame.low_px, frame.high_px);
  const std::map<Label, Rgb> label_colors = labelColors(view.map);
  if (view.robot && view.view) drawView(canvas, frame, *view.robot, *view.view);
  // Edges on the floor are drawn over edges above them: door feet over their lintels.
  std::vector<MapSegment> from_above = view.map.segments;
  std::stable_sort(from_above.begin(), from_above.end(), [](const MapSegment& a, const MapSegment& b) {
    return a.world.middle().z() > b.world.middle().z();
  });
  for (const MapSegment& s : from_above) {
    canvas.line(frame.toPx(s.world.a.head<2>()), frame.toPx(s.world.b.head<2>()), label_colors.at(s.label),
                std::max(4.0, s.width_m * frame.px_per_m));
  }
  drawPath(canvas, frame, view.truth, colors::kTruth, 3.0, kJump_m);
  drawPath(canvas, frame, view.odometry, colors::kOdometry, 1.5, kJump_m);
  drawEstimate(canvas, frame, view);
  drawMemory(canvas, frame, view.memory);
  for (const RaceReport& race : view.races) {
    if (!race.winner)
      drawPose(canvas, frame, race.T_world_robot, 10.0, colors::kLost, 0.3 + 0.5 * race.weight);
  }
  if (view.true_robot) drawPose(canvas, frame, *view.true_robot, 15.0, colors::kTruth, 1.0);
  if (view.robot) drawPose(canvas, frame, *view.robot, 13.0, colors::kEstimate, 1.0);
  drawScaleBar(canvas, frame);
  canvas.release();
  canvas.rectangle(frame.low_px, frame.high_px, colors::kFaintInk, 1.0);
  drawLegend(canvas, frame, view, label_colors);
  return canvas.finish();
}

std::vector<LabelledSegment> memoryInWorld(const MemorySnapshot& memory, const Pose2& T_world_odom) {
  std::vector<LabelledSegment> placed;
  for (const MemorySegment& s : memory.segments) {
    placed.push_back(
        {transform(T_world_odom, s.odom), s.label, memory.stamp_us - s.last_seen_us, s.confirmed});
  }
  return placed;
}

}  // namespace vismem
