/// @file The colour label of a segment. Pure. Implements V3.
#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "common/geometry/segment.h"
#include "common/vision/palette.h"

namespace vismem {

struct LabellerParams {
  /// Distances from the segment at which each side is sampled [px], at most 16. The near ones reach stripes
  /// that are only a few pixels wide, the far ones lie beyond a blurred edge. Paint is brighter than its
  /// surroundings, so only the brighter side is sampled very near: the darker side is a mixture there.
  std::vector<double> bright_distances_px{1.0, 1.5, 2.5, 3.5};
  std::vector<double> dark_distances_px{1.5, 2.5, 3.5};
  int samples = 9;                ///< along the segment, at each distance
  double trim = 0.1;              ///< share of the length left out at each end, because of corners
  double minimum_majority = 0.6;  ///< share of the samples of a side that must have one class
};

/// Colour classes on both sides of a segment, and its label.
struct SegmentSides {
  ColorClass bright = kNoColorClass;  ///< left of a -> b as seen on the screen
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
