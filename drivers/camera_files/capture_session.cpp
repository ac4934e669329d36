#include "drivers/camera_files/capture_session.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "common/drivers/host_clock.h"
#include "common/geometry/angles.h"
#include "common/image_codec/image_codec.h"

namespace vismem {
namespace {

/// Maximum length of a message of losses while no frame is taken.
constexpr std::size_t kMaxLostText = 500;

void append(std::string& text, const std::string& more) {
  if (text.size() > kMaxLostText) return;
  text += (text.empty() ? "" : "; ") + more;
  if (text.size() > kMaxLostText) text += "; and more";
}

std::string sizeText(cv::Size size) {
  return std::to_string(size.width) + "x" + std::to_string(size.height);
}

}  // namespace

FileCamera::Session::Session(std::unique_ptr<PictureSource> source, const Params& params,
                             const FrameRequest& request, const Begin& begin)
    : source_(std::move(source)),
      params_(params),
      request_(request),
      begin_(begin),
      pause_(params.first_pause),
      reached_(begin),
      thread_([this](const std::stop_token& stop) { run(stop); }) {}

FileCamera::Session::~Session() {
  stop();
}

void FileCamera::Session::stop() {
  thread_.request_stop();
  {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
    frame_.reset();
  }
  changed_.notify_all();
}

FrameCapabilities FileCamera::Session::known() const {
  const std::lock_guard lock(mutex_);
  return known_;
}

FileCamera::Session::Begin FileCamera::Session::reached() const {
  const std::lock_guard lock(mutex_);
  return reached_;
}

FrameResult FileCamera::Session::next(std::chrono::milliseconds timeout) {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, timeout, [this] { return frame_ || finished_ || stopped_; });
  if (stopped_) return {SourceState::kWaiting, std::nullopt, "the camera is stopped"};
  if (frame_) {
    return {SourceState::kRunning, std::exchange(frame_, std::nullopt), std::exchange(lost_, {})};
  }
  if (finished_) return {SourceState::kFinished, std::nullopt, "end of " + source_->name()};
  return {SourceState::kWaiting, std::nullopt, why_};
}

void FileCamera::Session::run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    if (std::string why = source_->open(); !why.empty()) {
      away(why, stop);
      continue;
    }
    if (!playOnce(stop)) break;
  }
  source_->close();
  ended_ = true;
}

bool FileCamera::Session::playOnce(const std::stop_token& stop) {
  const double own_rate_hz = source_->ownRate_hz();
  own_pace_ = own_rate_hz > 0.0;
  rate_hz_ = own_pace_                ? own_rate_hz
             : request_.rate_hz > 0.0 ? std::min(request_.rate_hz, kMaxRate_hz)
                                      : params_.default_rate_hz;
  in_pass_ = 0;
  last_own_us_.reset();
  while (!stop.stop_requested()) {
    PictureResult result = source_->read();
    switch (result.kind) {
      case PictureResult::Kind::kPicture:
        if (!source_->isLive() && !awaitDue(result.picture, stop)) return false;
        pause_ = params_.first_pause;
        deliver(std::move(result.picture));
        break;
      case PictureResult::Kind::kLost:
        lose(result.message);
        break;
      case PictureResult::Kind::kAway:
        source_->close();
        away(result.message, stop);
        return true;
      case PictureResult::Kind::kEnd: {
        if (params_.loop) return true;
        const std::lock_guard lock(mutex_);
        finished_ = true;
        changed_.notify_all();
        return false;
      }
    }
  }
  return false;
}

StampUs FileCamera::Session::period_us() const {
  return std::max<StampUs>(1, toStampUs(1.0 / rate_hz_));
}

bool FileCamera::Session::awaitDue(const Picture& picture, const std::stop_token& stop) {
  const auto now = Clock::now();
  StampUs step_us = period_us();
  if (own_pace_ && picture.own_us && last_own_us_)
    step_us = std::max<StampUs>(1, *picture.own_us - *last_own_us_);
  if (own_pace_ && picture.own_us) last_own_us_ = picture.own_us;
  // The first image is due at once. A delayed thread continues from now, without catching up.
  due_ = due_ == Clock::time_point{} ? now : std::max(due_ + std::chrono::microseconds(step_us), now);
  ++in_pass_;
  return pauseUntil(due_, stop);
}

