/// @file A driver's camera with its orientation and calibration applied, as it is served. Pure.
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "camera_server/core/orientation.h"
#include "common/robot/ports.h"

namespace vismem {

/// Calibration of the lens; at most one of the two. Without both, frames keep the intrinsics of their driver.
struct Lens {
  /// Intrinsics of the served image, at this size or another of the same aspect ratio.
  std::optional<CameraIntrinsics> calibrated;
  /// Horizontal field of view of the served image; no distortion.
  std::optional<double> horizontal_view_rad;
};

/// The calibration scaled to images of another size; empty if the aspect ratio differs by more than 1 %.
std::optional<CameraIntrinsics> scaledTo(const CameraIntrinsics& calibrated, int width, int height);

/// *As thread-safe as the camera inside.* Requested sizes are those of the served image. An image without
/// rotation and mirroring passes unchanged.
class PreparedCamera : public FrameSource {
 public:
  PreparedCamera(std::unique_ptr<FrameSource> camera, const Orientation& orientation, const Lens& lens);

  FrameCapabilities capabilities() const override;
  PortReply configure(const FrameRequest& request) override;
  PortReply start() override { return camera_->start(); }
  FrameResult next(std::chrono::milliseconds timeout) override;
  void stop() override { camera_->stop(); }

  /// Reason why the calibration does not fit the images; empty while it fits, or without a calibration. Any
  /// thread.
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
