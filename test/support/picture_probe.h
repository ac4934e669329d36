/// @file What tests of figures need: pictures kept for the eye, colours at places.
#pragma once

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>

#include "evaluation/figures/canvas.h"

namespace vismem {

/// With FIGURES_OUT=DIR the pictures are kept there, for the eye.
inline void keep(const cv::Mat& rgb, const std::string& name) {
  const char* folder = std::getenv("FIGURES_OUT");
  if (folder == nullptr) return;
  cv::Mat bgr;
  cv::cvtColor(rgb, bgr, cv::COLOR_RGB2BGR);
  cv::imwrite((std::filesystem::path(folder) / name).string(), bgr);
}

/// Largest difference of a channel between a colour and the nearest pixel around a place.
inline int distanceTo(const cv::Mat& picture, const Eigen::Vector2d& px, Rgb color, int radius = 1) {
  int best = 255;
  for (int dv = -radius; dv <= radius; ++dv) {
    for (int du = -radius; du <= radius; ++du) {
      const cv::Point at(static_cast<int>(px.x()) + du, static_cast<int>(px.y()) + dv);
      if (!cv::Rect(0, 0, picture.cols, picture.rows).contains(at)) continue;
      const auto& p = picture.at<cv::Vec3b>(at);
      best = std::min(
          best, std::max({std::abs(p[0] - color.r), std::abs(p[1] - color.g), std::abs(p[2] - color.b)}));
    }
  }
  return best;
}

}  // namespace vismem
