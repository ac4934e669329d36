/// @file Pictures of ROS messages as pixels. Pure.
#pragma once

#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>

#include "common/recording/bag_file.h"
#include "common/robot/samples.h"

namespace vismem {

/// "rgb8, bgr8, ...": the encodings of sensor_msgs/Image that decodePicture knows, for messages.
std::string knownEncodings();
bool isKnownEncoding(const std::string& encoding);

/// @return the image in the order R, G, B, or one grey channel.
/// @throws RecordingError with what was found and expected, to be said after the picture's name.
cv::Mat decodePicture(const BagImage& picture);

/// As the picture says, without decoding it; empty for a compressed one that is neither JPEG nor PNG.
std::optional<cv::Size> pictureSize(const BagImage& picture);

/// The picture as it was captured, where Frame::native has a name for its layout (JPEG, YUYV, UYVY); empty
/// otherwise, and for bytes that are no such picture.
std::shared_ptr<const NativeImage> nativePicture(const BagImage& picture);

}  // namespace vismem
