#include "simulator/core/simulated_camera.h"

#include <cmath>
#include <sstream>
#include <utility>

namespace vismem {
namespace {

/// Maximum latency, which bounds the number of undelivered frames.
constexpr double kMaxLatency_s = 5.0;
constexpr double kMaxRate_hz = 100.0;
constexpr int kMaxSide_px = 8192;

template <typename Value>
std::string rule(const SimulatedCameraParams& camera, const char* what, const Value& value,
                 const char* must) {
  std::ostringstream text;
  text << "camera \"" << camera.name << "\": " << what << " " << value << " (must be " << must << ")";
  return text.str();
}

std::string sizeOf(const CameraIntrinsics& lens) {
  return std::to_string(lens.width) + "x" + std::to_string(lens.height);
}

}  // namespace

std::string checkCamera(const SimulatedCameraParams& c) {
  if (c.name.empty()) return "a camera must have a name";
  if (const auto problem = checkIntrinsics(c.intrinsics); !problem.empty()) {
    return "camera \"" + c.name + "\": " + problem;
  }
  if (c.intrinsics.width > kMaxSide_px || c.intrinsics.height > kMaxSide_px) {
    return rule(c, "size", sizeOf(c.intrinsics), "at most 8192 a side");
  }
  if (const auto& stated = c.stated_intrinsics;
      stated && (stated->width != c.intrinsics.width || stated->height != c.intrinsics.height)) {
    const std::string images = sizeOf(c.intrinsics) + ", as its images";
    return rule(c, "calibration for", sizeOf(*stated) + " pixels", images.c_str());
  }
  if (!(c.rate_hz > 0.0 && c.rate_hz <= kMaxRate_hz))
    return rule(c, "rate in Hz", c.rate_hz, "above 0, at most 100");
  if (!(c.latency_s >= 0.0 && c.latency_s <= kMaxLatency_s))
    return rule(c, "latency in s", c.latency_s, "0..5");
  if (!c.T_carrier_camera_body.matrix().allFinite() || !c.T_believed_true.matrix().allFinite()) {
    return "camera \"" + c.name + "\": its mount must be finite";
  }
  const ImageErrorParams& e = c.errors;
  if (!(e.gaussian >= 0.0 && e.gaussian <= 100.0)) return rule(c, "noise", e.gaussian, "0..100 grey levels");
  if (!(e.shot >= 0.0 && e.shot <= 100.0)) return rule(c, "shot noise", e.shot, "0..100 grey levels");
  if (!(e.exposure_sigma >= 0.0 && e.exposure_sigma <= 1.0)) {
    return rule(c, "exposure drift", e.exposure_sigma, "0..1");
  }
  if (!(e.exposure_time_s > 0.0 && e.exposure_time_s <= 1e4)) {
    return rule(c, "exposure time in s", e.exposure_time_s, "above 0, at most 10000");
  }
  return {};
}

StampUs SimulatedCamera::nextExposure() const {
  return static_cast<StampUs>(static_cast<double>(frames_) * 1e6 / params_.rate_hz);
}

void SimulatedCamera::expose(ExposedFrame frame) {
  frame.stamp_us = nextExposure();
  frame.seq = frames_++;
  frame.gain = errors_.gainAt(frame.stamp_us);
  under_way_.push_back(std::move(frame));
  // Without a consumer only the newest frames are kept.
  const StampUs kept_us = toStampUs(params_.latency_s) + kSecondUs;
  while (under_way_.front().stamp_us + kept_us < under_way_.back().stamp_us) under_way_.pop_front();
}

const ExposedFrame* SimulatedCamera::arrived(StampUs now_us) const {
  const ExposedFrame* newest = nullptr;
  for (const auto& frame : under_way_) {
    if (frame.stamp_us + toStampUs(params_.latency_s) <= now_us) newest = &frame;
  }
  return newest;
}

std::optional<ExposedFrame> SimulatedCamera::take(StampUs now_us) {
  const ExposedFrame* newest = arrived(now_us);
  if (newest == nullptr) return std::nullopt;
  ExposedFrame frame = *newest;
  while (!under_way_.empty() && under_way_.front().seq <= frame.seq) under_way_.pop_front();
  return frame;
}

}  // namespace vismem
