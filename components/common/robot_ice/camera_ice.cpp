#include "common/robot_ice/camera_ice.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/robot_ice/conversions.h"

namespace vismem {
namespace {

/// Maximum wait of the pump for one frame, which bounds the duration of stop().
constexpr std::chrono::milliseconds kPumpWait{100};
/// Pause after an empty answer, for sources that answer without waiting.
constexpr std::chrono::milliseconds kPumpPause{10};
/// Number of frames encoded ahead: covers a client that requests one per second at 30 Hz.
constexpr int kExpectedFrames = 30;
/// Period at which a waiting client checks for a stop.
constexpr std::chrono::milliseconds kStopCheck{100};

}  // namespace

void FrameBroadcaster::start(FrameSource& source, Watch watch) {
  setCapabilities(source.capabilities());
  if (thread_.joinable()) return;
  thread_ = std::jthread(
      [this, &source, watch = std::move(watch)](const std::stop_token& stop) { pump(source, watch, stop); });
}

void FrameBroadcaster::stop() {
  thread_.request_stop();
  latest_.stop();
  if (thread_.joinable()) thread_.join();
}

void FrameBroadcaster::publish(Frame frame) {
  const auto seq = static_cast<std::int64_t>(frame.seq);
  const auto encoded = std::make_shared<const EncodedFrame>(std::move(frame), jpeg_quality_);
  latest_.publish(encoded, seq);
  ++published_;
  if (consumers_changed_) consumers_changed_();
  for (std::size_t format = 0; format < expected_.size(); ++format) {
    if (expected_[format] <= 0) continue;
    --expected_[format];
    encoded->jderobotImage(static_cast<FrameFormat>(format));
  }
}

void FrameBroadcaster::onConsumers(std::function<void()> changed) {
  latest_.onKept(changed);
  consumers_changed_ = std::move(changed);
}

void FrameBroadcaster::expect(FrameFormat format) {
  expected_[static_cast<std::size_t>(format)] = kExpectedFrames;
}

void FrameBroadcaster::setCapabilities(FrameCapabilities capabilities) {
  const std::lock_guard lock(mutex_);
  capabilities_ = std::move(capabilities);
}

FrameCapabilities FrameBroadcaster::capabilities() const {
  const std::lock_guard lock(mutex_);
  return capabilities_;
}

void FrameBroadcaster::pump(FrameSource& source, const Watch& watch, const std::stop_token& stop) {
  bool first = true;
  while (!stop.stop_requested()) {
    const auto began = std::chrono::steady_clock::now();
    FrameResult result;
    try {
      result = source.next(kPumpWait);
    } catch (const std::exception& error) {
      // Sources do not throw, but a third-party driver must not end the process.
      result = {SourceState::kWaiting, std::nullopt, error.what()};
    }
    const bool picture = result.state == SourceState::kRunning && result.frame &&
                         (!result.frame->image.empty() || result.frame->native);
    if (result.state == SourceState::kRunning && !picture) {
      result = {SourceState::kWaiting, std::nullopt, "the source gave no picture"};
    }
    if (watch) watch(result);
    if (picture) {
      // A device's size and rate may be known only now.
      if (std::exchange(first, false)) setCapabilities(source.capabilities());
      publish(std::move(*result.frame));
      continue;
    }
    // An empty reason: no frame was due yet.
    if (!result.message.empty() || result.state == SourceState::kFinished)
      setState(result.state, result.message);
    if (std::chrono::steady_clock::now() - began < kPumpPause) std::this_thread::sleep_for(kPumpPause);
  }
}

void CameraServant::getNextAsync(std::string format, Ice::Long last_sequence,
                                 std::function<void(const avm::FrameResult&)> response,
                                 std::function<void(std::exception_ptr)> exception, const Ice::Current&) {
  const auto wanted = frameFormatFromName(format);
  if (!wanted) throw avm::InvalidArgument(unknownFormat(format));
  std::optional<std::int64_t> have;
  if (last_sequence >= 0) have = last_sequence;
  answerNext(*wanted, have, std::chrono::steady_clock::now() + kLongPollWait, std::move(response),
             std::move(exception));
}

void CameraServant::answerNext(FrameFormat format, std::optional<std::int64_t> have, Deadline deadline,
                               std::function<void(const avm::FrameResult&)> response,
                               std::function<void(std::exception_ptr)> exception) {
  const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now());
  broadcaster_.latest().whenOther(have, std::max(left, std::chrono::milliseconds(0)),
                                  [this, format, deadline, response = std::move(response),
                                   exception = std::move(exception)](const auto& reading) mutable {
                                    try {
                                      if (!reading.value) {
                                        response({toIce(reading.state), reading.message, {}});
                                        return;
                                      }
                                      const avm::FrameResult& result = reading.value->result(format);
                                      const bool good = result.state == avm::SourceState::Running;
                                      if (good || std::chrono::steady_clock::now() >= deadline) {
                                        response(result);
                                        return;
                                      }
                                    } catch (...) {
                                      exception(std::current_exception());
                                      return;
                                    }
                                    // An undecodable image is skipped, because the caller would request it
                                    // again at once.
                                    answerNext(format, reading.revision, deadline, std::move(response),
                                               std::move(exception));
                                  });
}

