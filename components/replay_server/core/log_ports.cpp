#include "replay_server/core/log_ports.h"

#include <cmath>
#include <initializer_list>
#include <string>

namespace vismem {
namespace {

double rateOf(const RobotLog& log) {
  const auto& stamps = log.frameStamps();
  const double seconds = toSeconds(stamps.back() - stamps.front());
  return seconds > 0.0 ? static_cast<double>(stamps.size() - 1) / seconds : 0.0;
}

PortReply ignore(std::initializer_list<double> values) {
  for (const double value : values) {
    if (!std::isfinite(value))
      return PortReply::rejected("a command with " + std::to_string(value) + " (must be finite)");
  }
  return PortReply::adjusted("a recording cannot be moved: the command is ignored");
}

}  // namespace

PortReply ignored(const PanTiltCommand& command) {
  return ignore({command.pan_rad, command.tilt_rad, command.pan_rate_radps, command.tilt_rate_radps});
}

PortReply ignoredVelocity(double v_mps, double w_radps) {
  return ignore({v_mps, w_radps});
}

PanTiltLimits limitsOf(const RobotLog& log) {
  PanTiltLimits limits;
  if (log.joints().empty()) return limits;
  const PanTiltSample& first = log.joints().front();
  limits.min_pan_rad = limits.max_pan_rad = first.pan_rad;
  limits.min_tilt_rad = limits.max_tilt_rad = first.tilt_rad;
  for (const PanTiltSample& sample : log.joints()) {
    limits.min_pan_rad = std::min(limits.min_pan_rad, sample.pan_rad);
    limits.max_pan_rad = std::max(limits.max_pan_rad, sample.pan_rad);
    limits.min_tilt_rad = std::min(limits.min_tilt_rad, sample.tilt_rad);
    limits.max_tilt_rad = std::max(limits.max_tilt_rad, sample.tilt_rad);
  }
  return limits;
}

FrameCapabilities capabilitiesOf(const RobotLog& log) {
  const CameraIntrinsics intrinsics = log.intrinsics(0);
  FrameCapabilities capabilities;
  capabilities.name = "recording " + log.file();
  capabilities.width = intrinsics.width;
  capabilities.height = intrinsics.height;
  capabilities.rate_hz = rateOf(log);
  capabilities.knows_camera_pose = log.knowsCameraPose();
  return capabilities;
}

PortReply configureFor(const RobotLog& log, const FrameRequest& request) {
  if (auto rejection = rejectAbsurd(request)) return *rejection;
  const FrameCapabilities own = capabilitiesOf(log);
  const std::string size = std::to_string(own.width) + "x" + std::to_string(own.height);
  const bool other_width = request.width != 0 && request.width != own.width;
  const bool other_height = request.height != 0 && request.height != own.height;
  if (other_width || other_height) return PortReply::adjusted("the recording has " + size);
  if (request.rate_hz != 0.0) return PortReply::adjusted("the recording has its own stamps");
  return PortReply::accepted();
}

}  // namespace vismem
