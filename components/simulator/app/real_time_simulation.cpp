#include "simulator/app/real_time_simulation.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "simulator/core/truth_frames.h"

namespace vismem {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kMaxCommands = 64;
/// Timeout of a command: far above the rendering of one frame.
constexpr auto kCommandPatience = 2s;
/// Lag above which the clock is set back instead of catching up [us].
constexpr StampUs kMaxLag_us = 100'000;
constexpr StampUs kKept_us = 5 * kSecondUs;
/// Longest pause between two rounds of the loop.
constexpr auto kRound = 100ms;

template <typename Sample>
void append(std::deque<Sample>& ring, const Sample& sample) {
  ring.push_back(sample);
  while (ring.front().stamp_us + kKept_us < sample.stamp_us) ring.pop_front();
}

template <typename Sample>
StampUs newestOf(const std::deque<Sample>& ring) {
  return ring.empty() ? -1 : ring.back().stamp_us;
}

}  // namespace

class RealTimeSimulation::OutputPort : public FrameSource {
 public:
  OutputPort(RealTimeSimulation& owner, std::size_t index, std::size_t camera, OutputKind kind)
      : owner_(owner), index_(index), camera_(camera), kind_(kind) {}
  std::size_t camera() const { return camera_; }
  OutputKind kind() const { return kind_; }
  // The camera's parameters never change: these need no lock.
  FrameCapabilities capabilities() const override {
    FrameCapabilities capabilities = owner_.simulation_->camera(camera_).capabilities();
    if (kind_ == OutputKind::kDepth) capabilities.name = "simulated camera: true depth (take RGB8)";
    if (kind_ == OutputKind::kObjects) capabilities.name = "simulated camera: true objects (take RGB8)";
    return capabilities;
  }
  PortReply configure(const FrameRequest& request) override {
    return owner_.simulation_->camera(camera_).configure(request);
  }
  PortReply start() override {
    const std::lock_guard lock(owner_.mutex_);
    stopped_ = false;
    return PortReply::accepted();
  }
  FrameResult next(std::chrono::milliseconds timeout) override {
    std::unique_lock lock(owner_.mutex_);
    auto& frame = owner_.frames_[index_];
    const auto fresh = [&] { return frame.has_value() || !owner_.running_ || stopped_; };
    owner_.published_.wait_for(lock, timeout, fresh);
    if (stopped_) return {SourceState::kWaiting, std::nullopt, "the camera is stopped"};
    if (!frame) {
      return {SourceState::kWaiting, std::nullopt,
              owner_.status_.paused ? "the simulation is paused" : "no new frame yet"};
    }
    if (index_ == 0) ++owner_.given_out_;
    return {SourceState::kRunning, std::exchange(frame, std::nullopt), ""};
  }
  void stop() override {
    {
      const std::lock_guard lock(owner_.mutex_);
      stopped_ = true;
    }
    owner_.published_.notify_all();
  }

 private:
  RealTimeSimulation& owner_;
  bool stopped_ = false;  ///< under the owner's mutex
  std::size_t index_;
  std::size_t camera_;
  OutputKind kind_;
};

class RealTimeSimulation::PanTiltPort : public PanTiltUnit {
 public:
  explicit PanTiltPort(RealTimeSimulation& owner) : owner_(owner) {}
  PanTiltLimits limits() const override { return owner_.simulation_->panTilt().limits(); }
  PortReply start() override {
    owner_.setStopped(stopped_, false);
    return owner_.execute([](Simulation& s) { return s.panTilt().start(); });
  }
  PortReply command(const PanTiltCommand& command) override {
    return owner_.execute([command](Simulation& s) { return s.panTilt().command(command); });
  }
  SampleBatch<PanTiltSample> samplesSince(StampUs after_us, std::chrono::milliseconds timeout) override {
    return owner_.since(owner_.pan_tilt_samples_, after_us, timeout, &stopped_);
  }
  void stop() override {
    owner_.setStopped(stopped_, true);
    owner_.execute([](Simulation& s) {
      s.panTilt().stop();
      return PortReply::accepted();
    });
  }

