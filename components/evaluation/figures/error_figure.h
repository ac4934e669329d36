/// @file The figure of a run's errors over time. Values in, picture out (CV_8UC3, R G B). Pure.
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <string>

#include "evaluation/core/metrics.h"

namespace vismem {

struct ErrorFigure {
  std::string title;
  LocalizationScore score;
  ScoreParams limits;  ///< drawn as dashed lines
};

/// Two plots over the seconds since the start, on logarithmic scales: position 1 cm to 30 m and heading
/// 0.1 to 180 degrees. Values outside are drawn on the border, images without a pose at the top.
cv::Mat drawErrors(const ErrorFigure& figure);

/// Position of a value in the picture of drawErrors, for tests.
/// @param seconds since the start.
/// @param end_s the last stamp's.
Eigen::Vector2d positionErrorPx(double seconds, double end_s, double error_m);
Eigen::Vector2d headingErrorPx(double seconds, double end_s, double error_rad);

}  // namespace vismem
