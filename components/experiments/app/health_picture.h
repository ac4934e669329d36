/// @file A health map as a picture, with the map's lines, the true and the best place.
#pragma once

#include <opencv2/core/mat.hpp>

#include "common/geometry/pose.h"
#include "common/segment_map/segment_map.h"
#include "localization/core/likelihood/health_map.h"

namespace vismem {

/// The scale from health to colour, from white to dark.
enum class HealthScale {
  kLinear,      ///< from 0 to 1
  kLogarithmic  ///< from the least, or e^-40, to 1: shows a likelihood's ridges beside its peak
};

/// The truth is a green arrow, the best place a blue ring.
/// @return CV_8UC3 (R, G, B), about `width_px` wide.
cv::Mat drawHealthMap(const HealthMap& map, const SegmentMap& map_edges, const Pose2& truth, int width_px,
                      HealthScale scale);

/// Figures of a health map.
struct HealthMapReading {
  double best = 0.0;      ///< health of the best place
  double at_truth = 0.0;  ///< the best within one cell of the true place
  double off_m = 0.0;     ///< from the truth to the best place
  /// Share of the places whose health is at least that of the true place.
  double rivals = 0.0;
};
HealthMapReading readHealthMap(const HealthMap& map, const Pose2& truth);

}  // namespace vismem
