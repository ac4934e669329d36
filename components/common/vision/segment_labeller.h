/// @file The colour label of a segment. Pure. SPEC V3; DESIGN 7, 14.
#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "common/geometry/segment.h"
#include "common/vision/palette.h"

namespace vismem {

struct LabellerParams {
  /// Distances from the segment at which each side is sampled, nearest first [px]. The near ones see stripes
  /// that are only a few pixels wide, the far ones get over a blurred edge.
  std::vector<double> distances_px{1.5, 2.5, 3.5};
  int samples = 9;                ///< along the segment, at each distance
  double trim = 0.1;              ///< share of the length left out at each end, where corners disturb
  double minimum_majority = 0.6;  ///< share of the samples of a side that must have one class
};

/// What lies on both sides of a segment.
struct SegmentSides {
  ColorClass left = kNoColorClass;  ///< left of a -> b as a person sees the picture
  ColorClass right = kNoColorClass;
  Label label = kUnknownLabel;
};

/// Each side's class is the majority of its samples at the nearest distance that has one; the label is the
/// pair's, tried over the combinations of distances, nearest first.
/// @param image   CV_8UC3, order R, G, B; a gray image gives kUnknownLabel.
/// @param px_raw  raw pixels. Samples outside the image do not count.
SegmentSides labelSegment(const cv::Mat& image, const Segment2& px_raw, const Palette& palette,
                          const LabellerParams& params);

}  // namespace vismem
