/// @file What a robot's sensors say, as ROS messages. Pure. The topics are those that replay_server reads by
/// default.
#pragma once

#include <avm/base.h>
#include <avm/camera.h>
#include <avm/pantilt.h>

#include <functional>
#include <memory>
#include <string>

#include "recorder/core/log_message.h"

namespace vismem {

/// Takes one message after another.
using Emit = std::function<void(RecordedMessage)>;

/// Frames of tf.
inline constexpr const char* kWorldFrame = "map";
inline constexpr const char* kOdomFrame = "odom";
inline constexpr const char* kRobotFrame = "base_footprint";

/// How images are stored: as the camera's server gives them, as pixels, or as PNG.
enum class ImageStorage { kCaptured, kRaw, kPng };

/// One camera: PREFIX/image_raw or PREFIX/image_raw/compressed, PREFIX/camera_info, and the camera's pose in
/// /tf where its frames know it. *Single-threaded.*
class CameraMessages {
 public:
  /// @param prefix "/camera": the optical frame is then "camera_optical_frame".
  CameraMessages(const std::string& prefix, ImageStorage storage);

  /// @param frame of the format RGB8, GRAY8, YUY2 or JPEG.
  /// @return empty, or what is wrong with the frame: it is then left out.
  std::string convert(const avm::Frame& frame, const Emit& emit) const;

  const std::string& frameId() const { return frame_id_; }
  /// Of the images, whichever form they take.
  const LogTopic& imageTopic() const { return storage_ == ImageStorage::kPng ? *compressed_ : *raw_; }

 private:
  std::string convertPixels(const avm::Frame& frame, const Emit& emit) const;

  const ImageStorage storage_;
  const std::string frame_id_;
  const std::shared_ptr<const LogTopic> raw_;
  const std::shared_ptr<const LogTopic> compressed_;
  const std::shared_ptr<const LogTopic> info_;
  const std::shared_ptr<const LogTopic> tf_;
};

/// /odom and the same in /tf. Pure.
void convertOdometry(const avm::OdometrySample& sample, const Emit& emit);
/// /joint_states with the joints "pan" (> 0 left) and "tilt" (> 0 up). Pure.
void convertPanTilt(const avm::PanTiltSample& sample, const Emit& emit);

/// The pose of a frame in the plane of its parent. Pure.
struct RosTransform;
RosTransform planarTransform(std::int64_t stamp_us, const std::string& parent, const std::string& child,
                             const avm::Pose2& pose);

}  // namespace vismem
