/// @file Brightness beside a segment. Pure. Used by detectors and labeller.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <opencv2/core/mat.hpp>

#include "common/geometry/segment.h"

namespace vismem {

/// @throws std::invalid_argument for another type than CV_8UC1 and CV_8UC3.
void checkPixelType(const cv::Mat& image);

/// Brightness of pixel x of a row of one channel or of three (R, G, B), with the weights of ITU-R BT.601.
inline int brightness(const std::uint8_t* row, int x, int channels) {
  if (channels == 1) return row[x];
  const std::uint8_t* rgb = row + 3 * static_cast<std::ptrdiff_t>(x);
  return (9798 * rgb[0] + 19235 * rgb[1] + 3735 * rgb[2] + (1 << 14)) >> 15;
}

/// Gray image of a CV_8UC1 (shared) or CV_8UC3 (R, G, B) image.
/// @throws std::invalid_argument for another type.
cv::Mat toGray(const cv::Mat& image);

/// Nearest of `size` pixels to a coordinate, or -1 outside, faster than std::lround.
inline int nearestPixel(double value, int size) {
  if (!(value > -0.5 && value < size - 0.5)) return -1;
  return std::min(static_cast<int>(value + 0.5), size - 1);
}

/// Unit normal to the left of a -> b, as seen on the screen (v points down). Length must be > 0.
inline Eigen::Vector2d leftNormal(const Segment2& px) {
  const Eigen::Vector2d d = (px.b - px.a).normalized();
  return {d.y(), -d.x()};
}

/// Mean brightness on the left minus that on the right [grey levels], sampled (nearest pixel) every 2 px or
/// so along the segment at `distance_px` from it. Samples outside the image do not count.
/// @param image CV_8UC1 or CV_8UC3.
/// @return 0 when a side has no sample.
double brightnessStep(const cv::Mat& image, const Segment2& px, double distance_px);

/// The segment with its brighter side on the left, and the mean step across it. A segment without any step
/// keeps its direction.
struct OrientedSegment {
  Segment2 px;
  double strength = 0.0;  ///< >= 0
};
OrientedSegment orientByBrightness(const cv::Mat& image, const Segment2& px, double distance_px);

}  // namespace vismem
