#include "support/pictures.h"

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

namespace vismem {
namespace {

cv::Mat picture(int number, int width, int height) {
  return cv::Mat(height, width, CV_8UC3, cv::Scalar(60, 120, number));  // B, G, R
}

}  // namespace

void writePicture(const std::string& file, int number, int width, int height) {
  ASSERT_TRUE(cv::imwrite(file, picture(number, width, height))) << file;
}

void writeVideo(const std::string& file, int pictures, double rate_hz, int width, int height) {
  cv::VideoWriter writer(file, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), rate_hz, {width, height});
  ASSERT_TRUE(writer.isOpened()) << file;
  for (int i = 0; i < pictures; ++i) writer.write(picture(10 * i, width, height));
}

}  // namespace vismem
