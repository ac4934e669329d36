#include "localization/core/likelihood/negative_information.h"

#include <algorithm>
#include <cmath>

#include "common/geometry/angles.h"
#include "common/geometry/projection.h"

namespace vismem {
namespace {

/// A piece of the map counts as observed with a point of its label and direction this near. Larger than a
/// pose error, because the likelihood already rates the distance.
constexpr double kSeenWithin_m = 0.3;
constexpr double kSeenWithin_rad = degToRad(30);
/// Share of a segment that may be missing without penalty: detectors break segments.
constexpr double kToleratedShare = 0.3;
constexpr double kCertainLength_m = 0.5;  // visible length from which the detection probability is full
constexpr double kMostDetection = 0.5;    // bounds the penalty at log 0.5 per segment

}  // namespace

void NegativeInformation::observe(const ImageAnalysis& analysis, const FloorObservation& observation) {
  view_.reset();
  seen_.assign(observation.points.begin() + static_cast<std::ptrdiff_t>(observation.remembered),
               observation.points.end());
  for (const FloorPoint& point : seen_) known_labels_.insert(point.label);
  // An image without any segment (an occluded camera) gives no penalty.
  if (analysis.observed.empty()) return;
  if (analysis.intrinsics.width <= 0 || !(analysis.T_robot_camera.translation().z() > 0.0)) return;
  view_.emplace(analysis.intrinsics, analysis.T_robot_camera);
  camera_ = analysis.T_robot_camera.translation().head<2>();
  obstacles_.clear();
  for (const ImageSegment& segment : analysis.observed) {
    if (map_.labelId(segment.label)) continue;
    const auto onFloor = [&](const Eigen::Vector2d& px) {
      return backProjectToGround(analysis.intrinsics, analysis.T_robot_camera, px, range_m_);
    };
    const auto a = onFloor(segment.px.a);
    const auto b = onFloor(segment.px.b);
    if (a && b) obstacles_.push_back({a->head<2>(), b->head<2>()});
  }
}

double NegativeInformation::logPenalty(const Pose2& T_world_robot) const {
  if (!view_) return 0.0;
  visible_.around(T_world_robot, range_m_, obstacles_, &*view_, expected_);
  std::erase_if(expected_,
                [this](const VisiblePoint& point) { return !known_labels_.contains(point.label); });
  std::sort(expected_.begin(), expected_.end(),
            [](const VisiblePoint& a, const VisiblePoint& b) { return a.segment < b.segment; });
  double sum = 0.0;
  for (std::size_t first = 0; first < expected_.size();) {
    double length = 0.0;
    double missed = 0.0;
    double range = 0.0;
    std::size_t i = first;
    for (; i < expected_.size() && expected_[i].segment == expected_[first].segment; ++i) {
      const VisiblePoint& point = expected_[i];
      length += point.length_m;
      range += point.length_m * (point.p_robot - camera_).norm();
      const bool is_seen = std::any_of(seen_.begin(), seen_.end(), [&](const FloorPoint& other) {
        return other.label == point.label &&
               (other.p_robot - point.p_robot).squaredNorm() < kSeenWithin_m * kSeenWithin_m &&
               lineAngleDifference(other.direction_robot, point.direction_robot) < kSeenWithin_rad;
      });
      if (!is_seen) missed += point.length_m;
    }
    first = i;
    range /= length;
    const double reach = std::max(0.0, 1.0 - std::pow(range / range_m_, 2));
    const double detection = std::min(
        kMostDetection, params_.detection_probability * reach * std::min(1.0, length / kCertainLength_m));
    const double share = std::max(0.0, missed / length - kToleratedShare) / (1.0 - kToleratedShare);
    sum += share * std::log(1.0 - detection);
  }
  return sum;
}

}  // namespace vismem
