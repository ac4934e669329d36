/// @file Samples of a robot's sensors: values with a capture stamp. Pure. Stamps are microseconds of the
/// source's clock (docs/architecture.md): never compare them with the wall clock.
#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "common/geometry/camera.h"
#include "common/geometry/pose.h"

namespace vismem {

using StampUs = std::int64_t;

constexpr StampUs kSecondUs = 1'000'000;
constexpr double toSeconds(StampUs stamp_us) {
  return static_cast<double>(stamp_us) * 1e-6;
}
constexpr StampUs toStampUs(double seconds) {
  return static_cast<StampUs>(seconds * 1e6 + (seconds < 0 ? -0.5 : 0.5));
}

/// Pixel layout of an image as captured.
enum class NativeFormat {
  kRgb8,   ///< R G B
  kGray8,  ///< one byte a pixel
  kJpeg,   ///< a whole JPEG file
  kYuyv,   ///< Y0 U Y1 V, BT.601 with Y in 16..235 (V4L2's YUYV, also called YUY2)
  kUyvy,   ///< U Y0 V Y1
  kNv12,   ///< a plane of Y, then one of U V at half the size
};

/// An image in the bytes of its device or file. common/image_codec decodes it into pixels; a consumer of this
/// format needs no conversion.
struct NativeImage {
  NativeFormat format = NativeFormat::kJpeg;
  int width = 0;   ///< [px]
  int height = 0;  ///< [px]
  int stride = 0;  ///< from row to row [bytes]; 0: rows follow each other without a gap; not for kJpeg
  std::vector<std::uint8_t> bytes;
};

/// One image. The pixels are shared and must not be written after the frame was handed on.
struct Frame {
  StampUs stamp_us = 0;         ///< of the exposure's middle
  std::uint64_t seq = 0;        ///< grows by one per captured frame; gaps are dropped frames
  cv::Mat image;                ///< CV_8UC3 in the order R, G, B, or CV_8UC1; raw pixels (with distortion)
  CameraIntrinsics intrinsics;  ///< width and height equal the image's
  /// Full pose of the camera on the robot, when the source knows it (humanoid kinematics, a log's tf). If
  /// present, it replaces mount and pan-tilt.
  std::optional<Pose3> T_robot_camera;
  /// The image as captured, immutable. Set only by a source with FrameRequest::accept_native; `image` may
  /// then be empty.
  std::shared_ptr<const NativeImage> native;
};

/// Joint angles of the pan-tilt unit. pan > 0 looks left, tilt > 0 looks up.
struct PanTiltSample {
  StampUs stamp_us = 0;
  std::uint64_t seq = 0;
  double pan_rad = 0.0;
  double tilt_rad = 0.0;
};

/// Dead-reckoned pose of the robot. The base chooses the origin of odom.
struct OdometrySample {
  StampUs stamp_us = 0;
  std::uint64_t seq = 0;
  Pose2 T_odom_robot;
  double v_mps = 0.0;    ///< forward speed
  double w_radps = 0.0;  ///< turn rate, counter-clockwise
};

}  // namespace vismem
