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

/// A mark on a line that is seen from afar: less than a pixel high, and yet the image is brighter (or darker)
/// there.
struct LineBumpParams {
  double reach_px = 5.0;         ///< so far beside the edge lies the floor, except where paint joins
  double inside_px = 3.0;        ///< and so far on its other side the line shows its own colour somewhere
  double least_height_px = 0.3;  ///< of the bump, were it of the line's colour ..
  double same_colour = 0.9;      ///< .. which it is: cosine between both colours, against the floor's
  double least_grey = 20.0;      ///< contrast of a line that tells [grey levels]
  double least_px = 2.0;         ///< length of a bump ..
  double most_px = 25.0;         ///< .. that is no line that joins
  int beside_px = 4;             ///< of the line without it, on both sides of the bump
};

/// @param px an edge of a painted line, ideal pixels. @param outward_left does the floor beside the line lie
/// to its left? @return the stretches where the line is thicker on that side, in their order.
std::vector<LineGap> findLineBumps(const cv::Mat& image, const CameraIntrinsics& intrinsics,
                                   const Segment2& px, bool outward_left, const LineBumpParams& params = {});

}  // namespace vismem
