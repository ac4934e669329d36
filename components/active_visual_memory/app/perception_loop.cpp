#include "active_visual_memory/app/perception_loop.h"

#include <algorithm>
#include <exception>
#include <limits>
#include <utility>

namespace vismem {
namespace {

using std::chrono::milliseconds;

/// How long a port may wait for something new; stop() is not later than this.
constexpr milliseconds kPortWait{200};
/// A port that answers "nothing" at once must not make a thread spin.
constexpr milliseconds kPause{20};
/// The loop looks around this often even when nothing comes.
constexpr milliseconds kIdle{50};
/// More waiting frames than this are dropped, oldest first: the memory is late, not the robot.
constexpr std::size_t kMaxFrames = 64;

void pauseFor(const std::stop_token& stop, milliseconds duration) {
  std::mutex mutex;
  std::condition_variable_any never;
  std::unique_lock lock(mutex);
  never.wait_for(lock, stop, duration, [] { return false; });
}

}  // namespace

PortReply SharedGazeClient::setMode(GazeMode mode) {
  if (!has_pan_tilt_ && mode != GazeMode::kOff) return PortReply::rejected("no pan-tilt unit is configured");
  const std::scoped_lock lock(mutex_);
  return mailbox_.setMode(mode);
}

PortReply SharedGazeClient::fixate(const Eigen::Vector3d& p_odom) {
  if (!has_pan_tilt_) return PortReply::rejected("no pan-tilt unit is configured");
  const std::scoped_lock lock(mutex_);
  return mailbox_.fixate(p_odom);
}

PortReply SharedGazeClient::request(const GazeRequest& request) {
  if (!has_pan_tilt_) return PortReply::rejected("no pan-tilt unit is configured");
  const std::scoped_lock lock(mutex_);
  return mailbox_.request(request);
}

PortReply SharedGazeClient::withdraw(const std::string& client, const std::string& key) {
  const std::scoped_lock lock(mutex_);
  return mailbox_.withdraw(client, key);
}

std::optional<GazeStatus> SharedGazeClient::status() {
  const std::scoped_lock lock(mutex_);
  return mailbox_.status();
}

std::vector<GazeMailbox::Message> SharedGazeClient::take() {
  const std::scoped_lock lock(mutex_);
  return mailbox_.take();
}

void SharedGazeClient::publish(const GazeStatus& status) {
  const std::scoped_lock lock(mutex_);
  mailbox_.publish(status);
}

PerceptionLoop::PerceptionLoop(const Params& params, std::shared_ptr<const Palette> palette,
                               FrameSource& camera, PanTiltUnit* pan_tilt, MobileBase& base,
                               SharedGazeClient& gaze, StatusBoard& status)
    : params_(params),
      camera_(camera),
      pan_tilt_(pan_tilt),
      base_(base),
      gaze_(gaze),
      status_(status),
      pipeline_(params.pipeline, std::move(palette)) {}

void PerceptionLoop::start(Consumer consumer, NoImages no_images) {
  consumer_ = std::move(consumer);
  no_images_ = std::move(no_images);
  threads_.emplace_back([this](const std::stop_token& stop) { readCamera(stop); });
  threads_.emplace_back([this](const std::stop_token& stop) { readSamples(stop, base_, odometry_samples_); });
  if (pan_tilt_) {
    threads_.emplace_back(
        [this](const std::stop_token& stop) { readSamples(stop, *pan_tilt_, pan_tilt_samples_); });
    threads_.emplace_back([this](const std::stop_token& stop) { giveCommands(stop); });
  }
  threads_.emplace_back([this](const std::stop_token& stop) { run(stop); });
}

void PerceptionLoop::stop() {
  for (std::jthread& thread : threads_) thread.request_stop();
  threads_.clear();
}

void PerceptionLoop::reset() {
  const std::scoped_lock lock(inbox_mutex_);
  reset_wanted_ = true;
}

void PerceptionLoop::readCamera(const std::stop_token& stop) {
  camera_.start();
  while (!stop.stop_requested()) {
    const auto asked = Clock::now();
    FrameResult result = camera_.next(kPortWait);
    {
      const std::scoped_lock lock(inbox_mutex_);
      camera_state_ = result.state;
      camera_message_ = result.message;
      if (result.frame) frames_.push_back(std::move(*result.frame));
      if (frames_.size() > kMaxFrames) {
        frames_.pop_front();
        status_.count("frames dropped");
      }
    }
    if (result.state == SourceState::kRunning) {
      status_.count("frames");
      inbox_filled_.notify_one();
    } else if (Clock::now() - asked < kPause) {
      pauseFor(stop, kPause);
    }
  }
  camera_.stop();
}

template <typename Port, typename Sample>
void PerceptionLoop::readSamples(const std::stop_token& stop, Port& port, std::vector<Sample>& inbox) {
  port.start();
  StampUs newest = std::numeric_limits<StampUs>::min();
  while (!stop.stop_requested()) {
    const auto asked = Clock::now();
    SampleBatch<Sample> batch = port.samplesSince(newest, kPortWait);
    if (batch.samples.empty()) {
      if (Clock::now() - asked < kPause) pauseFor(stop, kPause);
      continue;
    }
    newest = batch.samples.back().stamp_us;
    {
      const std::scoped_lock lock(inbox_mutex_);
      inbox.insert(inbox.end(), batch.samples.begin(), batch.samples.end());
    }
    inbox_filled_.notify_one();
  }
  port.stop();
}

void PerceptionLoop::run(const std::stop_token& stop) {
  ObservationAssembler assembler(params_.assembler);
  auto last_image = Clock::now();
  bool told = false;
  while (!stop.stop_requested()) {
    std::deque<Frame> frames;
    std::vector<PanTiltSample> pan_tilt;
    std::vector<OdometrySample> odometry;
    bool reset = false;
    SourceState state = SourceState::kRunning;
    std::string message;
    {
      std::unique_lock lock(inbox_mutex_);
      inbox_filled_.wait_for(lock, stop, kIdle, [this] {
        return !frames_.empty() || !pan_tilt_samples_.empty() || !odometry_samples_.empty();
      });
      frames.swap(frames_);
      pan_tilt.swap(pan_tilt_samples_);
      odometry.swap(odometry_samples_);
      reset = std::exchange(reset_wanted_, false);
      state = camera_state_;
      message = camera_message_;
    }
    if (reset) pipeline_.memory().reset();
    for (const auto& message_in : gaze_.take()) pipeline_.memory().gazeClient().post(message_in);
    for (const OdometrySample& sample : odometry) assembler.add(sample);
    for (const PanTiltSample& sample : pan_tilt) assembler.add(sample);
    const bool got_frames = !frames.empty();
    for (Frame& frame : frames) assembler.add(std::move(frame));
    processAll(assembler, pipeline_);

    const auto now = Clock::now();
    if (got_frames) {
      last_image = now;
      told = false;
      status_.healthy("images");
    } else if (!told && std::chrono::duration<double>(now - last_image).count() > params_.images_lost_s) {
      told = true;
      if (const auto hold = pipeline_.memory().imagesLost()) send(*hold);
      no_images_(state, message);
      if (state != SourceState::kFinished) status_.fault("images", message.empty() ? "none come" : message);
    }
  }
}

void PerceptionLoop::processAll(ObservationAssembler& assembler, MemoryPipeline& pipeline) {
  while (auto observation = assembler.take(params_.every_frame)) {
    const auto begin = Clock::now();
    AttentiveVisualMemory::StepResult result;
    try {
      result = pipeline.process(*observation);
    } catch (const std::exception& failure) {
      // An image that is not what its description says: nothing to remember, the next one may be good.
      status_.error(failure.what());
      continue;
    }
    const std::chrono::duration<double> spent = Clock::now() - begin;
    status_.count("iterations");
    status_.latency("iteration", spent.count());
    gaze_.publish(result.gaze);
    if (result.command && pan_tilt_) send(*result.command);
    consumer_(*observation, result);
  }
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
  while (true) {
    PanTiltCommand command;
    {
      std::unique_lock lock(command_mutex_);
      if (!command_given_.wait(lock, stop, [this] { return command_.has_value(); })) break;
      command = *std::exchange(command_, std::nullopt);
    }
    const PortReply reply = pan_tilt_->command(command);
    if (reply.ok()) {
      status_.healthy("pan-tilt commands");
    } else {
      status_.fault("pan-tilt commands", reply.message);
    }
  }
  // Nobody steers any more: whatever it was told, the head shall stand.
  pan_tilt_->command(PanTiltCommand{});
}

}  // namespace vismem
