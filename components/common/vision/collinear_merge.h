/// @file Joins collinear segments of one group whose ends are close. Pure. The core of V4, also used by
/// detectors.
#pragma once

#include <vector>

#include "common/geometry/segment.h"

namespace vismem {

struct CollinearMergeParams {
  double angle_rad = 0.07;  ///< between the directions over the full circle: polarity counts
  double offset_px = 1.5;   ///< of the shorter one's ends from the longer one's line
  double gap_px = 8.0;      ///< between the near ends along the line; overlapping pieces have none
};

struct GroupedSegment {
  Segment2 px;
  int group = 0;        ///< only segments of one group are joined
  double weight = 1.0;  ///< `value` is averaged with weight times length
  double value = 0.0;
};

/// Joins, pass by pass, the pairs with the smallest gaps, each segment at most once in a pass, until no pair
/// is left. A joined segment lies on the total-least-squares line of its parts (taken as rods of even
/// density) and reaches as far as they do. Segments without length are dropped.
/// @return in canonical order (by coordinates), whatever the order of the input.
std::vector<GroupedSegment> mergeCollinear(std::vector<GroupedSegment> segments,
                                           const CollinearMergeParams& params);

}  // namespace vismem
