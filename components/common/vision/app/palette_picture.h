/// @file What a palette makes of an image, as a picture. Pure. See V3.
#pragma once

#include <map>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "common/vision/image_segment.h"
#include "common/vision/palette.h"

namespace vismem {

struct PalettePicture {
  /// Left the image with its segments in the colours of their labels, right every class in its mean colour; a
  /// legend below. CV_8UC3 (R, G, B).
  cv::Mat figure;
  std::map<Label, int> label_counts;  ///< segments, of every label of the palette and of kUnknownLabel
  std::vector<double> class_shares;   ///< of the image's pixels, by class; 0 is no class
};

/// @param image    CV_8UC3 (R, G, B).
/// @param segments of that image, in its raw pixels.
PalettePicture picturePalette(const cv::Mat& image, const Palette& palette,
                              const std::vector<ImageSegment>& segments);

}  // namespace vismem
