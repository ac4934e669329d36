#include "localization/core/health.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/geometry/projection.h"

namespace vismem {
namespace {

constexpr double kReferenceWidth_px = 320.0;  // the size of image that the chapter's pixel values are for
constexpr double kReferenceHeight_px = 240.0;

/// Beyond a map of 20 m the fields pay for themselves only where something is near: searching goes on by
/// brute force outside, so the truncation changes speed alone.
constexpr double kTruncation_m = 2.0;

}  // namespace

MapIndex::Params chapterIndex(const LocalizerParams& params) {
  MapIndex::Params index;
  index.cell_m = params.cell_m;
  index.reach_m = kTruncation_m;
  index.build_fields = params.health.use_field;
  return index;
}

SamplingGrid::SamplingGrid(int width, int height, double top_px, double bottom_px) : width_(width) {
  const double scale = height / kReferenceHeight_px;
  double border = 0.0;
  while (border < height) {
    row_borders_.push_back(border);
    border += scale * (top_px + (bottom_px - top_px) * border / height);
  }
  row_borders_.push_back(height);
}

std::vector<Eigen::Vector2d> SamplingGrid::crossings(const Segment2& px) const {
  std::vector<double> fractions;
  const Eigen::Vector2d along = px.b - px.a;
  const auto addCrossing = [&](double from, double slope, double line, double low, double high) {
    if (slope == 0.0) return;
    const double fraction = (line - from) / slope;
    if (fraction >= low && fraction <= high) fractions.push_back(fraction);
  };
  for (std::size_t row = 0; row + 1 < row_borders_.size(); ++row) {
    const double top = row_borders_[row];
    const double bottom = row_borders_[row + 1];
    addCrossing(px.a.y(), along.y(), top, 0.0, 1.0);
    // The part of the segment inside this row meets the row's vertical lines.
    double low = 0.0;
    double high = 1.0;
    if (along.y() == 0.0) {
      if (px.a.y() < top || px.a.y() >= bottom) continue;
    } else {
      const double f0 = (top - px.a.y()) / along.y();
      const double f1 = (bottom - px.a.y()) / along.y();
      low = std::max(low, std::min(f0, f1));
      high = std::min(high, std::max(f0, f1));
      if (low >= high) continue;
    }
    for (double x = 0.0; x <= width_; x += bottom - top) addCrossing(px.a.x(), along.x(), x, low, high);
  }
  std::sort(fractions.begin(), fractions.end());
  std::vector<Eigen::Vector2d> points;
  double last = -1.0;
  const double length = along.norm();
  for (const double fraction : fractions) {
    // A corner of a cell is met by two lines at once.
    if (last >= 0.0 && (fraction - last) * length < 0.5) continue;
    points.push_back(px.a + fraction * along);
    last = fraction;
  }
  return points;
}

double imageHealth(const std::vector<ImagePoint>& points, const CameraIntrinsics& intrinsics,
                   const Pose3& T_world_camera, const MapIndex& map, double scale_px) {
  std::vector<std::vector<Segment2>> theoretical(static_cast<std::size_t>(map.labelCount()));
  for (int label = 0; label < map.labelCount(); ++label) {
    for (const Segment3& segment : map.segments(label)) {
      if (!projectSegment(intrinsics, T_world_camera, segment)) continue;
      if (const auto px = projectSegmentUnbounded(intrinsics, T_world_camera, segment)) {
        theoretical[static_cast<std::size_t>(label)].push_back(*px);
      }
    }
  }
  const double diagonal = std::hypot(intrinsics.width, intrinsics.height);
  double sum = 0.0;
  for (const ImagePoint& point : points) {
    const auto& lines = theoretical[static_cast<std::size_t>(point.label)];
    double nearest = lines.empty() ? diagonal : std::numeric_limits<double>::infinity();
    for (const Segment2& line : lines) nearest = std::min(nearest, distanceToSegment(point.px, line));
    sum += nearest;
  }
  return std::clamp(1.0 - sum / static_cast<double>(points.size()) / scale_px, 0.0, 1.0);
}

double memoryHealth(const std::vector<RememberedLine>& lines, const Pose2& T_world_robot, const MapIndex& map,
                    double scale_m) {
  double sum = 0.0;
  for (const RememberedLine& line : lines) {
    const Segment2 world = transform(T_world_robot, line.robot);
    sum += 0.5 * (map.distance(line.label, world.a) + map.distance(line.label, world.b));
  }
  return std::clamp(1.0 - sum / static_cast<double>(lines.size()) / scale_m, 0.0, 1.0);
}

void HealthObservation::set(const MemoryUpdate& update) {
  lines_.clear();
  points_.clear();
  if (params_.source != HealthSource::kImage && update.snapshot) {
    const Pose2 T_robot_odom = inverse(update.snapshot->T_odom_robot);
    for (const MemorySegment& segment : update.snapshot->segments) {
      const auto label = map_.floorLabelId(segment.label);
      if (!label) continue;
      const Segment2 robot = transform(T_robot_odom, segment.odom.floor());
      if (distanceToSegment(Eigen::Vector2d(0.0, 0.0), robot) > params_.memory_range_m) continue;
      lines_.push_back({robot, *label});
    }
  }
  if (params_.source != HealthSource::kMemory && update.analysis) {
    intrinsics_ = update.analysis->intrinsics;
    T_robot_camera_ = update.analysis->T_robot_camera;
    const SamplingGrid grid(intrinsics_.width, intrinsics_.height, params_.grid_top_px,
                            params_.grid_bottom_px);
    for (const ImageSegment& segment : update.analysis->observed) {
      const auto label = map_.labelId(segment.label);
      if (!label) continue;
      for (const Eigen::Vector2d& px : grid.crossings(segment.px)) points_.push_back({px, *label});
    }
  }
}

double HealthObservation::health(const Pose2& T_world_robot) const {
  double sum = 0.0;
  int functions = 0;
  if (!lines_.empty()) {
    sum += memoryHealth(lines_, T_world_robot, map_, params_.memory_scale_m);
    ++functions;
  }
  if (!points_.empty()) {
    const double scale_px = params_.image_scale_px * intrinsics_.width / kReferenceWidth_px;
    sum += imageHealth(points_, intrinsics_, toPose3(T_world_robot) * T_robot_camera_, map_, scale_px);
    ++functions;
  }
  return functions == 0 ? 0.0 : sum / functions;
}

}  // namespace vismem
