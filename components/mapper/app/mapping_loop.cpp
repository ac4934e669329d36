#include "mapper/app/mapping_loop.h"

#include <algorithm>
#include <chrono>
#include <utility>

namespace vismem {
namespace {

using std::chrono::milliseconds;

/// Longest wait for an update or an image.
constexpr milliseconds kWait{100};
/// The image reaches the memory and the mapper at about the same time.
constexpr milliseconds kImageWait{100};
constexpr milliseconds kWatchEvery{500};
/// Two seconds of a camera of 30 Hz: the memory answers with the image that it has just analysed.
constexpr std::size_t kFrames = 64;
/// A memory without an update for this long counts as silent.
constexpr milliseconds kQuiet{1500};

}  // namespace

void RecentFrames::add(Frame frame) {
  {
    const std::lock_guard lock(mutex_);
    // A source that restarted or was rewound.
    if (!frames_.empty() && frame.stamp_us <= frames_.back().stamp_us) frames_.clear();
    frames_.push_back(std::move(frame));
    if (frames_.size() > most_) frames_.pop_front();
  }
  came_.notify_all();
}

Frame RecentFrames::at(StampUs stamp_us, milliseconds timeout) {
  std::unique_lock lock(mutex_);
  came_.wait_for(lock, timeout, [&] { return !frames_.empty() && frames_.back().stamp_us >= stamp_us; });
  const auto found = std::find_if(frames_.begin(), frames_.end(),
                                  [&](const Frame& frame) { return frame.stamp_us == stamp_us; });
  if (found != frames_.end()) return *found;
  Frame missed;
  missed.stamp_us = stamp_us;
  return missed;
}

MappingLoop::MappingLoop(const Params& params, VisualMemorySource& memory, FrameSource& camera,
                         StatusBoard& status)
    : params_(params),
      memory_(memory),
      camera_(camera),
      status_(status),
      frames_(kFrames),
      drive_(params.keyframes, params.range_m) {
  progress_.message = "no update of the memory yet";
}

void MappingLoop::start(Watch watch, Failed failed) {
  watch_ = std::move(watch);
  failed_ = std::move(failed);
  const auto guarded = [this](void (MappingLoop::*work)(const std::stop_token&)) {
    return [this, work](const std::stop_token& stop) {
      try {
        (this->*work)(stop);
      } catch (...) {
        failed_(std::current_exception());
      }
    };
  };
  camera_thread_ = std::jthread(guarded(&MappingLoop::readCamera));
  thread_ = std::jthread(guarded(&MappingLoop::run));
}

void MappingLoop::stop() {
  camera_thread_.request_stop();
  thread_.request_stop();
  if (camera_thread_.joinable()) camera_thread_.join();
  if (thread_.joinable()) thread_.join();
}

DriveProgress MappingLoop::progress() const {
  const std::lock_guard lock(mutex_);
  return progress_;
}

DriveCollector MappingLoop::drive() const {
  const std::lock_guard lock(mutex_);
  return drive_;
}

void MappingLoop::restart() {
  const std::lock_guard lock(mutex_);
  drive_ = DriveCollector(params_.keyframes, params_.range_m);
  elements_ = {};
  progress_ = {};
}

void MappingLoop::readCamera(const std::stop_token& stop) {
  camera_.start();
  while (!stop.stop_requested()) {
    status_.alive("images");
    FrameResult result = camera_.next(kWait);
    if (result.state == SourceState::kFinished) std::this_thread::sleep_for(kWait);
    if (!result.frame) continue;
    status_.count("images");
    frames_.add(std::move(*result.frame));
  }
  camera_.stop();
  status_.ended("images");
}

void MappingLoop::add(const MemoryUpdate& update) {
  const Frame frame = frames_.at(update.analysis->stamp_us, kImageWait);
  if (frame.image.empty()) status_.count("updates without their image");
  const std::lock_guard lock(mutex_);
  if (static_cast<int>(drive_.record().keyframes.size()) >= params_.most_keyframes) {
    progress_.message = "the drive is as long as a map can be: build it, then restart";
    return;
  }
  const auto begin = std::chrono::steady_clock::now();
  if (drive_.add(frame, update, elements_.of(update))) status_.count("keyframes");
  status_.latency("record", std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
  const auto& keyframes = drive_.record().keyframes;
  if (keyframes.empty()) return;
  progress_.message =
      drive_.isBroken() ? "time or odometry jumped: the drive ends there; restart begins anew" : "";
  progress_.keyframes = static_cast<int>(keyframes.size());
  progress_.way_m = keyframes.back().way_m;
  progress_.begin_us = keyframes.front().stamp_us;
  progress_.end_us = keyframes.back().stamp_us;
}

void MappingLoop::report(const MemoryResult& result) {
  const std::lock_guard lock(mutex_);
  progress_.finished = result.state == SourceState::kFinished;
  progress_.message = "no update of the memory (" + result.message + ")";
}

void MappingLoop::run(const std::stop_token& stop) {
  using Clock = std::chrono::steady_clock;
  std::uint64_t revision = 0;
  auto last_update = Clock::now();
  Clock::time_point watched{};
  while (!stop.stop_requested()) {
    status_.alive("mapping");
    if (Clock::now() - watched >= kWatchEvery) {
      watched = Clock::now();
      watch_(progress());
    }
    const MemoryResult result = memory_.next(revision, kWait);
    if (result.state == SourceState::kRunning && result.update.snapshot && result.update.analysis) {
      last_update = Clock::now();
      revision = result.update.snapshot->revision;
      add(result.update);
    } else if (result.state == SourceState::kFinished || Clock::now() - last_update > kQuiet) {
      report(result);
      if (result.state == SourceState::kFinished) std::this_thread::sleep_for(kWait);
    }
  }
  status_.ended("mapping");
}

}  // namespace vismem
