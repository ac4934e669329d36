/// @file Sub-pixel edge points of an image: where the gradient is largest across the edge. Pure. SPEC V1.
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

namespace vismem {

/// Gradient of the smoothed image, as integers 16 * 8 times [grey levels per px] (binomial 3x3, then Sobel),
/// and the edge points on it. Planes have the image's size; a border of 2 px has no edge points.
struct EdgePlanes {
  int width = 0;
  int height = 0;
  std::vector<std::int16_t> gx;
  std::vector<std::int16_t> gy;
  std::vector<float> magnitude;
  std::vector<std::uint8_t> is_edge;
  std::vector<std::int32_t> edges;  ///< indices y * width + x of the edge points, in raster order

  // work space
  std::vector<std::uint16_t> smooth;
  std::vector<std::uint16_t> row;
  std::vector<std::uint16_t> column_sum;
};

/// Standard deviation of the image's own noise [grey levels]: from second differences that neither edges nor
/// slopes excite, at their lower quartile, so that texture counts little. 0 for a flat image.
double estimateNoise(const cv::Mat& gray);

/// @param minimum_contrast of an ideal step that is an edge [grey levels].
void findEdgePoints(const cv::Mat& gray, double minimum_contrast, EdgePlanes& planes);

/// Magnitude (in the units of EdgePlanes) of the gradient in the middle of an ideal step of one grey level.
double stepMagnitude();
/// The same for independent pixel noise of standard deviation 1: the deviation of gx (and of gy).
double noiseMagnitude();

}  // namespace vismem
