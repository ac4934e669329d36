/// @file Corners: where the edges of one surface meet. Pure. SPEC M9.
#pragma once

#include <span>
#include <vector>

#include "active_visual_memory/core/memory_element.h"
#include "common/visual_memory/memory_snapshot.h"

namespace vismem {

/// An edge's line is known much better than its ends, of which images show a pixel or two too little or too
/// much. Two ends that meet are told where their lines cross.
struct CornerParams {
  bool enabled = true;
  double min_angle_rad = 0.4;  ///< between both edges, and to a fold
  double reach_m = 0.03;       ///< an end lies so far from the corner ..
  double reach_sigmas = 1.0;   ///< .. and so much of its best view's standard deviation ..
  double most_reach_m = 0.12;  ///< .. but never more than this
  // What is confirmed by its corners:
  int min_views = 3;           ///< of either end
  double min_length_m = 0.12;  ///< the direction of less is that of its ends' errors
  // What is confirmed by a confirmed edge that it begins or ends at:
  double least_height_m = 0.06;  ///< lower edges count as lying on the floor
  double sigmas = 2.0;           ///< of what is not known of both lines
  double slack_m = 0.01;         ///< added to that
  double max_line_rad = 0.06;    ///< between an edge and what goes on in its line
  double least_length_m = 0.25;  ///< of what is confirmed so
};

/// Publishes as confirmed what goes on in the line of a confirmed edge where that ends, or meets it there at
/// a corner as an edge of the same thing. An edge that is higher, seen from one place, lies elsewhere:
/// further from the camera by h / (H - h) of its distance, and would be in line with the other one, or end
/// where that ends, by chance only. What is confirmed so confirms the next. Only what has a label and was
/// seen to both its ends and across the viewing ray; nothing that was seen to stand.
/// @param camera_height_m H.
void confirmContinuations(std::span<MemoryElement> elements, double camera_height_m,
                          const CornerParams& params);

/// Publishes as confirmed what runs from the end of one confirmed edge of the same thing to the beginning of
/// another one: both its ends lie on the floor, so all of it does. An image from one place is enough for
/// that. Only what has a label; nothing that was seen to stand.
void confirmBetweenCorners(std::span<MemoryElement> elements, const CornerParams& params);

/// Moves the confirmed ends that meet in `segments`. Walking along an edge with its brighter side on the
/// left, the next edge of the same surface begins where this one ends: an end b meets an end a. Ends that are
/// hidden or cut by the border meet nothing. @param elements what the segments were taken from.
void meetAtCorners(std::vector<MemorySegment>& segments, std::span<const MemoryElement> elements,
                   const CornerParams& params);

}  // namespace vismem
