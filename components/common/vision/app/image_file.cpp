#include "common/vision/app/image_file.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <system_error>

#include "common/config/config_error.h"

namespace vismem {

cv::Mat readImageFile(const std::filesystem::path& file) {
  if (::access(file.c_str(), R_OK) != 0)
    throw ConfigError({file.string() + ": cannot be opened (" + std::strerror(errno) + ")"});
  cv::Mat image;
  try {
    image = cv::imread(file.string(), cv::IMREAD_COLOR);
  } catch (const cv::Exception&) {
    image.release();  // a header with more pixels than OpenCV accepts
  }
  if (image.empty()) throw std::runtime_error(file.string() + ": not an image that can be read");
  cv::cvtColor(image, image, cv::COLOR_BGR2RGB);
  return image;
}

void writeImageFile(const cv::Mat& rgb, const std::filesystem::path& file) {
  std::error_code error;
  if (file.has_parent_path()) std::filesystem::create_directories(file.parent_path(), error);
  cv::Mat bgr;
  cv::cvtColor(rgb, bgr, cv::COLOR_RGB2BGR);
  bool written = false;
  try {
    written = cv::imwrite(file.string(), bgr);
  } catch (const cv::Exception&) {
    throw std::runtime_error(file.string() +
                             ": cannot be written (its ending must be that of an image: .png, .jpg)");
  }
  if (!written) throw std::runtime_error(file.string() + ": cannot be written");
}

}  // namespace vismem
