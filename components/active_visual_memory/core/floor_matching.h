/// @file Which floor segments are pieces or copies of one line. Pure. SPEC M2, M3.
#pragma once

#include <vector>

#include "active_visual_memory/core/ground_projector.h"
#include "common/geometry/segment.h"

namespace vismem {

/// True unless both edges know which side is brighter [grey levels of contrast] and disagree.
bool samePolarity(const Segment2& a, double strength_a, const Segment2& b, double strength_b);

/// Distance of two segments' lines where they lie beside each other, and how far their extents are apart
/// along `base` (negative: they overlap).
struct Neighbourhood {
  double angle_rad = 0.0;
  double distance_m = 0.0;
  double gap_m = 0.0;
};

/// @param base of length > 0.
Neighbourhood neighbourhood(const Segment2& base, const Segment2& other);

/// M2: joins floor segments of one image that are one line seen twice. Order is kept.
std::vector<FloorSegment> cleanDuplicates(const std::vector<FloorSegment>& segments, double max_angle_rad,
                                          double max_distance_m, double max_gap_m);

/// The same segment with its ends exchanged.
FloorSegment reversed(const FloorSegment& segment);

}  // namespace vismem
