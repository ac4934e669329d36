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
  struct Foot {
    const MemoryElement* element;
    Segment2 line;
    double most_strength;  ///< of an edge of its shadow
  };
  std::vector<Foot> feet;
  for (const MemoryElement& element : elements) {
    if (!element.value.confirmed || !element.colours) continue;
    feet.push_back({&element, element.line.segment(), params.strength_share * element.strength});
  }
  for (MemorySegment& segment : segments) {
    if (!segment.confirmed) continue;
    const MemoryElement* element = findElement(elements, segment.id);
    if (!element || !element->colours) continue;
    const Segment2 line = element->line.segment();
    const double strength = element->strength;
    const bool of_shadow = std::any_of(feet.begin(), feet.end(), [&](const Foot& foot) {
      return strength <= foot.most_strength && encloseDarkStrip(line, foot.line, params) &&
             foot.element->value.label == segment.label &&
             (foot.element->colours->left - element->colours->left).cwiseAbs().maxCoeff() >
                 params.min_difference;
    });
    if (of_shadow) segment.confirmed = false;
  }
}

}  // namespace vismem
