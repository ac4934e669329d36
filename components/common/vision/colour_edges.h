/// @file Edges between colours of nearly equal brightness, which are absent in the gray image. Pure. See V1,
/// V3.
#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "common/vision/segment_detector.h"

namespace vismem {

/// The largest channel of each pixel. A saturated red or blue is bright in it, also beside a dark floor.
/// @param rgb CV_8UC3.
/// @param plane becomes CV_8UC1 of its size.
void strongestChannel(const cv::Mat& rgb, cv::Mat& plane);

/// Adds the segments of the strongest channel to those of the gray image. It adds segments that are absent
/// there and replaces pieces by the whole segment. Polarity and strength are those of the gray image.
/// *Single-threaded*: it has a workspace.
class ColourEdgeJoiner {
 public:
  /// @param image CV_8UC3.
  void join(const cv::Mat& image, const std::vector<RawSegment>& found_in_plane,
            std::vector<RawSegment>& segments);

 private:
  std::vector<double> directions_;     // of the gray image's segments
  std::vector<bool> replaced_;         // the same
  std::vector<std::size_t> parallel_;  // of these, to one of the plane
};

}  // namespace vismem
