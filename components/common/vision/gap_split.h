/// @file Cuts a segment at places without an edge in the image: at a junction of painted lines, or behind a
/// post. Pure. See V4.
#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "common/geometry/camera.h"
#include "common/vision/image_segment.h"

namespace vismem {

struct GapSplitParams {
  bool enabled = false;
  double min_gap_px = 3.0;   ///< shorter gaps are bridged
  double flat_share = 0.35;  ///< share of the usual brightness step; below it there is no edge
  double least_step = 20.0;  ///< [grey levels]; weaker segments are not cut
  double minimum_px = 10.0;  ///< shorter pieces are dropped
};

/// Detection and merging bridge gaps of some pixels, so that noise does not break an edge. This class
/// measures the brightness step at every pixel along the segment, 1 and 2 px beside it. *Single-threaded*;
/// keeps its memory, but no data of earlier images.
class GapSplitter {
 public:
  /// @param image CV_8UC3 (R, G, B) or CV_8UC1, raw pixels.
  /// @param intrinsics intrinsics of that image.
  /// @param segments segments in ideal pixels; replaced by their pieces, in the same order, those of one
  /// segment from a to b.
  void split(const cv::Mat& image, const CameraIntrinsics& intrinsics, std::vector<ImageSegment>& segments,
             const GapSplitParams& params);

 private:
  std::vector<ImageSegment> pieces_;
  std::vector<int> steps_;
  std::vector<int> sorted_;
};

}  // namespace vismem
