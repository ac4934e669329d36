#include "localization/core/likelihood/chapter_health.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace vismem {
namespace {

constexpr double kReferenceWidth_px = 320.0;  // image width of the chapter's pixel values

/// Truncation of the fields. Beyond it all lines of the label are searched: it affects speed only.
constexpr double kIndexReach_m = 2.0;

}  // namespace

MapIndex::Params chapterIndex(const MapParams& map) {
  MapIndex::Params index;
  index.cell_m = map.cell_m;
  index.reach_m = kIndexReach_m;
  return index;
}

double imageHealth(const std::vector<ImagePoint>& points, const CameraIntrinsics& intrinsics,
                   const Pose3& T_world_camera, const MapIndex& map, double scale_px,
                   std::vector<Segment2>& buffer) {
  const SegmentProjector projector(intrinsics, T_world_camera);
  double sum = 0.0;
  int label = -1;
  for (const ImagePoint& point : points) {
    if (point.label != label) {
      label = point.label;
      buffer.clear();
      for (const Segment3& segment : map.segments(label)) {
        const auto px = projector.unbounded(segment);
        if (px && projector.isInImage(*px)) buffer.push_back(*px);
      }
    }
    double square = buffer.empty() ? scale_px * scale_px : std::numeric_limits<double>::infinity();
    for (const Segment2& line : buffer) {
      square = std::min(square, awayFromSegment(point.px, line).squaredNorm());
    }
    sum += std::sqrt(square);
  }
  return std::clamp(1.0 - sum / static_cast<double>(points.size()) / scale_px, 0.0, 1.0);
}

double memoryHealth(const std::vector<RememberedLine>& lines, const Pose2& T_world_robot, const MapIndex& map,
                    double scale_m) {
  const double most = 2.0 * static_cast<double>(lines.size()) * scale_m;  // sum at which the health is 0
  double sum = 0.0;
  for (const RememberedLine& line : lines) {
    const Segment2 world = transform(T_world_robot, line.robot);
    sum += map.distance(line.label, world.a) + map.distance(line.label, world.b);
  }
  return std::clamp(1.0 - sum / most, 0.0, 1.0);
}

void HealthObservation::set(const MemoryUpdate& update) {
  lines_.clear();
  points_.clear();
  if (params_.source != ObservationSource::kImage && update.snapshot) {
    const Pose2 T_robot_odom = inverse(update.snapshot->T_odom_robot);
    for (const MemorySegment& segment : update.snapshot->segments) {
      const auto label = map_.floorLabelId(segment.label);
      if (!label) continue;
      const Segment2 robot = transform(T_robot_odom, segment.odom.floor());
      if (distanceToSegment(Eigen::Vector2d(0.0, 0.0), robot) > params_.memory_range_m) continue;
      lines_.push_back({robot, *label});
    }
  }
  if (params_.source != ObservationSource::kMemory && update.analysis) {
    intrinsics_ = update.analysis->intrinsics;
    T_robot_camera_ = update.analysis->T_robot_camera;
    const SamplingGrid grid(intrinsics_.width, intrinsics_.height, params_.grid_top_px,
                            params_.grid_bottom_px);
    for (const ImageSegment& segment : update.analysis->observed) {
      const auto label = map_.labelId(segment.label);
      if (!label) continue;
      for (const Eigen::Vector2d& px : grid.crossings(segment.px)) points_.push_back({px, *label});
    }
    std::stable_sort(points_.begin(), points_.end(),
                     [](const ImagePoint& a, const ImagePoint& b) { return a.label < b.label; });
  }
}

double HealthObservation::imageScale() const {
  return params_.image_scale_px * intrinsics_.width / kReferenceWidth_px;
}

double HealthObservation::health(const Pose2& T_world_robot) const {
  double sum = 0.0;
  int functions = 0;
  if (!lines_.empty()) {
    sum += memoryHealth(lines_, T_world_robot, map_, params_.memory_scale_m);
    ++functions;
  }
  if (!points_.empty()) {
    sum += imageHealth(points_, intrinsics_, toPose3(T_world_robot) * T_robot_camera_, map_, imageScale(),
                       in_view_);
    ++functions;
  }
  return functions > 0 ? sum / functions : 0.0;
}

}  // namespace vismem