 private:
  RealTimeSimulation& owner_;
  bool stopped_ = false;  ///< guarded by the owner's mutex
};

class RealTimeSimulation::BasePort : public MobileBase {
 public:
  explicit BasePort(RealTimeSimulation& owner) : owner_(owner) {}
  BaseLimits limits() const override { return owner_.simulation_->base().limits(); }
  PortReply start() override {
    owner_.setStopped(stopped_, false);
    return owner_.execute([](Simulation& s) { return s.base().start(); });
  }
  PortReply setVelocity(double v_mps, double w_radps) override {
    return owner_.execute([=](Simulation& s) { return s.base().setVelocity(v_mps, w_radps); });
  }
  SampleBatch<OdometrySample> samplesSince(StampUs after_us, std::chrono::milliseconds timeout) override {
    return owner_.since(owner_.odometry_samples_, after_us, timeout, &stopped_);
  }
  void stop() override {
    owner_.setStopped(stopped_, true);
    owner_.execute([](Simulation& s) {
      s.base().stop();
      return PortReply::accepted();
    });
  }

 private:
  RealTimeSimulation& owner_;
  bool stopped_ = false;  ///< guarded by the owner's mutex
};

RealTimeSimulation::RealTimeSimulation(SimulationConfig config, double speed, Hooks hooks)
    : hooks_(std::move(hooks)),
      simulation_(std::make_unique<Simulation>(std::move(config))),
      pan_tilt_(std::make_unique<PanTiltPort>(*this)),
      base_(std::make_unique<BasePort>(*this)) {
  status_.world = simulation_->config().world.name;
  status_.seed = simulation_->config().seed;
  status_.speed = speed;
  const auto& cameras = simulation_->config().cameras;
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    const auto add = [&](OutputKind kind) {
      outputs_.push_back(std::make_unique<OutputPort>(*this, outputs_.size(), i, kind));
    };
    add(OutputKind::kImage);
    if (cameras[i].depth) add(OutputKind::kDepth);
    if (cameras[i].objects) add(OutputKind::kObjects);
  }
  frames_.resize(outputs_.size());
}

RealTimeSimulation::~RealTimeSimulation() {
  stop();
}

FrameSource& RealTimeSimulation::output(std::size_t index) {
  return *outputs_.at(index);
}
std::string RealTimeSimulation::outputName(std::size_t index) const {
  const OutputPort& output = *outputs_.at(index);
  const std::string& camera = simulation_->config().cameras[output.camera()].name;
  switch (output.kind()) {
    case OutputKind::kDepth:
      return camera + "/depth";
    case OutputKind::kObjects:
      return camera + "/objects";
    case OutputKind::kImage:
      break;
  }
  return camera;
}
PanTiltUnit& RealTimeSimulation::panTilt() {
  return *pan_tilt_;
}
Eigen::Vector3d RealTimeSimulation::panTiltPosition() const {
  return simulation_->config().T_robot_pantilt.translation();
}
MobileBase& RealTimeSimulation::base() {
  return *base_;
}

PortReply RealTimeSimulation::prepareScenario(Scenario scenario) {
  return simulation_->play(std::move(scenario));
}

void RealTimeSimulation::start() {
  {
    const std::lock_guard lock(mutex_);
    if (running_) return;
    running_ = true;
  }
  thread_ = std::jthread([this](const std::stop_token& stop) { loop(stop); });
}

void RealTimeSimulation::stop() {
  if (!thread_.joinable()) return;
  thread_.request_stop();
  thread_.join();
}

