/// @file Pictures of a calibration of a lens. Pure.
#pragma once

#include <opencv2/core/mat.hpp>

#include "calibration/core/lens/lens_session.h"

namespace vismem {

/// Where the lens is known: green up to `goal_px`, yellow at twice that, red above four times; dots for
/// corners; an arrow from the image's middle to the place that is wanted next. @return CV_8UC3 (R, G, B).
/// @param image of the camera, drawn below; may be empty.
cv::Mat drawProgress(const LensProgress& progress, const std::vector<BoardView>& views, double goal_px,
                     int width, int height, const cv::Mat& image = {});

/// Residuals of all corners where they are in the image, `scale` times as long: what the model does not
/// explain shows as a pattern. Outliers are red. @return CV_8UC3 (R, G, B).
cv::Mat drawResiduals(const LensFit& fit, const std::vector<BoardView>& views);

}  // namespace vismem
