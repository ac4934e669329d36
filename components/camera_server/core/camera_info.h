/// @file The calibration files of ROS (camera_calibration, camera_info_manager). Pure.
#pragma once

#include <string>
#include <vector>

#include "common/geometry/camera.h"

namespace vismem {

/// Reads image_width, image_height, camera_matrix, distortion_model and distortion_coefficients; the rest is
/// for stereo pairs. Distortion: plumb_bob with 4 or 5 coefficients, none at all, or rational_polynomial
/// whose last three are 0, as OpenCV writes it for an ordinary lens.
/// @param file for messages. @throw ConfigError "FILE:LINE: ...".
CameraIntrinsics parseCameraInfo(const std::string& text, const std::string& file);

/// The file of a camera by itself: plumb_bob, no rectification. parseCameraInfo reads the same lens from it.
/// @param camera_name letters, digits, '_' and '-'. @param comments lines at the file's beginning.
std::string writeCameraInfo(const CameraIntrinsics& lens, const std::string& camera_name,
                            const std::vector<std::string>& comments = {});

}  // namespace vismem
