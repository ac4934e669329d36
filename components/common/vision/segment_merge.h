/// @file Joins collinear segments of one label whose ends are close. Pure. Implements V4.
#pragma once

#include <vector>

#include "common/vision/collinear_merge.h"
#include "common/vision/image_segment.h"

namespace vismem {

struct MergeParams {
  double angle_rad = 0.07;  ///< between the directions, polarity included
  double offset_px = 1.5;   ///< of the shorter one's ends from the longer one's line
  double gap_px = 8.0;      ///< between the near ends along the line; overlapping pieces have none
};

/// *Single-threaded*; keeps its memory, but no data of earlier segments.
class SegmentMerger {
 public:
  /// Joins the closest pairs first until no pair is left; the result does not depend on the order of the
  /// input. A joined segment is the length-weighted line of its parts over the extent of both.
  /// @param segments replaced by the joined ones, sorted by position (first end, then second).
  void merge(std::vector<ImageSegment>& segments, const MergeParams& params);

 private:
  std::vector<Label> labels_;
  std::vector<GroupedSegment> grouped_;
  CollinearMerger merger_;
};

}  // namespace vismem
