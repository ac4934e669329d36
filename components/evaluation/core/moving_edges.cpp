#include "evaluation/core/moving_edges.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "common/geometry/plane.h"
#include "common/geometry/pose.h"
#include "common/geometry/projection.h"

namespace vismem {
namespace {

// An observed segment belongs to an element whose projection is as near and parallel as this.
constexpr double kNear_px = 4.0;
constexpr double kLeastCosine = 0.99;

/// The observed segment that shows an element; null if there is none.
const ImageSegment* shownBy(const Segment2& projected, const std::vector<ImageSegment>& observed) {
  const Eigen::Vector2d along = (projected.b - projected.a).normalized();
  const double length = projected.length();
  const ImageSegment* best = nullptr;
  double longest_px = 0.0;
  for (const ImageSegment& segment : observed) {
    const Eigen::Vector2d a = segment.px.a - projected.a;
    const Eigen::Vector2d b = segment.px.b - projected.a;
    if ((b - a).normalized().dot(along) < kLeastCosine) continue;
    if (std::abs(cross2(along, a)) > kNear_px || std::abs(cross2(along, b)) > kNear_px) continue;
    const double overlap = std::min(length, b.dot(along)) - std::max(0.0, a.dot(along));
    if (overlap <= longest_px) continue;
    longest_px = overlap;
    best = &segment;
  }
  return best;
}

}  // namespace

void MovingEdges::add(const MemorySnapshot& memory, const ImageAnalysis& analysis, const Owner& owner) {
  const Pose3 T_odom_camera = toPose3(analysis.T_odom_robot) * analysis.T_robot_camera;
  for (const MemorySegment& element : memory.segments) {
    if (element.last_seen_us != memory.stamp_us && !element.confirmed) continue;
    ElementHistory& history = histories_[element.id];
    if (element.confirmed) history.confirmed_us = memory.stamp_us;
    if (element.last_seen_us != memory.stamp_us) continue;
    if (history.first_us == 0) history.first_us = memory.stamp_us;
    history.last_us = memory.stamp_us;
    const auto px = projectSegment(analysis.intrinsics, T_odom_camera, element.odom);
    const ImageSegment* const segment = px ? shownBy(*px, analysis.observed) : nullptr;
    const EdgeOwner shown = segment ? owner(segment->px) : EdgeOwner::kNone;
    history.still += shown == EdgeOwner::kStill;
    history.moving += shown == EdgeOwner::kMoving;
  }
}

std::vector<MemorySegment> MovingEdges::confirmedOf(const MemorySnapshot& memory) const {
  std::vector<MemorySegment> found;
  std::copy_if(memory.segments.begin(), memory.segments.end(), std::back_inserter(found),
               [&](const MemorySegment& element) {
                 const auto history = histories_.find(element.id);
                 return element.confirmed && history != histories_.end() && history->second.isOfMoving();
               });
  return found;
}

double MovingEdges::longestAfter_s() const {
  double longest_s = 0.0;
  for (const auto& [id, history] : histories_) {
    if (history.isOfMoving() && history.confirmed_us > 0)
      longest_s = std::max(longest_s, toSeconds(history.confirmed_us - history.last_us));
  }
  return longest_s;
}

}  // namespace vismem
