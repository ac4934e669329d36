/// @file Brightness across a segment, averaged along it. Pure. See V1.
#pragma once

#include <opencv2/core/mat.hpp>

#include "common/geometry/segment.h"

namespace vismem {

/// Brightness measurements of the image at a detected segment.
struct LineProfile {
  double step = 0.0;      ///< brightness 2 px to the left less that 2 px to the right [grey levels]
  double aside_px = 0.0;  ///< offset to the left of the steepest brightness rise, within 1 px of the segment
};

/// Edge points come from a smoothed image, in which the two edges of a thin bar are displaced outwards. This
/// profile is not smoothed across the segment; averaging along it reduces the noise.
/// @param image  CV_8UC1 or CV_8UC3 (R, G, B); beyond its borders the nearest pixel counts.
/// @param px     inside the image, at least 2 px long.
/// @param noise deviation of a pixel [grey levels]: `aside_px` shrinks towards 0 as far as the noise explains
/// it.
LineProfile profileAcross(const cv::Mat& image, const Segment2& px, double noise);

}  // namespace vismem
