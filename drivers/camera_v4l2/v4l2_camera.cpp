#include "drivers/camera_v4l2/v4l2_camera.h"

#include <algorithm>
#include <ctime>
#include <utility>

#include "common/drivers/host_clock.h"
#include "common/geometry/angles.h"
#include "common/image_codec/image_codec.h"

namespace vismem {
namespace {

using namespace std::chrono_literals;
using v4l2::Agreement;
using v4l2::FrameBuffers;

constexpr char kStopped[] = "the camera is stopped";
/// Pause before the next read of a device that reports an image and has none.
constexpr auto kAskAgain = 2ms;
/// Maximum length of a message of losses while no frame is taken.
constexpr std::size_t kMaxLostText = 500;

void append(std::string& text, const std::string& more) {
  if (more.empty() || text.size() > kMaxLostText) return;
  text += (text.empty() ? "" : "; ") + more;
}

StampUs monotonicNow_us() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return kSecondUs * now.tv_sec + now.tv_nsec / 1000;
}

std::string whyNoCamera(const V4l2Device& device) {
  const V4l2Identity& identity = device.identity();
  if (identity.captures) return {};
  return device.failed("is no camera that we can read (\"" + identity.card + "\" of driver " +
                       identity.driver +
                       (identity.captures_multiplanar ? " gives pictures in several planes)"
                                                      : " gives no pictures by streaming)"));
}

}  // namespace

V4l2Camera::V4l2Camera(const Params& params)
    : params_(params),
      thread_(kStopped, {[this](const std::stop_token& stop) { return session(stop); },
                         [this] { device_.wake(); }, [](const std::string&) {}}) {
  known_.name = params_.device;
}

V4l2Camera::~V4l2Camera() {
  stop();
}

FrameCapabilities V4l2Camera::capabilities() const {
  const std::lock_guard lock(mutex_);
  return known_;
}

void V4l2Camera::learn(const V4l2Device& device, const Agreement& agreed) {
  const std::lock_guard lock(mutex_);
  known_.name = params_.device + " (" + device.identity().card + ", " + agreed.layout.format.name + ")";
  known_.width = agreed.layout.width;
  known_.height = agreed.layout.height;
  known_.rate_hz = agreed.rate_hz;
}

PortReply V4l2Camera::configure(const FrameRequest& request) {
  if (auto rejection = rejectAbsurd(request)) return *rejection;
  {
    const std::lock_guard lock(mutex_);
    if (running_) return PortReply::rejected("the camera runs; stop it before it is configured");
    request_ = request;
  }
  V4l2Device device;
  std::string away = device.open(params_.device);
  if (away.empty()) away = whyNoCamera(device);
  Agreement agreed;
  if (away.empty()) {
    agreed = negotiate(device, request, params_.format);
    away = agreed.away;
  }
  if (!away.empty()) {
    return PortReply::adjusted("size and rate will be agreed on when the camera is there: " + away);
  }
  if (agreed.reply.ok()) learn(device, agreed);
  return agreed.reply;
}

PortReply V4l2Camera::start() {
  {
    const std::lock_guard lock(mutex_);
    if (running_) return PortReply::accepted();
    running_ = true;
    newest_.reset();
  }
  // A present camera starts to stream within this time; next() reports a failure.
  static_cast<void>(thread_.start(2s));
  return PortReply::accepted();
}

void V4l2Camera::stop() {
  {
    const std::lock_guard lock(mutex_);
    running_ = false;
    newest_.reset();
  }
  changed_.notify_all();
  thread_.stop();
}

FrameResult V4l2Camera::next(std::chrono::milliseconds timeout) {
  const auto deadline = std::chrono::steady_clock::now() + timeout;
  while (true) {
    Newest newest;
    std::string lost;
    bool as_captured = false;
    {
      std::unique_lock lock(mutex_);
      changed_.wait_until(lock, deadline, [this] { return newest_ || !running_; });
      if (!running_) return {SourceState::kWaiting, std::nullopt, kStopped};
      if (!newest_) {
        lock.unlock();
        return {SourceState::kWaiting, std::nullopt, thread_.unavailable()};
      }
      newest = *std::exchange(newest_, std::nullopt);
      lost = std::exchange(lost_, {});
      as_captured = request_.accept_native;
    }
    Frame frame;
    frame.stamp_us = newest.stamp_us;
    frame.seq = newest.seq;
    frame.intrinsics =
        intrinsicsFromFieldOfView(newest.picture->width, newest.picture->height, degToRad(kNominalView_deg));
    if (as_captured) {
      frame.native = std::move(newest.picture);
      return {SourceState::kRunning, std::move(frame), std::move(lost)};
    }
    DecodedImage decoded = decodeImage(*newest.picture);
    if (decoded.error.empty()) {
      frame.image = std::move(decoded.image);
      return {SourceState::kRunning, std::move(frame), std::move(lost)};
    }
    // A defective JPEG: reported with the next frame.
    const std::lock_guard lock(mutex_);
    append(lost, params_.device + ": a picture " + decoded.error);
    append(lost, lost_);
    lost_ = std::move(lost);
  }
}

