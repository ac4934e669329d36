/// @file Gaps in an edge that one image shows: where paint joins it, or an object stands on it. Pure. See M4.
#pragma once

#include <memory_resource>
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
  double aside_px = 1.5;     ///< the contrast of an edge is taken between points this far to both sides
  double edge_share = 0.5;   ///< of the median contrast of the segment: less is no edge
  double gap_share = 0.35;   ///< an interval without edge is a gap if its minimum is less than this share
  double least_grey = 8.0;   ///< median contrast of an edge that is examined [grey levels]
  double least_px = 2.0;     ///< length of a gap
  double least_edge_px = 4;  ///< length of the edge on both sides of a gap
};

/// Gaps that the detector closed. @param px the segment, ideal pixels. @return in their order along it.
std::pmr::vector<LineGap> findLineGaps(const cv::Mat& image, const CameraIntrinsics& intrinsics,
                                       const Segment2& px, const LineGapParams& params = {},
                                       std::pmr::memory_resource* scratch = std::pmr::get_default_resource());

/// A spot on a distant line marking: less than a pixel high, but brighter (or darker) than the line's border.
struct LineBumpParams {
  double reach_px = 5.0;         ///< distance from the edge at which the floor is sampled
  double inside_px = 3.0;        ///< depth on the other side within which the line shows its own colour
  double least_height_px = 0.3;  ///< height of a bump of the line's colour
  double same_colour = 0.9;      ///< cosine between the colour of bump and line, both against the floor
  double least_grey = 20.0;      ///< contrast of a line that is examined [grey levels]
  double least_px = 2.0;         ///< length of a bump
  double most_px = 25.0;         ///< longer ones are lines that join
  int beside_px = 4;             ///< of the line without bump, on both sides
};

/// @param px            one edge of a line marking, ideal pixels.
/// @param outward_left  whether the floor beside the line lies to the left of the edge.
/// @return the intervals where the line is thicker on that side, in their order.
std::pmr::vector<LineGap> findLineBumps(
    const cv::Mat& image, const CameraIntrinsics& intrinsics, const Segment2& px, bool outward_left,
    const LineBumpParams& params = {}, std::pmr::memory_resource* scratch = std::pmr::get_default_resource());

}  // namespace vismem
