/// @file Image files of the tools: reading of all formats of OpenCV, writing of PNG and others.
#pragma once

#include <filesystem>
#include <opencv2/core/mat.hpp>

namespace vismem {

/// @return CV_8UC3 (R, G, B), rotated by the file's orientation tag; not empty.
/// @throws std::runtime_error "FILE: cannot be opened (REASON)" or "FILE: not an image that can be read".
cv::Mat readImageFile(const std::filesystem::path& file);

/// Creates a missing folder; the file's ending selects the format.
/// @param rgb CV_8UC3 (R, G, B).
/// @throws std::runtime_error naming the file when it cannot be written.
void writeImageFile(const cv::Mat& rgb, const std::filesystem::path& file);

}  // namespace vismem
