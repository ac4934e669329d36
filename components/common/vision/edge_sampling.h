/// @file Brightness beside a segment. Pure. Used by detectors and labeller.
#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>

#include "common/geometry/segment.h"

namespace vismem {

/// Gray image of a CV_8UC1 (shared) or CV_8UC3 (R, G, B) image.
/// @throws std::invalid_argument for another type.
cv::Mat toGray(const cv::Mat& image);

/// Unit normal to the left of a -> b, as a person sees the picture (v points down). Length must be > 0.
Eigen::Vector2d leftNormal(const Segment2& px);

/// Mean brightness on the left minus that on the right [grey levels], sampled (nearest pixel) every 2 px or
/// so along the segment at `distance_px` from it. Samples outside the image do not count.
/// @return 0 when a side has no sample.
double brightnessStep(const cv::Mat& gray, const Segment2& px, double distance_px);

/// The segment with its brighter side on the left, and the mean step across it. A segment without any step
/// keeps its direction.
struct OrientedSegment {
  Segment2 px;
  double strength = 0.0;  ///< >= 0
};
OrientedSegment orientByBrightness(const cv::Mat& gray, const Segment2& px, double distance_px);

}  // namespace vismem
