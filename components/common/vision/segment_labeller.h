/// @file The colour label of a segment. Pure. SPEC V3; DESIGN 7, 14.
#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "common/geometry/segment.h"
#include "common/vision/palette.h"

namespace vismem {

struct LabellerParams {
  /// Distances from the segment at which each side is sampled [px], at most 16. The near ones see stripes
  /// that are only a few pixels wide, the far ones get over a blurred edge. Paint is brighter than what it is
  /// on, so only the brighter side is looked at very near: what is there on the darker one is a blend of
  /// both.
  std::vector<double> bright_distances_px{1.0, 1.5, 2.5, 3.5};
  std::vector<double> dark_distances_px{1.5, 2.5, 3.5};
  int samples = 9;                ///< along the segment, at each distance
  double trim = 0.1;              ///< share of the length left out at each end, where corners disturb
  double minimum_majority = 0.6;  ///< share of the samples of a side that must have one class
};

/// What lies on both sides of a segment.
struct SegmentSides {
  ColorClass bright = kNoColorClass;  ///< left of a -> b as a person sees the picture
  ColorClass dark = kNoColorClass;
  Label label = kUnknownLabel;
};

/// The class of a side at a distance is that of most samples there. The label is that of the nearest pair of
/// distances whose classes are a named pair; without one, each side has the class of its nearest distance
/// with one.
/// @param image   CV_8UC3, order R, G, B; a gray image gives kUnknownLabel.
/// @param px_raw  raw pixels, brighter side on the left. Samples outside the image do not count.
/// @throws std::invalid_argument for more than 16 distances on a side.
SegmentSides labelSegment(const cv::Mat& image, const Segment2& px_raw, const Palette& palette,
                          const LabellerParams& params);
/// Its label alone, which lives as long as the palette.
const Label& segmentLabel(const cv::Mat& image, const Segment2& px_raw, const Palette& palette,
                          const LabellerParams& params);

}  // namespace vismem