void RealTimeSimulation::loop(const std::stop_token& stop) {
  std::exception_ptr failure;
  try {
    publishSamples();
    while (!stop.stop_requested()) {
      if (hooks_.on_round) hooks_.on_round();
      const auto next = advance();
      std::unique_lock lock(mutex_);
      wake_loop_.wait_until(lock, stop, next, [&] { return !commands_.empty() || consumers_changed_; });
    }
  } catch (...) {
    failure = std::current_exception();
  }
  std::deque<Command> unanswered;
  {
    const std::lock_guard lock(mutex_);
    running_ = false;
    unanswered.swap(commands_);
  }
  // Dropping a packaged task answers its waiter with broken_promise.
  unanswered.clear();
  published_.notify_all();
  if (failure && hooks_.on_failure) hooks_.on_failure(failure);
}

void RealTimeSimulation::consumersChanged() {
  {
    const std::lock_guard lock(mutex_);
    if (status_.lock_step == 0) return;
    consumers_changed_ = true;
  }
  wake_loop_.notify_all();
}

void RealTimeSimulation::runCommands() {
  std::deque<Command> commands;
  {
    const std::lock_guard lock(mutex_);
    commands.swap(commands_);
  }
  for (Command& command : commands) command(*simulation_);
}

void RealTimeSimulation::setOrigin(Clock::time_point now) {
  origin_wall_ = now;
  origin_us_ = simulation_->now();
}

RealTimeSimulation::Clock::time_point RealTimeSimulation::advance() {
  runCommands();
  const auto now = Clock::now();
  SimulationStatus wanted;
  {
    const std::lock_guard lock(mutex_);
    wanted = status_;
    consumers_changed_ = false;
  }
  if (std::exchange(clock_changed_, false)) setOrigin(now);
  measureSpeed(now);
  auto next = now + kRound;
  if (!wanted.paused) {
    next =
        wanted.lock_step > 0 ? advanceInLockStep(now, wanted.lock_step) : advanceByClock(now, wanted.speed);
  }
  publishSamples();
  publishFrames();
  return next;
}

RealTimeSimulation::Clock::time_point RealTimeSimulation::advanceByClock(Clock::time_point now,
                                                                         double speed) {
  const double elapsed_s = std::chrono::duration<double>(now - origin_wall_).count();
  const StampUs wanted_us = origin_us_ + toStampUs(elapsed_s * speed);
  while (simulation_->now() + Simulation::kStep_us <= wanted_us && !simulation_->frameDue()) {
    simulation_->step();
  }
  if (static_cast<double>(wanted_us - simulation_->now()) > static_cast<double>(kMaxLag_us) * speed) {
    setOrigin(now);
  }
  const double next_s = toSeconds(simulation_->now() + Simulation::kStep_us - origin_us_) / speed;
  return origin_wall_ + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(next_s));
}

RealTimeSimulation::Clock::time_point RealTimeSimulation::advanceInLockStep(Clock::time_point now,
                                                                            int consumers) {
  std::uint64_t given_out = 0;
  bool taken = false;
  {
    const std::lock_guard lock(mutex_);
    given_out = given_out_;
    taken = !frames_.front().has_value();
  }
  if (!taken || !hooks_.consumers_waiting || hooks_.consumers_waiting(given_out) < consumers) {
    return now + kRound;
  }
  if (!simulation_->frameDue()) simulation_->advanceToNextFrame();
  return now;
}

void RealTimeSimulation::publishFrames() {
  const auto& cameras = simulation_->config().cameras;
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    if (!simulation_->frameDue(i)) continue;
    const auto image = simulation_->takeFrame(i);
    std::optional<TruthImages> truth;
    if (cameras[i].depth || cameras[i].objects) truth = simulation_->truthImages(i);
    for (std::size_t k = 0; k < outputs_.size(); ++k) {
      const OutputPort& output = *outputs_[k];
      if (output.camera() != i) continue;
      Frame frame = *image;
      if (output.kind() == OutputKind::kDepth) frame = depthFrame(*truth, *image);
      if (output.kind() == OutputKind::kObjects) frame = objectFrame(*truth, *image);
      const std::lock_guard lock(mutex_);
      frames_[k] = std::move(frame);
    }
    published_.notify_all();
    if (hooks_.on_frame) hooks_.on_frame();
  }
}

