#include "active_visual_memory/app/perception_loop.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <utility>

#include "common/geometry/angles.h"

namespace vismem {
namespace {

using std::chrono::milliseconds;

/// How long a port may wait for something new; stop() is not later than this.
constexpr milliseconds kPortWait{200};
/// A port that answers "nothing" at once must not make a thread spin.
constexpr milliseconds kPause{20};
/// Pause before a failed command is repeated.
constexpr milliseconds kCommandRetry{300};
/// The loop wakes up this often without input.
constexpr milliseconds kIdle{50};
/// More waiting frames than this are dropped, oldest first: the memory is late, not the robot.
constexpr std::size_t kMaxFrames = 64;
constexpr std::size_t kMaxChanges = 64;

void pauseFor(const std::stop_token& stop, milliseconds duration) {
  std::mutex mutex;
  std::condition_variable_any never;
  std::unique_lock lock(mutex);
  never.wait_for(lock, stop, duration, [] { return false; });
}

}  // namespace

PerceptionLoop::PerceptionLoop(const Params& params, std::shared_ptr<const Palette> palette,
                               FrameSource& camera, PanTiltUnit* pan_tilt, MobileBase& base,
                               SharedGazeClient& gaze, StatusBoard& status)
    : params_(params),
      camera_(camera),
      pan_tilt_(pan_tilt),
      base_(base),
      gaze_(gaze),
      status_(status),
      pipeline_(params.pipeline, std::move(palette)),
      knock_alarm_(params.calibrated_tilt_rad) {}

void PerceptionLoop::startThread(std::function<void(const std::stop_token&)> work) {
  threads_.emplace_back([this, work = std::move(work)](const std::stop_token& stop) {
    try {
      work(stop);
    } catch (...) {
      failed_(std::current_exception());
    }
  });
}

void PerceptionLoop::start(Consumer consumer, NoImages no_images, Failed failed) {
  consumer_ = std::move(consumer);
  no_images_ = std::move(no_images);
  failed_ = std::move(failed);
  startThread([this](const auto& stop) {
    read(stop, "reader of the camera", camera_, [this] { return takeFrame(); });
  });
  startThread([this](const auto& stop) {
    readSamples(stop, "reader of the odometry", base_, inbox_.odometry_samples);
  });
  if (pan_tilt_) {
    startThread([this](const auto& stop) {
      readSamples(stop, "reader of the pan-tilt unit", *pan_tilt_, inbox_.pan_tilt_samples);
    });
    startThread([this](const auto& stop) { giveCommands(stop); });
  }
  startThread([this](const auto& stop) { run(stop); });
}

void PerceptionLoop::stop() {
  for (std::jthread& thread : threads_) thread.request_stop();
  threads_.clear();
}

void PerceptionLoop::reset() {
  const std::scoped_lock lock(inbox_mutex_);
  inbox_.reset_wanted = true;
}

PortReply PerceptionLoop::change(std::function<void(MemoryPipeline&)> change) {
  const std::scoped_lock lock(inbox_mutex_);
  if (inbox_.changes.size() >= kMaxChanges)
    return PortReply::rejected(std::to_string(kMaxChanges) + " changes are waiting already");
  inbox_.changes.push_back(std::move(change));
  return PortReply::accepted();
}

template <typename Port, typename Take>
void PerceptionLoop::read(const std::stop_token& stop, const char* name, Port& port, Take take) {
  status_.alive(name);
  port.start();
  while (!stop.stop_requested()) {
    status_.alive(name);
    const auto asked = Clock::now();
    if (take()) {
      inbox_filled_.notify_one();
    } else if (Clock::now() - asked < kPause) {
      pauseFor(stop, kPause);
    }
  }
  port.stop();
  status_.ended(name);
}

bool PerceptionLoop::takeFrame() {
  FrameResult result = camera_.next(kPortWait);
  const bool running = result.state == SourceState::kRunning;
  if (running) status_.count("frames");
  const std::scoped_lock lock(inbox_mutex_);
  inbox_.camera_state = result.state;
  inbox_.camera_message = result.message;
  if (result.frame) inbox_.frames.push_back(std::move(*result.frame));
  if (inbox_.frames.size() > kMaxFrames) {
    inbox_.frames.pop_front();
    status_.count("frames dropped");
  }
  return running;
}

template <typename Port, typename Sample>
void PerceptionLoop::readSamples(const std::stop_token& stop, const char* name, Port& port,
                                 std::vector<Sample>& inbox) {
  read(stop, name, port, [this, &port, &inbox, newest = std::numeric_limits<StampUs>::min()]() mutable {
    const SampleBatch<Sample> batch = port.samplesSince(newest, kPortWait);
    if (batch.samples.empty()) return false;
    newest = batch.samples.back().stamp_us;
    const std::scoped_lock lock(inbox_mutex_);
    inbox.insert(inbox.end(), batch.samples.begin(), batch.samples.end());
    return true;
  });
}

PerceptionLoop::Inbox PerceptionLoop::takeInbox(const std::stop_token& stop) {
  std::unique_lock lock(inbox_mutex_);
  inbox_filled_.wait_for(lock, stop, kIdle, [this] {
    return !inbox_.frames.empty() || !inbox_.pan_tilt_samples.empty() || !inbox_.odometry_samples.empty();
  });
  Inbox taken;
  taken.frames.swap(inbox_.frames);
  taken.pan_tilt_samples.swap(inbox_.pan_tilt_samples);
  taken.odometry_samples.swap(inbox_.odometry_samples);
  taken.reset_wanted = std::exchange(inbox_.reset_wanted, false);
  taken.changes.swap(inbox_.changes);
  taken.camera_state = inbox_.camera_state;
  taken.camera_message = inbox_.camera_message;
  return taken;
}

void PerceptionLoop::run(const std::stop_token& stop) {
  const std::string name = "perception";
  ObservationAssembler assembler(params_.assembler);
  Clocks clocks;
  auto last_image = Clock::now();
  auto last_observation = last_image;
  const auto longAgo = [this](Clock::time_point then) {
    return std::chrono::duration<double>(Clock::now() - then).count() > params_.images_lost_s;
  };
  while (!stop.stop_requested()) {
    status_.alive(name);
    Inbox inbox = takeInbox(stop);
    if (inbox.reset_wanted) pipeline_.memory().reset();
    for (const auto& change_pipeline : inbox.changes) change_pipeline(pipeline_);
    auto requests = gaze_.take();
    for (auto& request : requests) pipeline_.memory().gazeClient().push(std::move(request));
    checkClocks(inbox, clocks);
    for (const OdometrySample& sample : inbox.odometry_samples) assembler.add(sample);
    for (const PanTiltSample& sample : inbox.pan_tilt_samples) assembler.add(sample);
    if (!inbox.frames.empty()) last_image = Clock::now();
    for (Frame& frame : inbox.frames) assembler.add(std::move(frame));
    if (processAll(assembler, pipeline_)) {
      last_observation = Clock::now();
      continue;
    }
    if (!requests.empty()) {
      if (const auto command = pipeline_.memory().preempt()) send(*command);
    }
    if (longAgo(last_observation)) reportNoImages(inbox, !longAgo(last_image), assembler);
  }
  status_.ended(name);
}

void PerceptionLoop::reportNoImages(const Inbox& inbox, bool frames_come,
                                    const ObservationAssembler& assembler) {
  std::pair<SourceState, std::string> now{inbox.camera_state, inbox.camera_message};
  if (frames_come) {
    now = {SourceState::kWaiting, unusable_.empty() ? assembler.whyNothing() : unusable_};
  } else if (now.second.empty()) {
    now.second = "none come";
  }
  if (blind_ == now) return;
  const bool first = !blind_;
  blind_ = now;
  if (first) {
    if (const auto hold = pipeline_.memory().imagesLost()) send(*hold);
  }
  no_images_(now.first, now.second);
  if (now.first == SourceState::kFinished) {
    status_.healthy("images");
  } else {
    status_.fault("images", now.second);
  }
}

void PerceptionLoop::checkClocks(const Inbox& inbox, Clocks& clocks) {
  const StampUs host_now_us = std::chrono::duration_cast<std::chrono::microseconds>(
                                  std::chrono::system_clock::now().time_since_epoch())
                                  .count();
  const auto check = [&](const std::string& what, ClockWatch& clock, StampUs stamp_us) {
    const std::string problem = clock.check(stamp_us, host_now_us);
    if (problem.empty()) {
      status_.healthy(what);
    } else {
      status_.fault(what, problem);
    }
  };
  if (!inbox.frames.empty()) check("clock of the camera", clocks.camera, inbox.frames.back().stamp_us);
  if (!inbox.odometry_samples.empty()) {
    check("clock of the odometry", clocks.odometry, inbox.odometry_samples.back().stamp_us);
  }
}

void PerceptionLoop::reportCameraTilt(const AttentiveVisualMemory& memory) {
  if (!params_.pipeline.memory.memory.estimation.enabled ||
      !params_.pipeline.memory.memory.estimation.tilt_prior.enabled())
    return;
  constexpr const char* kNames[] = {"mount roll error", "mount pitch error", "camera pitch error",
                                    "camera roll error"};
  const CameraTilt camera_tilt = memory.cameraTilt();
  const CameraTiltCovariance P = memory.cameraTiltCovariance();
  for (int i = 0; i < 4; ++i) {
    status_.gauge({kNames[i], radToDeg(camera_tilt[i]), radToDeg(std::sqrt(P(i, i))), "deg"});
  }
  const CameraKnock knock = knockOf(camera_tilt, P);
  status_.gauge({"camera knock", radToDeg(knock.angle_rad), radToDeg(knock.sigma_rad), "deg"});
  if (const std::string message = knock_alarm_.update(knock); !message.empty()) status_.note(message);
}

void PerceptionLoop::reportLight(const LightEstimator& light) {
  status_.gauge({"edges without a name", 100.0 * (1.0 - light.namedShare()), 0.0, "%"});
  status_.gauge({"brightness relative to the palette", 100.0 / light.light().gain[1], 0.0, "%"});
  std::string now = describe(light.light());
  if (now == light_) return;
  light_ = std::move(now);
  status_.note(light_.empty() ? "images have the light that the palette expects"
                              : light_ + ": corrected before edges get their names");
}

bool PerceptionLoop::processAll(ObservationAssembler& assembler, MemoryPipeline& pipeline) {
  bool any = false;
  while (auto observation = assembler.take(params_.every_frame)) {
    if (observation->epoch != epoch_) {
      epoch_ = observation->epoch;
      status_.count("epochs");
      status_.note("a new epoch, the memory is set aside: " + assembler.epochReason());
    }
    const auto begin = Clock::now();
    const AttentiveVisualMemory::StepResult* step = nullptr;
    try {
      step = &pipeline.process(*observation);
    } catch (const std::exception& failure) {
      // An image that contradicts its description is skipped; the next one may be good.
      status_.error(failure.what());
      unusable_ = failure.what();
      continue;
    }
    const AttentiveVisualMemory::StepResult& result = *step;
    any = true;
    unusable_.clear();
    // At once: after a pause many frames may wait.
    blind_.reset();
    status_.healthy("images");
    const std::chrono::duration<double> spent = Clock::now() - begin;
    status_.count("iterations");
    if (result.kidnapped) {
      status_.error("moved by hand: the memory was set aside at " +
                    std::to_string(toSeconds(observation->frame.stamp_us)) + " s");
    }
    status_.latency("iteration", spent.count());
    reportCameraTilt(pipeline.memory());
    if (pipeline.light()) reportLight(*pipeline.light());
    gaze_.publish(result.gaze, observation->T_odom_robot.position());
    if (result.command && pan_tilt_) send(*result.command);
    consumer_(*observation, result);
  }
  return any;
}

void PerceptionLoop::send(const PanTiltCommand& command) {
  if (!pan_tilt_) return;
  {
    const std::scoped_lock lock(command_mutex_);
    command_ = command;
  }
  command_given_.notify_one();
}

void PerceptionLoop::giveCommands(const std::stop_token& stop) {
  // A command that failed is repeated until it succeeds or a newer one comes: else a head that was away for
  // a moment would keep a wrong angle.
  std::optional<PanTiltCommand> failed;
  const auto given = [this] { return command_.has_value(); };
  while (true) {
    PanTiltCommand command;
    {
      std::unique_lock lock(command_mutex_);
      if (failed) {
        command_given_.wait_for(lock, stop, kCommandRetry, given);
      } else {
        command_given_.wait(lock, stop, given);
      }
      if (stop.stop_requested()) break;
      command = command_ ? *std::exchange(command_, std::nullopt) : *failed;
    }
    // Supervised only while a command runs: between commands the thread waits.
    status_.alive("gaze commands");
    const PortReply reply = pan_tilt_->command(command);
    status_.ended("gaze commands");
    failed.reset();
    if (reply.ok()) {
      status_.healthy("pan-tilt commands");
    } else {
      failed = command;
      status_.fault("pan-tilt commands", reply.message);
    }
  }
  // The loop has ended: stop the head.
  pan_tilt_->command(PanTiltCommand{});
}

}  // namespace vismem
