/// @file Images with known edges. Rendered by supersampling, then blurred and made noisy.
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>
#include <random>
#include <vector>

#include "common/geometry/segment.h"

namespace vismem {

struct Quad {
  Eigen::Vector2d corner[4];  ///< [px], centres on integers
};

/// A square of side `side_px` about `middle`, turned by `angle_rad`.
Quad squareAt(const Eigen::Vector2d& middle, double side_px, double angle_rad);
/// A stripe of a given width about the segment.
Quad stripeAlong(const Segment2& middle_line, double width_px);

/// Fills a quad of a CV_8UC3 or CV_8UC1 image, anti-aliased (8x8 samples a pixel).
void fillQuad(cv::Mat& image, const Quad& quad, const cv::Scalar& color);
void blur(cv::Mat& image, double sigma_px);
/// Adds independent normal noise to every channel.
void addNoise(cv::Mat& image, double sigma, std::mt19937_64& random);

}  // namespace vismem
