#include "camera_server/core/prepared_camera.h"

#include <cmath>
#include <utility>

namespace vismem {
namespace {

std::string sizeText(int width, int height) {
  return std::to_string(width) + "x" + std::to_string(height);
}

}  // namespace

std::optional<CameraIntrinsics> scaledTo(const CameraIntrinsics& calibrated, int width, int height) {
  const double across = static_cast<double>(width) / calibrated.width;
  const double down = static_cast<double>(height) / calibrated.height;
  if (std::abs(across / down - 1.0) > 0.01) return std::nullopt;
  CameraIntrinsics scaled = calibrated;
  scaled.width = width;
  scaled.height = height;
  scaled.fx *= across;
  scaled.fy *= down;
  // Pixel centres are on integers: the picture's corner is at -0.5.
  scaled.cx = (scaled.cx + 0.5) * across - 0.5;
  scaled.cy = (scaled.cy + 0.5) * down - 0.5;
  return scaled;
}

PreparedCamera::PreparedCamera(std::unique_ptr<FrameSource> camera, const Orientation& orientation,
                               const Lens& lens)
    : camera_(std::move(camera)), orientation_(orientation), lens_(lens) {}

FrameCapabilities PreparedCamera::capabilities() const {
  FrameCapabilities capabilities = camera_->capabilities();
  if (orientation_.swapsSides()) std::swap(capabilities.width, capabilities.height);
  if (!orientation_.isPlain()) capabilities.knows_camera_pose = false;
  return capabilities;
}

PortReply PreparedCamera::configure(const FrameRequest& request) {
  FrameRequest inner = request;
  if (orientation_.swapsSides()) std::swap(inner.width, inner.height);
  inner.accept_native = request.accept_native && orientation_.isPlain();
  return camera_->configure(inner);
}

FrameResult PreparedCamera::next(std::chrono::milliseconds timeout) {
  FrameResult result = camera_->next(timeout);
  if (!result.frame) return result;
  Frame& frame = *result.frame;
  if (!orientation_.isPlain()) {
    frame.image = oriented(frame.image, orientation_);
    frame.native.reset();
    frame.intrinsics = oriented(frame.intrinsics, orientation_);
    // That pose belongs to the image before its rotation.
    frame.T_robot_camera.reset();
  }
  frame.intrinsics = lensOf(frame);
  return result;
}

CameraIntrinsics PreparedCamera::lensOf(const Frame& frame) {
  const CameraIntrinsics& own = frame.intrinsics;
  if (lens_.horizontal_view_rad)
    return intrinsicsFromFieldOfView(own.width, own.height, *lens_.horizontal_view_rad);
  if (!lens_.calibrated) return own;
  const auto scaled = scaledTo(*lens_.calibrated, own.width, own.height);
  const std::lock_guard lock(mutex_);
  lens_problem_ = scaled ? std::string()
                         : "the calibration is of " +
                               sizeText(lens_.calibrated->width, lens_.calibrated->height) +
                               " pictures, these have " + sizeText(own.width, own.height);
  return scaled.value_or(own);
}

std::string PreparedCamera::lensProblem() const {
  const std::lock_guard lock(mutex_);
  return lens_problem_;
}

}  // namespace vismem
