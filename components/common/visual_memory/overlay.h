/// @file The image with its observed, predicted and matched segments.
/// Pure. Implements M11.
#pragma once

#include <opencv2/core/mat.hpp>

#include "common/visual_memory/memory_snapshot.h"

namespace vismem {

/// Draws the three sets of V5: matched predictions green, predictions without an observation red,
/// observations without a prediction blue, matched observations thin yellow; the horizon as a grey line.
/// @param image CV_8UC3 (R, G, B) or CV_8UC1 of the analysis' size; raw pixels.
/// @param scale the result is this many times larger, 1..8.
/// @return CV_8UC3 (R, G, B), a new image.
cv::Mat drawAnalysis(const cv::Mat& image, const ImageAnalysis& analysis, int scale = 1);

}  // namespace vismem
