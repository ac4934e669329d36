#include "common/vision/reduced_image.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

namespace vismem {
namespace {

constexpr double kFocal_px = 500.0;

}  // namespace

int blockSize(const CameraIntrinsics& k) {
  const double focal = std::min(k.fx, k.fy);
  return focal >= 2.0 * kFocal_px ? static_cast<int>(focal / kFocal_px) : 1;
}

CameraIntrinsics reduced(const CameraIntrinsics& k, int block) {
  if (block == 1) return k;
  CameraIntrinsics r = k;
  r.width = k.width / block;
  r.height = k.height / block;
  r.fx = k.fx / block;
  r.fy = k.fy / block;
  // Pixel centres are whole numbers.
  r.cx = (k.cx + 0.5) / block - 0.5;
  r.cy = (k.cy + 0.5) / block - 0.5;
  return r;
}

void requireSize(const cv::Mat& image, const CameraIntrinsics& k) {
  if (image.cols != k.width || image.rows != k.height) {
    throw std::invalid_argument("image of " + std::to_string(image.cols) + "x" + std::to_string(image.rows) +
                                " px (its intrinsics are for " + std::to_string(k.width) + "x" +
                                std::to_string(k.height) + ")");
  }
}

void reduceImage(const cv::Mat& image, const CameraIntrinsics& k, int block, cv::Mat& out) {
  requireSize(image, k);
  const cv::Size size(k.width / block, k.height / block);
  cv::resize(image({0, 0, size.width * block, size.height * block}), out, size, 0, 0, cv::INTER_AREA);
}

}  // namespace vismem
