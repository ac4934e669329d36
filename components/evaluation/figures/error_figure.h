/// @file The figure of a run's errors over time. Values in, picture out (CV_8UC3, R G B). Pure.
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "evaluation/core/metrics.h"

namespace vismem {

struct ErrorFigure {
  std::string title;
  LocalizationScore score;
  ScoreParams limits;  ///< drawn as dashed lines
};

/// Two plots over the time since the start, on logarithmic scales. Each shows the range of its errors and the
/// limit of what is right, in whole steps of 1 and 3; errors below 1 mm or 0.01 degrees count as these. Time
/// is in seconds, minutes or hours. Images without a pose are drawn at the top.
cv::Mat drawErrors(const ErrorFigure& figure);

/// Position of a value in the picture of drawErrors, for tests.
/// @param seconds since the start.
Eigen::Vector2d positionErrorPx(const ErrorFigure& figure, double seconds, double error_m);
Eigen::Vector2d headingErrorPx(const ErrorFigure& figure, double seconds, double error_rad);

/// The marks of a logarithmic axis, for tests: 1 and 3 times powers of ten, from the last below all values to
/// the first above them.
/// @param values above 0.
std::vector<double> logarithmicTicks(const std::vector<double>& values);

}  // namespace vismem