void FileCamera::Session::deliver(Picture picture) {
  std::string problem;
  std::optional<Frame> frame = frameOf(picture, problem);
  if (!frame) {
    lose(picture.name + ": " + problem);
    return;
  }
  const std::lock_guard lock(mutex_);
  if (stopped_) return;
  frame->stamp_us = stampOf(picture);
  frame->seq = ++reached_.seq;
  reached_.stamp_us = frame->stamp_us;
  known_.width = frame->intrinsics.width;
  known_.height = frame->intrinsics.height;
  known_.rate_hz = rate_hz_;
  frame_ = std::move(frame);
  // The losses of a frame that was not taken are reported with this one.
  if (!losing_.empty()) append(lost_, std::exchange(losing_, {}));
  why_.clear();
  changed_.notify_all();
}

std::optional<Frame> FileCamera::Session::frameOf(Picture& picture, std::string& problem) {
  const cv::Size own(picture.width(), picture.height());
  if (size_.empty()) size_ = fittingSize(own, {request_.width, request_.height});
  // The same aspect ratio within half a pixel of rounding and 1 %.
  const double stretch =
      static_cast<double>(own.width) * size_.height / (static_cast<double>(own.height) * size_.width);
  if (std::abs(stretch - 1.0) > 0.01 + 0.5 / std::min(size_.width, size_.height)) {
    problem =
        "has " + sizeText(own) + " pixels, which does not fit the " + sizeText(size_) + " of the others";
    return std::nullopt;
  }
  Frame frame;
  if (picture.native && request_.accept_native && own == size_) {
    frame.native = picture.native;
  } else {
    if (picture.image.empty()) {
      DecodedImage decoded = decodeImage(*picture.native);
      if (!decoded.error.empty()) {
        problem = decoded.error;
        return std::nullopt;
      }
      picture.image = std::move(decoded.image);
    }
    if (own == size_) {
      frame.image = picture.image;
    } else {
      const bool smaller = size_.width < own.width;
      cv::resize(picture.image, frame.image, size_, 0, 0, smaller ? cv::INTER_AREA : cv::INTER_LINEAR);
    }
  }
  frame.intrinsics = intrinsicsFromFieldOfView(size_.width, size_.height, degToRad(kNominalView_deg));
  return frame;
}

StampUs FileCamera::Session::stampOf(const Picture& picture) {
  const StampUs last_us = reached_.stamp_us;
  if (params_.stamps == Stamps::kHost || source_->isLive()) {
    const StampUs now_us = hostClock_us();
    // A small setback of the clock is waited for; a large one begins a new epoch.
    return now_us <= last_us && last_us - now_us < kSecondUs ? last_us + 1 : now_us;
  }
  const StampUs own_us = picture.own_us ? *picture.own_us : (in_pass_ - 1) * period_us();
  // A new pass or session continues at the end of the last one.
  if (reached_.seq > 0 && own_us + own_offset_us_ <= last_us) own_offset_us_ = last_us + period_us() - own_us;
  return own_us + own_offset_us_;
}

void FileCamera::Session::lose(const std::string& what) {
  append(losing_, what);
}

void FileCamera::Session::away(const std::string& why, const std::stop_token& stop) {
  {
    const std::lock_guard lock(mutex_);
    why_ = why;
  }
  due_ = {};
  size_ = {};  // a source that returns may have another size
  pauseUntil(Clock::now() + pause_, stop);
  pause_ = std::min(2 * pause_, params_.longest_pause);
}

bool FileCamera::Session::pauseUntil(Clock::time_point until, const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  wake_.wait_until(lock, stop, until, [] { return false; });
  return !stop.stop_requested();
}

}  // namespace vismem
