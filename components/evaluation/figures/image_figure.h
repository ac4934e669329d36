/// @file The figure of a run's last image. Values in, picture out (CV_8UC3, R G B). Pure.
#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/geometry/pose.h"
#include "common/segment_map/segment_map.h"
#include "common/visual_memory/memory_snapshot.h"

namespace vismem {

struct ImageFigure {
  std::string title;
  cv::Mat image;           ///< as the camera gave it: CV_8UC3 (R, G, B) or CV_8UC1
  ImageAnalysis analysis;  ///< of that image
  /// With a pose at the image's stamp the map is projected into a second picture beside the first.
  std::optional<Pose2> T_world_robot;
  std::vector<MapSegment> map_edges;  ///< stripes expanded
  double map_range_m = 6.0;
};

/// Left the observed, predicted and matched segments; right the map projected with the pose.
cv::Mat drawLastImage(const ImageFigure& figure);

}  // namespace vismem
