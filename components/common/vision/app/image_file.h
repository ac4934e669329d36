/// @file Image files of the tools: what OpenCV reads in, PNG and others out.
#pragma once

#include <filesystem>
#include <opencv2/core/mat.hpp>

namespace vismem {

/// @return CV_8UC3 (R, G, B), turned as the camera noted in the file; empty when it is no image that OpenCV
/// can read.
cv::Mat readImageFile(const std::filesystem::path& file);

/// Its folder is made where it is missing; the ending chooses the format.
/// @param rgb CV_8UC3 (R, G, B).
/// @throws std::runtime_error naming the file when it cannot be written.
void writeImageFile(const cv::Mat& rgb, const std::filesystem::path& file);

}  // namespace vismem
