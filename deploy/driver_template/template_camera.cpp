#include "template_camera.h"

#include <common/drivers/host_clock.h>
#include <common/geometry/angles.h>

#include <algorithm>

using namespace vismem;

FrameCapabilities TemplateCamera::capabilities() const {
  return {"template camera (simulated)", kWidth, kHeight, kRate_hz, false};
}

PortReply TemplateCamera::configure(const FrameRequest& request) {
  if (auto rejection = rejectAbsurd(request)) return *rejection;
  const bool as_asked = (request.width == 0 || request.width == kWidth) &&
                        (request.height == 0 || request.height == kHeight) &&
                        (request.rate_hz == 0.0 || request.rate_hz == kRate_hz);
  return as_asked ? PortReply::accepted() : PortReply::adjusted("320x240 at 20 Hz");
}

PortReply TemplateCamera::start() {
  const std::lock_guard lock(mutex_);
  // Open the device here, and again in next() with a pause when it is absent: that is no failure.
  running_ = true;
  due_ = Clock::now();
  return PortReply::accepted();
}

FrameResult TemplateCamera::next(std::chrono::milliseconds timeout) {
  std::unique_lock lock(mutex_);
  stopped_.wait_until(lock, std::min(due_, Clock::now() + timeout), [this] { return !running_; });
  if (!running_) return {SourceState::kWaiting, std::nullopt, "the camera is stopped"};
  if (Clock::now() < due_) return {SourceState::kWaiting, std::nullopt, {}};
  // The newest counts: images that nobody took are left out, which their numbers show.
  while (due_ <= Clock::now()) {
    due_ += kPeriod;
    ++seq_;
  }
  Frame frame;
  frame.stamp_us = hostClock_us();
  frame.seq = seq_;
  frame.intrinsics = intrinsicsFromFieldOfView(kWidth, kHeight, degToRad(60.0));
  frame.image = cv::Mat(kHeight, kWidth, CV_8UC3, cv::Scalar::all(brightness_));
  return {SourceState::kRunning, frame, {}};
}

void TemplateCamera::stop() {
  {
    const std::lock_guard lock(mutex_);
    running_ = false;
  }
  stopped_.notify_all();
}

std::unique_ptr<FrameSource> makeTemplateCamera(ConfigReader& group) {
  return std::make_unique<TemplateCamera>(static_cast<int>(group.integer("Brightness", 128, 0, 255)));
}
