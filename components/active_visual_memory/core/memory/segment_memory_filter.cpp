// SegmentMemory: EKF-SLAM update of odometry drift, camera tilt and line landmarks.
#include <algorithm>
#include <cmath>

#include "active_visual_memory/core/memory/segment_memory_view.h"

namespace vismem {

std::optional<Correction> SegmentMemory::updateMapFilter(const Associations& associations, const View& view,
                                                         MapFilter* filter) const {
  residuals_.clear();
  const TiltView view_tilt(view.T_odom_camera, view.observation.T_odom_robot.theta);
  for (std::size_t p = 0; p < associations.seen.size(); ++p) {
    const MemoryElement& element = elements_[associations.index_of[p]];
    if (!map_filter_.contains(element.value.id)) continue;
    const double shift = element.plane.possibleShift(planeView(view), params_.confirmation.parallax);
    for (const FloorSegment* piece : associations.seen[p]) {
      if (residuals_.size() >= MapFilter::kMaxResiduals) break;
      const double distance = view.distanceTo(*piece);
      const double slack = std::hypot(params_.gates.slack_m + kSlackShare * distance, shift);
      addLineResiduals(element.value.id, element.line, *piece, view_tilt, slack,
                       kCorrelationInflation * kCorrelationInflation, kEndInflation, kMaxEndShift_m,
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
