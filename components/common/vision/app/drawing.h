/// @file Drawings of segments for the tools. Pure. Canvases are CV_8UC3 (R, G, B).
#pragma once

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>

#include "common/geometry/segment.h"

namespace vismem {

/// The image (R, G, B) enlarged to about 1000 px of width, so that sub-pixel lines are visible.
cv::Mat magnifiedForDrawing(const cv::Mat& image);

/// Draws a segment of `image` on its magnified canvas, with a short tick at its middle towards the brighter
/// side and dots at its ends.
void drawSegment(cv::Mat& canvas, const cv::Mat& image, const Segment2& px, const cv::Scalar& color_rgb);

}  // namespace vismem
