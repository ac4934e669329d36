#include "application/app/run_observer.h"

#include <algorithm>
#include <cmath>

#include "common/geometry/angles.h"

namespace vismem {
namespace {

/// Longest wait of a thread, so that stop() returns soon.
constexpr std::chrono::milliseconds kPatience{200};
/// Unmatched images and analyses that are kept: over a second at 30 Hz.
constexpr std::size_t kPairing = 45;
/// Period of the simulated operator's drive commands [us of the robot's time].
constexpr StampUs kDrive_us = 50'000;

/// A disconnected source answers at once: sleeps, so that its thread does not spin.
template <typename Batch>
void pauseIfEmpty(const Batch& batch, const std::stop_token& stop) {
  if (batch.samples.empty() && !stop.stop_requested())
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
}

}  // namespace

TwinError errorToNearestTwin(const PoseEstimate& estimate, const Pose2& truth,
                             const std::vector<Pose2>& symmetries) {
  const auto errorOf = [&](const Pose2& pose) {
    return PoseError{estimate.stamp_us, (pose.position() - truth.position()).norm(),
                     std::abs(angleDifference(pose.theta, truth.theta)), estimate.reliability};
  };
  const auto size = [](const PoseError& error) { return *error.position_m + *error.heading_rad; };
  TwinError nearest{errorOf(*estimate.T_world_robot), false};
  for (const Pose2& motion : symmetries) {
    const PoseError error = errorOf(motion * *estimate.T_world_robot);
    if (size(error) < size(nearest.error)) nearest = {error, true};
  }
  return nearest;
}

RunObserver::RunObserver(const RunPorts& ports, RunFiles& files, std::optional<SimulatedOperator> driver,
                         std::optional<ImageRange> judged, std::vector<Pose2> symmetries)
    : ports_(ports),
      driver_(std::move(driver)),
      judged_(judged),
      symmetries_(std::move(symmetries)),
      files_(files) {
  live_.last_advance = std::chrono::steady_clock::now();
}

void RunObserver::start() {
  const auto run = [this](void (RunObserver::*follow)(const std::stop_token&)) {
    threads_.emplace_back([this, follow](const std::stop_token& stop) { (this->*follow)(stop); });
  };
  run(&RunObserver::followOdometry);
  run(&RunObserver::followCamera);
  run(&RunObserver::followMemory);
  run(&RunObserver::followLocalization);
  if (ports_.simulation != nullptr) run(&RunObserver::followTruth);
}

void RunObserver::stop() {
  if (threads_.empty()) return;
  for (std::jthread& thread : threads_) thread.request_stop();
  threads_.clear();
  if (driver_) ports_.base->setVelocity(0.0, 0.0);
}

LiveState RunObserver::live() const {
  const std::lock_guard lock(mutex_);
  LiveState state = live_;
  state.camera_hz = record_.camera.recentHz(live_.now_us);
  state.memory_hz = record_.iterations.recentHz(live_.now_us);
  if (record_.memory) state.memory_segments = record_.memory->segments.size();
  if (!record_.estimates.empty()) {
    state.last_estimate_us = record_.estimates.back().stamp_us;
    const auto truth = poseAt(record_.truth, state.last_estimate_us);
    // After a seek or a reset back in time the record stands until it is reached again.
    const bool is_recorded = state.estimate->stamp_us == state.last_estimate_us;
    if (truth && is_recorded && state.estimate->T_world_robot) {
      const TwinError nearest = errorToNearestTwin(*state.estimate, *truth, symmetries_);
      state.error = nearest.error;
      state.is_twin = nearest.is_twin;
    }
  }
  return state;
}

RunRecord RunObserver::takeRecord() {
  const std::lock_guard lock(mutex_);
  return std::move(record_);
}

void RunObserver::noteTimeLocked(StampUs stamp_us) {
  if (!live_.first_us) live_.first_us = stamp_us;
  if (stamp_us != live_.now_us || live_.now_us == 0) live_.last_advance = std::chrono::steady_clock::now();
  live_.now_us = stamp_us;
}

void RunObserver::followTruth(const std::stop_token& stop) {
  StampUs last_us = -1;
  StampUs driven_us = -kSecondUs;
  std::uint32_t kidnaps = 0;
  bool first = true;
  while (!stop.stop_requested()) {
    const auto batch = ports_.simulation->truthSince(last_us, kPatience);
    for (const TruthSample& sample : batch.samples) {
      const std::lock_guard lock(mutex_);
      if (ports_.truth_in_map) recorder_.addTruth({sample.stamp_us, sample.T_world_robot});
      files_.addTruth({sample.stamp_us, sample.T_world_robot});
      noteTimeLocked(sample.stamp_us);
      if (!first && sample.kidnaps != kidnaps) {
        record_.kidnapped_us.push_back(sample.stamp_us);
        if (driver_) driver_->lost();
      }
      kidnaps = sample.kidnaps;
      first = false;
    }
    pauseIfEmpty(batch, stop);
    if (batch.samples.empty()) continue;
    const TruthSample& newest = batch.samples.back();
    last_us = newest.stamp_us;
    // A reset sets the time back.
    if (!driver_ || std::abs(newest.stamp_us - driven_us) < kDrive_us) continue;
    driven_us = newest.stamp_us;
    const DriveCommand command = driver_->drive(newest.T_world_robot);
    const PortReply reply = ports_.base->setVelocity(command.v_mps, command.w_radps);
    const std::lock_guard lock(mutex_);
    live_.drive_failure = reply.ok() ? std::string() : reply.message;
  }
}

void RunObserver::followOdometry(const std::stop_token& stop) {
  StampUs last_us = -1;
  while (!stop.stop_requested()) {
    const auto batch = ports_.base->samplesSince(last_us, kPatience);
    pauseIfEmpty(batch, stop);
    if (batch.samples.empty()) continue;
    last_us = batch.samples.back().stamp_us;
    const std::lock_guard lock(mutex_);
    for (const OdometrySample& sample : batch.samples) {
      recorder_.addOdometry({sample.stamp_us, sample.T_odom_robot});
      files_.addOdometry({sample.stamp_us, sample.T_odom_robot});
    }
  }
}

void RunObserver::followCamera(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    const FrameResult result = ports_.camera->next(kPatience);
    if (!result.frame) {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
      continue;
    }
    const std::lock_guard lock(mutex_);
    record_.camera.add(result.frame->seq, result.frame->stamp_us);
    live_.last_image_us = std::max(live_.last_image_us, result.frame->stamp_us);
    if (ports_.simulation == nullptr) noteTimeLocked(result.frame->stamp_us);
    images_.push_back(*result.frame);
    if (images_.size() > kPairing) images_.pop_front();
    pairImageLocked();
  }
}

