/// @file Images with exactly known edges, and the position error of detected segments. Pure.
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "common/geometry/segment.h"

namespace vismem {

struct SyntheticScene {
  cv::Mat gray;
  std::vector<Segment2> edges;  ///< true [px], centres on integers
};

/// 320x240 with eight random convex quads side by side (none covers another), contrast 25 to 60 grey levels
/// to either side, blur of sigma 0.7 px, independent noise.
SyntheticScene makeScene(double noise_sigma, std::uint64_t seed);

/// Noise only, about mid grey.
cv::Mat makeNoise(double sigma, std::uint64_t seed);

/// Sums that can be added up over scenes.
struct EndLineError {
  long ends = 0;
  double squared_sum = 0.0;  ///< [px^2]
  void add(const EndLineError& other) {
    ends += other.ends;
    squared_sum += other.squared_sum;
  }
  double rms_px() const;
};
/// Distances of detected ends to the line of the true edge that the detection belongs to: direction within 10
/// degrees, middle within 5 px of it, the nearest of these. A detection that belongs to none does not count.
EndLineError endLineError(const std::vector<Segment2>& detected, const std::vector<Segment2>& edges);

}  // namespace vismem
