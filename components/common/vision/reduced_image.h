/// @file Images of more detail than segments need, averaged in whole blocks. Pure. See V1.
#pragma once

#include <opencv2/core/mat.hpp>

#include "common/geometry/camera.h"

namespace vismem {

/// Pixels a block across: as many as leave a focal length of 500 px or more. Thresholds in pixels, of detector
/// and memory, stand for angles of cameras of that kind; finer images are also blurred by lens and compression.
int blockSize(const CameraIntrinsics& intrinsics);

/// Lens of the averaged image; columns and rows that fill no block are left out at the right and below.
CameraIntrinsics reduced(const CameraIntrinsics& intrinsics, int block);

/// @throws std::invalid_argument if the size of the image is not that of its intrinsics.
void requireSize(const cv::Mat& image, const CameraIntrinsics& intrinsics);

/// Means of the blocks. @throws std::invalid_argument as requireSize().
void reduceImage(const cv::Mat& image, const CameraIntrinsics& intrinsics, int block, cv::Mat& out);

}  // namespace vismem