void RunObserver::followMemory(const std::stop_token& stop) {
  std::uint64_t revision = 0;
  while (!stop.stop_requested()) {
    const MemoryResult result = ports_.memory->next(revision, kPatience);
    if (!result.update.snapshot || !result.update.analysis) {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
      continue;
    }
    const MemorySnapshot& snapshot = *result.update.snapshot;
    revision = snapshot.revision;
    const std::lock_guard lock(mutex_);
    record_.memory = result.update.snapshot;
    record_.iterations.add(snapshot.revision, snapshot.stamp_us);
    const std::uint64_t frame_seq = result.update.analysis->frame_seq;
    if (judged_ && judged_->contains(frame_seq)) recorder_.addJudged(result.update.analysis);
    if (judged_ && judged_->isPast(frame_seq)) continue;
    record_.shown_memory = result.update.snapshot;
    waiting_analyses_.push_back(result.update.analysis);
    if (waiting_analyses_.size() > kPairing) waiting_analyses_.pop_front();
    pairImageLocked();
  }
}

void RunObserver::pairImageLocked() {
  for (auto analysis = waiting_analyses_.rbegin(); analysis != waiting_analyses_.rend(); ++analysis) {
    const auto image = std::find_if(images_.rbegin(), images_.rend(),
                                    [&](const Frame& f) { return f.stamp_us == (*analysis)->stamp_us; });
    if (image == images_.rend()) continue;
    record_.last_analysis = *analysis;
    record_.last_image = *image;
    // Analyses older than a matched one are never shown.
    waiting_analyses_.erase(waiting_analyses_.begin(), analysis.base());
    return;
  }
}

void RunObserver::followLocalization(const std::stop_token& stop) {
  std::uint64_t revision = 0;
  while (!stop.stop_requested()) {
    const std::optional<PoseEstimate> estimate = ports_.localization->next(revision, kPatience);
    if (!estimate) {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
      continue;
    }
    revision = estimate->revision;
    const std::lock_guard lock(mutex_);
    live_.estimate = *estimate;
    if (!record_.estimates.empty() && estimate->stamp_us <= record_.estimates.back().stamp_us) continue;
    recorder_.addEstimate(*estimate);
    recorder_.addPublished({estimate->stamp_us, estimate->T_world_robot, estimate->reliability});
    files_.addEstimate(*estimate);
    if (estimate->T_world_robot) files_.addPose({estimate->stamp_us, *estimate->T_world_robot});
  }
}

}  // namespace vismem
