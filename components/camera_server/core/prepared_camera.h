/// @file A driver's camera as it is served: turned the right way up and with its lens. Pure.
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "camera_server/core/orientation.h"
#include "common/robot/ports.h"

namespace vismem {

/// What is known of the lens; at most one of the two. Otherwise frames keep what their driver says.
struct Lens {
  /// Of the served picture, at this size or another of the same shape.
  std::optional<CameraIntrinsics> calibrated;
  /// Across the served picture; no distortion.
  std::optional<double> horizontal_view_rad;
};

/// The calibration for pictures of another size; empty if their shape differs by more than 1 %.
std::optional<CameraIntrinsics> scaledTo(const CameraIntrinsics& calibrated, int width, int height);

/// *As thread-safe as the camera inside.* Sizes asked for are those of the served picture. A picture that
/// need not be turned passes as its camera captured it.
class PreparedCamera : public FrameSource {
 public:
  PreparedCamera(std::unique_ptr<FrameSource> camera, const Orientation& orientation, const Lens& lens);

  FrameCapabilities capabilities() const override;
  PortReply configure(const FrameRequest& request) override;
  PortReply start() override { return camera_->start(); }
  FrameResult next(std::chrono::milliseconds timeout) override;
  void stop() override { camera_->stop(); }

  /// Why the calibration is not of the pictures that come; empty while it is, or none is there. Any thread.
  std::string lensProblem() const;

 private:
  CameraIntrinsics lensOf(const Frame& frame);

  const std::unique_ptr<FrameSource> camera_;
  const Orientation orientation_;
  const Lens lens_;
  mutable std::mutex mutex_;
  std::string lens_problem_;
};

}  // namespace vismem
