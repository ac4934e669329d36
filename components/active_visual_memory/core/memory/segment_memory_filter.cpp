// SegmentMemory: EKF-SLAM update of odometry drift, camera tilt and line landmarks.
#include <algorithm>
#include <cmath>

#include "active_visual_memory/core/memory/segment_memory_view.h"

namespace vismem {
bool SegmentMemory::restingSuffice(const Associations& associations) const {
  const auto rests = [](const MemoryElement& element) { return element.plane.on_floor; };
  // A walking body tilts in each image, and new elements cost it more than they bring (experiment E4, field).
  if (isLegged()) return std::any_of(elements_.begin(), elements_.end(), rests);
  int resting = 0;
  for (std::size_t p = 0; p < associations.seen.size(); ++p)
    resting += !associations.seen[p].empty() && rests(elements_[associations.index_of[p]]);
  return resting >= kEnoughResting;
}

std::optional<Correction> SegmentMemory::updateMapFilter(const Associations& associations, const View& view,
                                                         MapFilter* filter) const {
  residuals_.clear();
  const TiltView view_tilt(view.T_odom_camera, view.observation.T_odom_robot.theta);
  const bool suffices = restingSuffice(associations);
  for (std::size_t p = 0; p < associations.seen.size(); ++p) {
    const MemoryElement& element = elements_[associations.index_of[p]];
    if (!map_filter_.contains(element.value.id)) continue;
    const double moved = element.plane.baseline(view.camera);
    // A new element may be another robot that drives ahead and would drag the memory along.
    if (suffices && !element.plane.on_floor && moved > params_.confirmation.parallax.min_step_m &&
        isNew(element, view.observation.frame.stamp_us)) {
      continue;
    }
    const double inflation = element.plane.on_floor || moved < params_.confirmation.parallax.min_step_m
                                 ? 1.0
                                 : kUnconfirmedInflation;
    const double noise = std::pow(kCorrelationInflation * inflation, 2);
    for (const FloorSegment* piece : associations.seen[p]) {
      if (residuals_.size() >= MapFilter::kMaxResiduals) break;
      const double distance = view.distanceTo(*piece);
      addLineResiduals(element.value.id, element.line, *piece, view_tilt,
                       params_.gates.slack_m + kSlackShare * distance, noise, kEndInflation, kMaxEndShift_m,
                       residuals_);
    }
  }
  const auto direction = params_.estimation.use_dominant_direction ? dominantDirection() : std::nullopt;
  directions_.clear();
  for (const MemoryElement& element : elements_) {
    if (direction && hasDirection(element) &&
        element.line.length() >= params_.estimation.dominant_direction.least_m) {
      directions_.push_back({element.value.id, element.line.direction()});
    }
  }
  const ImageMeasurements image{view.observation.T_odom_robot.position(), residuals_, direction, directions_};
  const MapFilter::Params& params = params_.estimation.map_filter;
  return filter ? filter->update(image, params) : map_filter_.preview(image, params);
}

void SegmentMemory::removeStaleLines() {
  // Elements off the floor do not measure the drift.
  map_filter_.retainIf([&](std::uint64_t id) {
    const MemoryElement* element = findElement(elements_, id);
    return element && !element->plane.stands;
  });
}

void SegmentMemory::join(MemoryElement& element, const MemoryElement& other) {
  // The better known line is kept in the filter.
  if (params_.estimation.enabled && other.line.offsetVariance(0.0) < element.line.offsetVariance(0.0)) {
    map_filter_.replaceLine(other.value.id, element.value.id);
  }
  absorb(element, other, params_.line);
}

}  // namespace vismem
