#include "drivers/example_camera/pattern_camera.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "common/drivers/host_clock.h"
#include "common/geometry/angles.h"

namespace vismem {

PatternCamera::PatternCamera(int bars) : bars_(bars) {}

FrameCapabilities PatternCamera::capabilities() const {
  const std::lock_guard lock(mutex_);
  return {"test pattern (simulated)", width_, height_, rate_hz_, false};
}

PortReply PatternCamera::configure(const FrameRequest& request) {
  if (auto rejection = rejectAbsurd(request)) return *rejection;
  const std::lock_guard lock(mutex_);
  if (running_) return PortReply::rejected("the camera runs; stop it before it is configured");
  if (request.width > 0) width_ = std::clamp(request.width, kMinSide_px, kMaxSide_px);
  if (request.height > 0) height_ = std::clamp(request.height, kMinSide_px, kMaxSide_px);
  if (request.rate_hz > 0.0) rate_hz_ = std::clamp(request.rate_hz, kMinRate_hz, kMaxRate_hz);
  const bool as_asked = (request.width == 0 || width_ == request.width) &&
                        (request.height == 0 || height_ == request.height) &&
                        (request.rate_hz == 0.0 || rate_hz_ == request.rate_hz);
  if (as_asked) return PortReply::accepted();
  return PortReply::adjusted(std::to_string(width_) + "x" + std::to_string(height_) + " at " +
                             std::to_string(rate_hz_) + " Hz");
}

PortReply PatternCamera::start() {
  const std::lock_guard lock(mutex_);
  if (running_) return PortReply::accepted();
  running_ = true;
  begin_ = Clock::now();
  begin_us_ = hostClock_us();
  given_ = -1;
  return PortReply::accepted();
}

FrameResult PatternCamera::next(std::chrono::milliseconds timeout) {
  std::unique_lock lock(mutex_);
  const std::chrono::duration<double> period(1.0 / rate_hz_);
  const auto newest = [&] { return static_cast<std::int64_t>(std::floor((Clock::now() - begin_) / period)); };
  if (running_ && newest() <= given_) {
    const auto due = begin_ + std::chrono::ceil<Clock::duration>(period * static_cast<double>(given_ + 1));
    stopped_.wait_until(lock, std::min(due, Clock::now() + timeout), [this] { return !running_; });
  }
  if (!running_) return {SourceState::kWaiting, std::nullopt, "the camera is stopped"};
  // Images that were not read in time are skipped; the newest is delivered.
  const std::int64_t number = newest();
  if (number <= given_) return {SourceState::kWaiting, std::nullopt, {}};
  given_ = number;
  return {SourceState::kRunning, draw(number), {}};
}

void PatternCamera::stop() {
  {
    const std::lock_guard lock(mutex_);
    if (!running_) return;
    running_ = false;
    seq_base_ += static_cast<std::uint64_t>(given_ + 1);
  }
  stopped_.notify_all();
}

Frame PatternCamera::draw(std::int64_t number) const {
  Frame frame;
  frame.stamp_us = begin_us_ + toStampUs(static_cast<double>(number) / rate_hz_);
  frame.seq = seq_base_ + static_cast<std::uint64_t>(number);
  frame.intrinsics = intrinsicsFromFieldOfView(width_, height_, degToRad(kHorizontalView_deg));
  frame.image.create(height_, width_, CV_8UC3);
  const int bar = static_cast<int>(number % bars_);
  for (int y = 0; y < height_; ++y) {
    auto* row = frame.image.ptr<cv::Vec3b>(y);
    const auto gray = static_cast<std::uint8_t>(40 + 120 * y / height_);
    for (int x = 0; x < width_; ++x) {
      row[x] = x * bars_ / width_ == bar ? cv::Vec3b(255, 220, 60) : cv::Vec3b::all(gray);
    }
  }
  return frame;
}

std::unique_ptr<FrameSource> makePatternCamera(ConfigReader& group) {
  group.describe({basic("Bars", "of the pattern, side by side")});
  return std::make_unique<PatternCamera>(static_cast<int>(group.integer("Bars", 16, 2, 64)));
}

}  // namespace vismem
