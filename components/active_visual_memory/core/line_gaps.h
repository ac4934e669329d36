/// @file Gaps in an edge that one image shows: where paint joins it, or something stands on it. Pure. SPEC
/// M4.
#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "common/geometry/camera.h"
#include "common/geometry/segment.h"

namespace vismem {

/// A stretch along a segment [px from its end a].
struct LineGap {
  double from_px = 0.0;
  double to_px = 0.0;
};

struct LineGapParams {
  double aside_px = 1.5;     ///< the contrast of an edge is that between both sides, so far from it
  double edge_share = 0.5;   ///< of the segment's median contrast: where there is less, there is no edge ..
  double gap_share = 0.35;   ///< .. and it is a gap where there is less than this somewhere
  double least_grey = 8.0;   ///< median contrast of an edge that tells [grey levels]
  double least_px = 2.0;     ///< of a gap
  double least_edge_px = 4;  ///< of the edge on both sides of it
};

/// Detectors close small gaps, and fill what a line joins. @param px ideal pixels. @return in their order.
std::vector<LineGap> findLineGaps(const cv::Mat& image, const CameraIntrinsics& intrinsics,
                                  const Segment2& px, const LineGapParams& params = {});

}  // namespace vismem
