/// @file Repeatability of segments: two noisy views with a known homography, and a comparison of the
/// detections of both. Pure.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "common/geometry/segment.h"

namespace vismem {

struct TwoViews {
  cv::Mat a;              ///< CV_8UC1: the image with noise of sigma 2
  cv::Mat b;              ///< the same size: warped, gain 0.85, noise of its own
  Eigen::Matrix3d H_b_a;  ///< pixels of a -> pixels of b, centres on integers
};
/// A random view: corners moved by up to 8 % of the size, turned by up to 15 degrees, scaled by 0.85 to 1.15
/// about the middle.
TwoViews makeTwoViews(const cv::Mat& gray, std::uint64_t seed);

/// Sums that can be added up over images.
struct Repeatability {
  long segments = 0;    ///< of both views, at least 10 px inside the common area
  long structural = 0;  ///< with one of the other view within 5 px: mean end-point distance, best order
  long orthogonal = 0;  ///< with one within 1 px: see below
  long located = 0;     ///< with one within 3 px
  double located_sum_px = 0.0;  ///< of their distances

  void add(const Repeatability& other);
  double structuralShare() const { return segments > 0 ? static_cast<double>(structural) / segments : 0.0; }
  double orthogonalShare() const { return segments > 0 ? static_cast<double>(orthogonal) / segments : 0.0; }
  double localisation_px() const { return located > 0 ? located_sum_px / located : 0.0; }
};

/// Orthogonal: directions within 10 degrees, projections overlapping by half of the shorter one; the distance
/// is the mean of all four ends' distances to the other one's line. Each segment of either view takes its
/// nearest.
Repeatability compareViews(const TwoViews& views, const std::vector<Segment2>& found_a,
                           const std::vector<Segment2>& found_b);

}  // namespace vismem