void RealTimeSimulation::measureSpeed(Clock::time_point now) {
  const double elapsed_s = std::chrono::duration<double>(now - measured_wall_).count();
  if (measured_wall_ != Clock::time_point() && elapsed_s < 1.0) return;
  const double simulated_s = toSeconds(simulation_->now() - measured_us_);
  const bool first = measured_wall_ == Clock::time_point();
  measured_wall_ = now;
  measured_us_ = simulation_->now();
  if (first) return;
  const std::lock_guard lock(mutex_);
  status_.real_speed = simulated_s / elapsed_s;
}

void RealTimeSimulation::publishSamples() {
  bool any = false;
  {
    const std::lock_guard lock(mutex_);
    const auto joints = simulation_->panTilt().samplesSince(newestOf(pan_tilt_samples_), 0ms);
    for (const auto& sample : joints.samples) append(pan_tilt_samples_, sample);
    const auto odometry = simulation_->base().samplesSince(newestOf(odometry_samples_), 0ms);
    for (const auto& sample : odometry.samples) append(odometry_samples_, sample);
    // Ground truth of every step since the last round; a kidnapping appears in the next one.
    const auto truth = simulation_->truthSince(newestOf(truth_samples_));
    for (const auto& sample : truth) append(truth_samples_, sample);
    any = !joints.samples.empty() || !odometry.samples.empty() || !truth.empty();
    status_.stamp_us = simulation_->now();
  }
  if (any) published_.notify_all();
  for (const auto& problem : simulation_->takeScenarioProblems()) {
    if (hooks_.on_problem) hooks_.on_problem(problem);
  }
}

template <typename Sample>
SampleBatch<Sample> RealTimeSimulation::since(const std::deque<Sample>& ring, StampUs after_us,
                                              std::chrono::milliseconds timeout, const bool* stopped) {
  std::unique_lock lock(mutex_);
  const auto given_up = [&] { return !running_ || (stopped != nullptr && *stopped); };
  published_.wait_for(lock, timeout, [&] { return newestOf(ring) > after_us || given_up(); });
  SampleBatch<Sample> batch;
  const auto first = std::find_if(ring.begin(), ring.end(),
                                  [&](const Sample& sample) { return sample.stamp_us > after_us; });
  batch.samples.assign(first, ring.end());
  if (!batch.samples.empty()) {
    batch.state = SourceState::kRunning;
  } else {
    batch.message = status_.paused ? "the simulation is paused" : "no newer sample yet";
  }
  return batch;
}

void RealTimeSimulation::setStopped(bool& stopped, bool value) {
  {
    const std::lock_guard lock(mutex_);
    stopped = value;
  }
  published_.notify_all();
}

PortReply RealTimeSimulation::execute(std::function<PortReply(Simulation&)> work) {
  Command command(std::move(work));
  auto answer = command.get_future();
  {
    const std::lock_guard lock(mutex_);
    if (!running_) return PortReply::rejected("the simulation does not run");
    if (commands_.size() >= kMaxCommands) {
      return PortReply::rejected("more than " + std::to_string(kMaxCommands) + " commands are waiting");
    }
    commands_.push_back(std::move(command));
  }
  wake_loop_.notify_all();
  if (answer.wait_for(kCommandPatience) != std::future_status::ready) {
    return PortReply::rejected("the simulation did not answer in time");
  }
  try {
    return answer.get();
  } catch (const std::future_error&) {
    return PortReply::rejected("the simulation has ended");
  }
}

SimulationStatus RealTimeSimulation::status() const {
  const std::lock_guard lock(mutex_);
  return status_;
}

SampleBatch<TruthSample> RealTimeSimulation::truthSince(StampUs after_us, std::chrono::milliseconds timeout) {
  return since(truth_samples_, after_us, timeout);
}

}  // namespace vismem
