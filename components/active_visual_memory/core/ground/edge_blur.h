/// @file Edges of line markings a few pixels wide, corrected for the blur of camera and detector. Pure. See
/// M1.
#pragma once

#include <vector>

#include "common/vision/image_segment.h"

namespace vismem {

struct EdgeBlurParams {
  /// Standard deviation of the blur of image and detector together [px]; 0: no correction. The edges of a
  /// line narrower than the blur are detected too far apart, at 3 m by up to 0.1 m each.
  double sigma_px = 1.2;
  double max_width_px = 5.0;    ///< wider lines are not corrected
  double max_angle_rad = 0.07;  ///< between both edges
  double min_overlap = 0.5;     ///< of the shorter edge
};

/// Half the width h of a line whose edges are detected at the distance x = `half_seen_px` from its middle.
/// The steepest points of a bar blurred by a Gaussian satisfy h = x tanh(x h / sigma^2).
/// @return in [0, half_seen_px].
double trueHalfWidth(double half_seen_px, double sigma_px);

/// Moves the two edges of each narrow line (opposite polarity, close, parallel) to their true places.
/// @param segments ideal pixels. @return the same segments in the same order.
std::vector<ImageSegment> correctEdgeBlur(const std::vector<ImageSegment>& segments,
                                          const EdgeBlurParams& params);

}  // namespace vismem