avm::CameraInfo CameraServant::getInfo(const Ice::Current&) {
  const FrameCapabilities capabilities = broadcaster_.capabilities();
  avm::CameraInfo info{capabilities.name,
                       capabilities.width,
                       capabilities.height,
                       capabilities.rate_hz,
                       capabilities.knows_camera_pose,
                       frameFormatNames()};
  if (const auto frame = broadcaster_.latest().latest()) {
    info.width = frame->width();
    info.height = frame->height();
    const std::string captured = frameFormatNames()[static_cast<std::size_t>(frame->capturedFormat())];
    std::stable_partition(info.formats.begin(), info.formats.end(),
                          [&](const std::string& format) { return format == captured; });
  }
  return info;
}

std::shared_ptr<jderobot::ImageDescription> CameraServant::getImageDescription(const Ice::Current& current) {
  if (const auto newest = broadcaster_.latest().latest()) {
    if (const auto image = newest->jderobotImage(FrameFormat::kRgb8)) return image->description;
  }
  const avm::CameraInfo info = getInfo(current);
  return std::make_shared<jderobot::ImageDescription>(info.width, info.height, info.width * info.height * 3,
                                                      "RGB8", "");
}

jderobot::ImageFormat CameraServant::getImageFormat(const Ice::Current&) {
  return frameFormatNames();
}

std::shared_ptr<jderobot::ImageData> CameraServant::getImageData(std::string format, const Ice::Current&) {
  const auto wanted = frameFormatFromName(format);
  if (!wanted) throw jderobot::DataNotExistException(unknownFormat(format));
  const auto frame = broadcaster_.latest().latest();
  if (!frame) throw jderobot::HardwareFailedException(broadcaster_.latest().message());
  broadcaster_.expect(*wanted);
  auto image = frame->jderobotImage(*wanted);
  if (!image) throw jderobot::HardwareFailedException(frame->result(*wanted).message);
  return image;
}

std::shared_ptr<jderobot::CameraDescription> CameraServant::getCameraDescription(const Ice::Current&) {
  auto description = std::make_shared<jderobot::CameraDescription>();
  description->name = name_;
  description->shortDescription = broadcaster_.capabilities().name;
  const auto newest = broadcaster_.latest().latest();
  if (!newest) return description;
  const Frame& frame = newest->frame();
  description->fdistx = static_cast<float>(frame.intrinsics.fx);
  description->fdisty = static_cast<float>(frame.intrinsics.fy);
  description->u0 = static_cast<float>(frame.intrinsics.cx);
  description->v0 = static_cast<float>(frame.intrinsics.cy);
  if (frame.T_robot_camera) {
    const Eigen::Vector3d position = frame.T_robot_camera->translation();
    const Eigen::Vector3d ahead = *frame.T_robot_camera * Eigen::Vector3d::UnitZ();
    description->posx = static_cast<float>(position.x());
    description->posy = static_cast<float>(position.y());
    description->posz = static_cast<float>(position.z());
    description->foax = static_cast<float>(ahead.x());
    description->foay = static_cast<float>(ahead.y());
    description->foaz = static_cast<float>(ahead.z());
    // A level camera has its x axis level and its y axis down; turning about z (right to down) tips both.
    const Eigen::Matrix3d R_robot_camera = frame.T_robot_camera->rotation();
    description->roll = static_cast<float>(std::atan2(-R_robot_camera(2, 0), -R_robot_camera(2, 1)));
  }
  return description;
}

