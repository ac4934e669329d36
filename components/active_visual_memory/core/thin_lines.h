/// @file Lines of paint that are only a pixel or two wide: where their edges really are. Pure. SPEC M1.
#pragma once

#include <vector>

#include "common/vision/image_segment.h"

namespace vismem {

struct ThinLineParams {
  /// Blur of image and detector together [px]; 0: edges are taken as they are. The edges of a line thinner
  /// than the blur are found too far apart, by up to this much each: at 3 m that is a decimetre on the floor.
  double sigma_px = 1.2;
  double max_width_px = 5.0;    ///< wider lines are found where they are
  double max_angle_rad = 0.07;  ///< between both edges
  double min_overlap = 0.5;     ///< of the shorter edge
};

/// Half the width of a line whose edges are seen `half_seen_px` from its middle: the steepest places of a bar
/// of half width h, blurred by sigma, lie at x with h = x tanh(x h / sigma^2).
/// @return in [0, half_seen_px].
double halfWidthOfLine(double half_seen_px, double sigma_px);

/// Moves the two edges of each thin line (opposite polarity, close, parallel) to where they are.
/// @param segments ideal pixels. @return the same segments in the same order.
std::vector<ImageSegment> correctThinLines(const std::vector<ImageSegment>& segments,
                                           const ThinLineParams& params);

}  // namespace vismem
