#include "active_visual_memory/core/markings/shadow_strips.h"

#include <algorithm>
#include <cmath>

#include "active_visual_memory/core/memory/duplicates.h"
#include "common/geometry/angles.h"
#include "common/geometry/plane.h"

namespace vismem {
namespace {

/// Is there a dark strip between both edges, each with its brighter side outward?
bool encloseDarkStrip(const Segment2& one, const Segment2& other, const ShadowParams& params) {
  const Eigen::Vector2d u = (one.b - one.a).normalized();
  const Eigen::Vector2d v = (other.b - other.a).normalized();
  if (u.dot(v) > -std::cos(params.max_angle_rad)) return false;
  const Neighbourhood near = neighbourhood(one, other);
  if (near.distance_m > params.width_m || -near.gap_m < 0.5 * std::min(one.length(), other.length())) {
    return false;
  }
  const Eigen::Vector2d between = other.middle() - one.middle();
  return cross2(u, between) < 0.0;  // on the darker side of `one`
}

}  // namespace

void withdrawShadows(std::vector<MemorySegment>& segments, std::span<const MemoryElement> elements,
                     const ShadowParams& params) {
  for (MemorySegment& segment : segments) {
    if (!segment.confirmed) continue;
    const MemoryElement* element = findElement(elements, segment.id);
    if (!element || !element->colours) continue;
    const bool of_shadow = std::any_of(elements.begin(), elements.end(), [&](const MemoryElement& foot) {
      return foot.value.confirmed && foot.value.label == segment.label && foot.colours &&
             element->strength <= params.strength_share * foot.strength &&
             encloseDarkStrip(element->line.segment(), foot.line.segment(), params) &&
             (foot.colours->left - element->colours->left).cwiseAbs().maxCoeff() > params.min_difference;
    });
    if (of_shadow) segment.confirmed = false;
  }
}

}  // namespace vismem
