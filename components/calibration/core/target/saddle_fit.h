/// @file Sub-pixel place of a chessboard's corner. Pure.
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <optional>

namespace vismem {

/// A corner as it is expected: place and the board's two directions there.
struct SaddleGuess {
  Eigen::Vector2d px = Eigen::Vector2d::Zero();
  Eigen::Vector2d right = Eigen::Vector2d::UnitX();  ///< one square along the board's x [px]
  Eigen::Vector2d up = -Eigen::Vector2d::UnitY();    ///< one square along the board's y [px]
  bool is_upper_right_white = true;                  ///< of the four squares around the corner
};

struct SaddleFit {
  Eigen::Vector2d px = Eigen::Vector2d::Zero();  ///< pixel centres on integers
  double sigma_px = 0.0;                         ///< standard deviation each way, from the residuals
  double blur_px = 0.0;                          ///< standard deviation of the edges' spread
  double contrast = 0.0;                         ///< half the step from black to white [grey levels]
};

/// Fits two crossing, blurred edges to the pixels around a corner by least squares: brightness = plane +
/// contrast * erf(d1) * erf(d2), d1 and d2 the signed distances from the edges over the blur. Model and image
/// are symmetric about the corner, so blur moves neither. Pixels of tags are left out (BoardSpec::kTagSide).
/// @param grey CV_8UC1.
/// @return empty when the squares are too small, the window leaves the image, or what is there is no such
/// corner.
std::optional<SaddleFit> fitSaddle(const cv::Mat& grey, const SaddleGuess& guess);

}  // namespace vismem
