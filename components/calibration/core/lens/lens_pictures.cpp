#include "calibration/core/lens/lens_pictures.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <sstream>

namespace vismem {
namespace {

const cv::Scalar kWhite(255, 255, 255);
const cv::Scalar kBlack(0, 0, 0);
const cv::Scalar kBlue(30, 60, 200);
const cv::Scalar kRed(200, 30, 30);

cv::Point pointAt(const Eigen::Vector2d& px) {
  return {static_cast<int>(std::lround(px.x())), static_cast<int>(std::lround(px.y()))};
}

/// Green to yellow to red over 1, 2 and 4 goals.
cv::Scalar colourOf(double sigma_px, double goal_px) {
  const double level = std::clamp(std::log2(sigma_px / goal_px), 0.0, 2.0);
  return {255.0 * std::min(1.0, level), 200.0 * std::min(1.0, 2.0 - level), 40.0};
}

cv::Mat canvas(int width, int height, const cv::Mat& image) {
  if (image.empty()) return {height, width, CV_8UC3, kWhite};
  cv::Mat colour = image.clone();
  if (image.channels() == 1) cv::cvtColor(image, colour, cv::COLOR_GRAY2RGB);
  return colour;
}

void writeText(cv::Mat& picture, const std::string& text, const cv::Point& at) {
  const double scale = picture.cols / 1200.0;
  cv::putText(picture, text, at, cv::FONT_HERSHEY_SIMPLEX, scale, kWhite, 4, cv::LINE_AA);
  cv::putText(picture, text, at, cv::FONT_HERSHEY_SIMPLEX, scale, kBlack, 1, cv::LINE_AA);
}

void drawUncertainty(cv::Mat& picture, const ProjectionUncertainty& uncertainty, double goal_px) {
  const PixelGrid& grid = uncertainty.grid;
  cv::Mat colours = picture.clone();
  const double half_width = 0.5 * (picture.cols - 1.0) / (grid.columns - 1);
  const double half_height = 0.5 * (picture.rows - 1.0) / (grid.rows - 1);
  for (std::size_t i = 0; i < grid.px.size(); ++i) {
    const Eigen::Vector2d half(half_width, half_height);
    cv::rectangle(colours, pointAt(grid.px[i] - half), pointAt(grid.px[i] + half),
                  colourOf(uncertainty.sigma_px[i], goal_px), cv::FILLED);
  }
  cv::addWeighted(colours, 0.45, picture, 0.55, 0.0, picture);
}

}  // namespace

cv::Mat drawProgress(const LensProgress& progress, const std::vector<BoardView>& views, double goal_px,
                     int width, int height, const cv::Mat& image) {
  cv::Mat picture = canvas(width, height, image);
  if (progress.uncertainty) drawUncertainty(picture, *progress.uncertainty, goal_px);
  for (const BoardView& view : views) {
    for (const BoardCorner& corner : view.corners)
      cv::circle(picture, pointAt(corner.pixel), 1, kBlue, cv::FILLED);
  }
  if (!progress.is_enough) {
    const Eigen::Vector2d middle(0.5 * (width - 1), 0.5 * (height - 1));
    cv::arrowedLine(picture, pointAt(middle), pointAt(progress.target_px), kRed, std::max(1, width / 200),
                    cv::LINE_AA, 0, 0.06);
  }
  writeText(picture, std::to_string(progress.views) + " views. " + progress.advice,
            {width / 60, height - height / 40});
  return picture;
}

cv::Mat drawResiduals(const LensFit& fit, const std::vector<BoardView>& views) {
  cv::Mat picture = canvas(fit.lens.width, fit.lens.height, {});
  // A residual of three times the mean is as long as a tenth of the height.
  const double scale = std::round(0.1 * fit.lens.height / (3.0 * std::max(fit.rms_px, 1e-3)));
  for (std::size_t view = 0; view < views.size(); ++view) {
    for (std::size_t i = 0; i < views[view].corners.size(); ++i) {
      const Eigen::Vector2d& px = views[view].corners[i].pixel;
      const bool is_used = fit.views[view].is_used[i];
      const Eigen::Vector2d end = px + (is_used ? scale : 0.0) * fit.views[view].residuals_px[i];
      cv::line(picture, pointAt(px), pointAt(end), is_used ? kBlue : kRed, 1, cv::LINE_AA);
      cv::circle(picture, pointAt(px), is_used ? 1 : 4, is_used ? kBlue : kRed, is_used ? cv::FILLED : 1);
    }
  }
  std::ostringstream text;
  text << "residuals " << scale << " times as long; root mean square " << std::round(1e3 * fit.rms_px) / 1e3
       << " px, " << fit.corners << " corners";
  writeText(picture, text.str(), {fit.lens.width / 60, fit.lens.height - fit.lens.height / 40});
  return picture;
}

}  // namespace vismem
