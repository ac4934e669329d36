#include "replay_server/app/log_player.h"

#include <algorithm>
#include <chrono>
#include <string>
#include <utility>

#include "replay_server/core/log_ports.h"

namespace vismem {
namespace {

/// End of the replay [us]: the stamp up to which the last image needs samples for its interpolation.
StampUs endOf(const RobotLog& log) {
  const StampUs last_us = log.frameStamps().back();
  StampUs end_us = last_us;
  const auto cover = [&](const auto& samples) {
    const std::size_t count = countToCover(samples, last_us);
    if (count > 0) end_us = std::max(end_us, samples[count - 1].stamp_us);
  };
  cover(log.odometry());
  cover(log.joints());
  return end_us;
}

/// Index of the last frame at or before a stamp; 0 before the first.
std::size_t frameAt(const std::vector<StampUs>& stamps, StampUs stamp_us) {
  const auto after = std::upper_bound(stamps.begin(), stamps.end(), stamp_us);
  return after == stamps.begin() ? 0 : static_cast<std::size_t>(after - stamps.begin()) - 1;
}

}  // namespace

StampUs SteadyPacingClock::now() const {
  return std::chrono::duration_cast<std::chrono::microseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

void SteadyPacingClock::waitUntil(std::unique_lock<std::mutex>& lock, std::condition_variable& wake,
                                  StampUs until_us) {
  wake.wait_until(lock, std::chrono::steady_clock::time_point(std::chrono::microseconds(until_us)));
}

class LogPlayer::CameraPort : public FrameSource {
 public:
  explicit CameraPort(LogPlayer& player) : player_(player) {}
  FrameCapabilities capabilities() const override { return capabilitiesOf(player_.log_); }
  PortReply configure(const FrameRequest& request) override {
    PortReply reply = configureFor(player_.log_, request);
    if (reply.ok()) {
      const std::lock_guard lock(player_.mutex_);
      player_.native_ = request.accept_native;
    }
    return reply;
  }
  PortReply start() override {
    player_.setStopped(stopped_, false);
    return PortReply::accepted();
  }
  FrameResult next(std::chrono::milliseconds timeout) override {
    return player_.nextFrame(stopped_, timeout);
  }
  void stop() override { player_.setStopped(stopped_, true); }

 private:
  LogPlayer& player_;
  bool stopped_ = false;  ///< guarded by the player's mutex
};

class LogPlayer::PanTiltPort : public PanTiltUnit {
 public:
  explicit PanTiltPort(LogPlayer& player) : player_(player) {}
  PanTiltLimits limits() const override { return limitsOf(player_.log_); }
  PortReply start() override {
    player_.setStopped(reader_.stopped, false);
    return PortReply::accepted();
  }
  PortReply command(const PanTiltCommand& command) override { return ignored(command); }
  SampleBatch<PanTiltSample> samplesSince(StampUs after_us, std::chrono::milliseconds timeout) override {
    return player_.samplesSince(player_.log_.joints(), reader_, after_us, timeout);
  }
  void stop() override { player_.setStopped(reader_.stopped, true); }

 private:
  LogPlayer& player_;
  SampleReader reader_;  ///< guarded by the player's mutex
};

class LogPlayer::BasePort : public MobileBase {
 public:
  explicit BasePort(LogPlayer& player) : player_(player) {}
  BaseLimits limits() const override { return {}; }
  PortReply start() override {
    player_.setStopped(reader_.stopped, false);
    return PortReply::accepted();
  }
  PortReply setVelocity(double v_mps, double w_radps) override { return ignoredVelocity(v_mps, w_radps); }
  SampleBatch<OdometrySample> samplesSince(StampUs after_us, std::chrono::milliseconds timeout) override {
    return player_.samplesSince(player_.log_.odometry(), reader_, after_us, timeout);
  }
  void stop() override { player_.setStopped(reader_.stopped, true); }

 private:
  LogPlayer& player_;
  SampleReader reader_;  ///< guarded by the player's mutex
};

LogPlayer::LogPlayer(RobotLog log, const Params& params, PacingClock& clock)
    : log_(std::move(log)),
      clock_(clock),
      timeline_(log_.frameStamps().front(), endOf(log_), params.rate, params.loop, params.start, clock.now()),
      camera_(std::make_unique<CameraPort>(*this)),
      pan_tilt_(std::make_unique<PanTiltPort>(*this)),
      base_(std::make_unique<BasePort>(*this)) {}

LogPlayer::~LogPlayer() {
  shutDown();
}

FrameSource& LogPlayer::camera() {
  return *camera_;
}
PanTiltUnit& LogPlayer::panTilt() {
  return *pan_tilt_;
}
MobileBase& LogPlayer::base() {
  return *base_;
}

void LogPlayer::updateLocked() const {
  timeline_.update(clock_.now());
}

void LogPlayer::consumerArrived() {
  {
    const std::lock_guard lock(mutex_);
    if (timeline_.state() != ReplayState::kWaiting) return;
    timeline_.play(clock_.now());
  }
  wake_.notify_all();
}

void LogPlayer::shutDown() {
  {
    const std::lock_guard lock(mutex_);
    shut_down_ = true;
  }
  wake_.notify_all();
}

std::string LogPlayer::whyNothing() const {
  switch (timeline_.state()) {
    case ReplayState::kWaiting:
      return "the replay waits for a client of its camera, or for a command to play";
    case ReplayState::kPaused:
      return "the replay is paused";
    case ReplayState::kFinished:
      return "end of " + log_.file();
    case ReplayState::kPlaying:
      break;
  }
  return "nothing new yet";
}

bool LogPlayer::waitLocked(std::unique_lock<std::mutex>& lock, std::optional<StampUs> stamp_us,
                           StampUs deadline_us) {
  if (shut_down_ || clock_.now() >= deadline_us) return false;
  StampUs until_us = deadline_us;
  if (stamp_us) {
    if (const auto due_us = timeline_.clockAt(*stamp_us)) until_us = std::min(until_us, *due_us);
  }
  clock_.waitUntil(lock, wake_, until_us);
  return true;
}

FrameResult LogPlayer::nextFrame(const bool& stopped, std::chrono::milliseconds timeout) {
  const auto& stamps = log_.frameStamps();
  std::unique_lock lock(mutex_);
  const StampUs deadline_us = clock_.now() + std::chrono::microseconds(timeout).count();
  while (true) {
    if (stopped) return {SourceState::kWaiting, std::nullopt, "the camera is stopped"};
    updateLocked();
    if (seen_jumps_ != timeline_.jumps()) {
      seen_jumps_ = timeline_.jumps();
      seq_offset_ += stamps.size();
      next_frame_ = frameAt(stamps, timeline_.segmentBegin());
    }
    const std::size_t newest = frameAt(stamps, timeline_.position());
    const bool begun = timeline_.state() != ReplayState::kWaiting;
    if (begun && !shut_down_ && newest >= next_frame_ && newest < stamps.size()) {
      next_frame_ = newest + 1;
      const std::uint64_t seq_offset = seq_offset_;
      const bool native = native_;
      lock.unlock();  // decoding takes its time; frames have one consumer
      try {
        Frame frame = log_.readFrame(newest, native);
        frame.seq += seq_offset;
        return {SourceState::kRunning, std::move(frame), ""};
      } catch (const RecordingError& error) {
        return {SourceState::kWaiting, std::nullopt, error.what()};
      }
    }
    if (timeline_.state() == ReplayState::kFinished)
      return {SourceState::kFinished, std::nullopt, whyNothing()};
    std::optional<StampUs> due_us;
    if (next_frame_ < stamps.size()) due_us = stamps[next_frame_];
    // The end of the log comes a little after its last frame.
    if (!due_us) due_us = endOf(log_);
    if (!waitLocked(lock, due_us, deadline_us)) return {SourceState::kWaiting, std::nullopt, whyNothing()};
  }
}

template <typename Sample>
SampleBatch<Sample> LogPlayer::samplesSince(const std::vector<Sample>& samples, SampleReader& reader,
                                            StampUs after_us, std::chrono::milliseconds timeout) {
  if (samples.empty()) return {SourceState::kWaiting, {}, log_.file() + " has none of these samples"};
  std::unique_lock lock(mutex_);
  const StampUs deadline_us = clock_.now() + std::chrono::microseconds(timeout).count();
  while (true) {
    updateLocked();
    // From the last sample before the frame at which this part of the replay began: that frame needs it.
    const StampUs frame_us = log_.frameStamps()[frameAt(log_.frameStamps(), timeline_.segmentBegin())];
    const std::size_t before = firstAfter(samples, frame_us);
    std::size_t begin = before == 0 ? 0 : before - 1;
    // After a jump what the reader has already may lie ahead.
    const bool jumped = reader.jumps != timeline_.jumps();
    if (!jumped) begin = std::max(begin, firstAfter(samples, after_us));
    const std::size_t end = firstAfter(samples, timeline_.position());
    if (begin < end && timeline_.state() != ReplayState::kWaiting && !shut_down_) {
      reader.jumps = timeline_.jumps();
      return {SourceState::kRunning,
              {samples.begin() + static_cast<std::ptrdiff_t>(begin),
               samples.begin() + static_cast<std::ptrdiff_t>(end)},
              ""};
    }
    if (timeline_.state() == ReplayState::kFinished) return {SourceState::kFinished, {}, whyNothing()};
    std::optional<StampUs> due_us;
    if (end < samples.size()) due_us = samples[end].stamp_us;
    if (reader.stopped) return {SourceState::kWaiting, {}, "this port of the recording is stopped"};
    if (!waitLocked(lock, due_us, deadline_us)) return {SourceState::kWaiting, {}, whyNothing()};
  }
}

void LogPlayer::setStopped(bool& stopped, bool value) {
  {
    const std::lock_guard lock(mutex_);
    stopped = value;
  }
  wake_.notify_all();
}

ReplayStatus LogPlayer::status() const {
  const std::lock_guard lock(mutex_);
  updateLocked();
  ReplayStatus status;
  status.state = timeline_.state();
  status.file = log_.file();
  status.first_us = log_.frameStamps().front();
  status.last_us = log_.frameStamps().back();
  status.stamp_us = timeline_.position();
  status.rate = timeline_.rate();
  status.loop = timeline_.loop();
  return status;
}

PortReply LogPlayer::play() {
  {
    const std::lock_guard lock(mutex_);
    timeline_.play(clock_.now());
  }
  wake_.notify_all();
  return PortReply::accepted();
}

PortReply LogPlayer::pause() {
  {
    const std::lock_guard lock(mutex_);
    timeline_.pause(clock_.now());
    if (timeline_.state() == ReplayState::kFinished) return PortReply::rejected("the replay is at its end");
  }
  wake_.notify_all();
  return PortReply::accepted();
}

PortReply LogPlayer::seek(StampUs stamp_us) {
  StampUs reached_us = 0;
  {
    const std::lock_guard lock(mutex_);
    reached_us = timeline_.seek(stamp_us, clock_.now());
  }
  wake_.notify_all();
  if (reached_us == stamp_us) return PortReply::accepted();
  return PortReply::adjusted("the played stamps end at " + std::to_string(reached_us) + " us");
}

PortReply LogPlayer::setRate(double rate) {
  if (!(rate >= 0.01 && rate <= 1000.0)) {
    return PortReply::rejected("rate " + std::to_string(rate) + " (must be 0.01..1000)");
  }
  {
    const std::lock_guard lock(mutex_);
    timeline_.setRate(rate, clock_.now());
  }
  wake_.notify_all();
  return PortReply::accepted();
}

PortReply LogPlayer::setPlayLength(StampUs length_us) {
  if (length_us < 0)
    return PortReply::rejected("a length of " + std::to_string(length_us) + " us (must be 0 or more)");
  const std::lock_guard lock(mutex_);
  timeline_.setPlayLength(length_us);
  return PortReply::accepted();
}

PortReply LogPlayer::setRange(StampUs begin_us, StampUs end_us) {
  const StampUs first_us = log_.frameStamps().front();
  const StampUs last_us = endOf(log_);
  if (begin_us >= end_us || begin_us >= last_us || end_us <= first_us) {
    return PortReply::rejected("the range " + std::to_string(begin_us) + ".." + std::to_string(end_us) +
                               " us (must begin before its end and meet the log, " +
                               std::to_string(first_us) + ".." + std::to_string(last_us) + " us)");
  }
  const StampUs begin = std::max(begin_us, first_us);
  const StampUs end = std::min(end_us, last_us);
  {
    const std::lock_guard lock(mutex_);
    timeline_.setRange(begin, end, clock_.now());
  }
  wake_.notify_all();
  if (begin == begin_us && end == end_us) return PortReply::accepted();
  return PortReply::adjusted("the range is " + std::to_string(begin) + ".." + std::to_string(end) +
                             " us, where the log has stamps");
}

PortReply LogPlayer::step(int images) {
  const auto& stamps = log_.frameStamps();
  bool clamped = false;
  {
    const std::lock_guard lock(mutex_);
    updateLocked();
    timeline_.pause(clock_.now());
    // The frame that is shown now; before the first play none is.
    const auto shown = static_cast<std::int64_t>(frameAt(stamps, timeline_.position()));
    const std::int64_t wanted = shown + images;
    const std::int64_t reached =
        std::clamp<std::int64_t>(wanted, 0, static_cast<std::int64_t>(stamps.size()) - 1);
    const StampUs stamp_us = stamps[static_cast<std::size_t>(reached)];
    const StampUs shown_us = timeline_.seek(stamp_us, clock_.now());
    clamped = reached != wanted || shown_us != stamp_us;
    timeline_.pause(clock_.now());
  }
  wake_.notify_all();
  if (clamped) return PortReply::adjusted("the log's images end there");
  return PortReply::accepted();
}

ReplayContents LogPlayer::contents() const {
  ReplayContents contents;
  for (const BagTopic& topic : log_.contents())
    contents.topics.push_back({topic.name, topic.type, topic.messages});
  contents.notes = log_.notes();
  contents.images = log_.frameStamps().size();
  const std::lock_guard lock(mutex_);
  contents.begin_us = timeline_.begin();
  contents.end_us = timeline_.end();
  return contents;
}

PortReply LogPlayer::setLoop(bool loop) {
  {
    const std::lock_guard lock(mutex_);
    timeline_.setLoop(loop, clock_.now());
  }
  wake_.notify_all();
  return PortReply::accepted();
}

}  // namespace vismem