int CameraServant::setCameraDescription(std::shared_ptr<jderobot::CameraDescription>, const Ice::Current&) {
  return -1;
}

std::string CameraServant::startCameraStreaming(const Ice::Current&) {
  return {};
}

RemoteFrameSource::RemoteFrameSource(const std::shared_ptr<avm::CameraPrx>& proxy, FrameFormat format,
                                     LinkReport report)
    : proxy_(boundedProxy(proxy, kInvocationTimeout_ms)),
      format_(format),
      frames_(proxy_, std::move(report)),
      info_(proxy_,
            [this](auto done, auto failed) { proxy_->getInfoAsync(std::move(done), std::move(failed)); }) {}

FrameCapabilities RemoteFrameSource::capabilities() const {
  info_.ask(std::chrono::milliseconds(0));
  const auto info = info_.last();
  if (!info) return {proxy_ ? proxy_->ice_toString() : "no camera", 0, 0, 0.0, false};
  return {info->name, info->width, info->height, info->rateHz, info->knowsCameraPose};
}

PortReply RemoteFrameSource::configure(const FrameRequest& request) {
  if (auto rejection = rejectAbsurd(request)) return *rejection;
  const FrameCapabilities known = capabilities();
  const auto as_asked = [](auto asked, auto given) { return asked == 0 || asked == given; };
  if (as_asked(request.width, known.width) && as_asked(request.height, known.height) &&
      as_asked(request.rate_hz, known.rate_hz)) {
    return PortReply::accepted();
  }
  if (known.width == 0) return PortReply::adjusted("the server decides, and it is not known yet");
  return PortReply::adjusted(std::to_string(known.width) + "x" + std::to_string(known.height) + " at " +
                             std::to_string(known.rate_hz) + " Hz, as the server gives it");
}

PortReply RemoteFrameSource::start() {
  if (!proxy_) return PortReply::rejected("no camera is configured");
  stopped_ = false;
  const std::string failure = info_.ask(kLongPollWait);
  return failure.empty() ? PortReply::accepted() : PortReply::adjusted("waiting for the camera: " + failure);
}

FrameResult RemoteFrameSource::next(std::chrono::milliseconds timeout) {
  const auto deadline = std::chrono::steady_clock::now() + timeout;
  PendingCall<avm::FrameResult>::Outcome outcome;
  std::string why = nothing_yet_;
  // In slices, so that stop() does not wait for the timeout; the request stays pending.
  for (auto left = timeout;;) {
    if (stopped_) return {SourceState::kWaiting, std::nullopt, "the camera's client is stopped"};
    outcome = frames_.wait(
        [this](auto done, auto failed) {
          proxy_->getNextAsync(frameFormatNames()[static_cast<std::size_t>(format_)], last_seq_,
                               std::move(done), std::move(failed));
        },
        std::min(left, kStopCheck));
    if (!outcome.failure.empty()) why = outcome.failure;
    if (outcome.result && outcome.result->state == avm::SourceState::Waiting)
      why = nothing_yet_ = outcome.result->message;
    left = std::chrono::ceil<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now());
    if (left <= std::chrono::milliseconds(0)) break;
    if (!outcome.result) continue;
    if (outcome.result->state != avm::SourceState::Waiting) break;
    // The server's own wait has ended, not this one. A server that stops answers at once.
    std::this_thread::sleep_for(std::min(left, kPumpPause));
  }
  if (!outcome.result) return {SourceState::kWaiting, std::nullopt, why};
  // Also of an unusable frame, which would be sent again otherwise.
  if (outcome.result->state == avm::SourceState::Running) last_seq_ = outcome.result->image.seq;
  return decodeFrame(*outcome.result);
}

}  // namespace vismem