std::string V4l2Camera::session(const std::stop_token& stop) {
  std::string why = device_.open(params_.device);
  if (why.empty()) why = whyNoCamera(device_);
  if (why.empty()) {
    FrameRequest request;
    {
      const std::lock_guard lock(mutex_);
      request = request_;
      last_sequence_.reset();
    }
    const Agreement agreed = negotiate(device_, request, params_.format);
    why = agreed.away.empty() && !agreed.reply.ok() ? agreed.reply.message : agreed.away;
    if (why.empty()) why = applyControls(device_, params_.controls);
    if (why.empty()) {
      learn(device_, agreed);
      why = stream(stop, agreed);
    }
  }
  device_.close();
  return why;
}

std::string V4l2Camera::stream(const std::stop_token& stop, const Agreement& agreed) {
  FrameBuffers buffers(device_);
  if (std::string why = buffers.begin(); !why.empty()) return why;
  thread_.ready();
  const auto patience = std::max<Clock::duration>(
      params_.silent_after, agreed.rate_hz > 0.0 ? std::chrono::duration_cast<Clock::duration>(
                                                       std::chrono::duration<double>(5.0 / agreed.rate_hz))
                                                 : Clock::duration::zero());
  auto silent_at = Clock::now() + patience;
  while (!stop.stop_requested()) {
    const V4l2Device::Wait wait = device_.waitForFrame(silent_at);
    if (wait == V4l2Device::Wait::kWoken) continue;
    if (wait == V4l2Device::Wait::kDeadline || Clock::now() >= silent_at) {
      return device_.isThere() ? device_.failed("gives no pictures") : device_.failed("was unplugged");
    }
    FrameBuffers::Filled filled;
    std::string why;
    const FrameBuffers::Taken taken = buffers.take(filled, why);
    if (taken == FrameBuffers::Taken::kLost) return why;
    if (taken == FrameBuffers::Taken::kNone) {
      if (wait == V4l2Device::Wait::kError && !device_.isThere()) return device_.failed("was unplugged");
      device_.pauseUntil(Clock::now() + kAskAgain);
      continue;
    }
    silent_at = Clock::now() + patience;
    deliver(filled, agreed);
    if (why = buffers.giveBack(filled); !why.empty()) return why;
  }
  return {};
}

StampUs V4l2Camera::stampLocked(std::int64_t monotonic_us) const {
  const StampUs now_us = hostClock_us();
  const StampUs age_us = monotonicNow_us() - monotonic_us;
  const bool sane = monotonic_us > 0 && age_us >= 0 && age_us < 10 * kSecondUs;
  const StampUs stamp_us = now_us - (sane ? age_us : 0) - params_.delay.count();
  // A small setback of the clock is waited for; a large one begins a new epoch.
  return stamp_us <= last_stamp_us_ && last_stamp_us_ - stamp_us < kSecondUs ? last_stamp_us_ + 1 : stamp_us;
}

void V4l2Camera::deliver(const FrameBuffers::Filled& filled, const Agreement& agreed) {
  std::string problem = filled.damaged ? "was damaged on its way" : "";
  auto picture = filled.damaged ? nullptr : pictureOf(agreed.layout, filled.bytes, problem);
  {
    const std::lock_guard lock(mutex_);
    if (!running_) return;
    // Lost images count too.
    const std::uint32_t step = last_sequence_ ? filled.sequence - *last_sequence_ : 1;
    last_seq_ += step > 0 && step < 0x8000'0000U ? step : 1;
    last_sequence_ = filled.sequence;
    if (!picture) {
      append(losing_, params_.device + ": a picture " + problem);
      return;
    }
    last_stamp_us_ = stampLocked(filled.monotonic_us);
    newest_ = Newest{last_stamp_us_, last_seq_, std::move(picture)};
    append(lost_, std::exchange(losing_, {}));
  }
  changed_.notify_all();
}

std::unique_ptr<FrameSource> makeV4l2Camera(ConfigReader& group) {
  V4l2Camera::Params params;
  group.describe({basic("Device", "better by a persistent name"),
                  expert("Format", "the only one that is taken; auto: raw where the rate allows it"),
                  expert("Delay_ms", "of the kernel's stamps after the middle of the exposure; subtracted")});
  params.device = group.requiredText("Device", "a camera's device, such as /dev/video0");
  std::vector<std::pair<std::string, const v4l2::PixelFormat*>> formats{{"auto", nullptr}};
  for (const v4l2::PixelFormat& format : v4l2::pixelFormats()) formats.emplace_back(format.name, &format);
  params.format = group.choice<const v4l2::PixelFormat*>("Format", nullptr, formats);
  for (const std::string& name : group.children("Control")) {
    params.controls.push_back(
        {name, static_cast<std::int32_t>(group.integer("Control." + name, 0, INT32_MIN, INT32_MAX))});
  }
  params.delay =
      std::chrono::microseconds(static_cast<std::int64_t>(1000.0 * group.real("Delay_ms", 0.0, 0.0, 1000.0)));
  return std::make_unique<V4l2Camera>(params);
}

}  // namespace vismem
