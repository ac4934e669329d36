#include "drivers/pantilt_simulated/simulated_pan_tilt_unit.h"

#include "common/drivers/host_clock.h"
#include "common/kinematics/fine_steps.h"
#include "common/kinematics/kinematics_config.h"
#include "common/robot/command_limits.h"

namespace vismem {
namespace {

constexpr char kStopped[] = "the simulated pan-tilt unit is stopped";
constexpr char kNotStarted[] = "the simulated pan-tilt unit is not started";

}  // namespace

SimulatedPanTiltUnit::SimulatedPanTiltUnit(const Params& params)
    : params_(params), joints_(params.motion), samples_(kNotStarted) {}

SimulatedPanTiltUnit::~SimulatedPanTiltUnit() {
  stop();
}

PortReply SimulatedPanTiltUnit::start() {
  {
    const std::lock_guard lock(mutex_);
    if (running_) return PortReply::accepted();
    running_ = true;
    moved_until_ = Clock::now();
  }
  samples_.open("no sample yet");
  const auto period = std::chrono::duration<double>(1.0 / params_.rate_hz);
  thread_.start(std::chrono::duration_cast<Clock::duration>(period), [this] { round(); });
  return PortReply::accepted();
}

void SimulatedPanTiltUnit::stop() {
  {
    const std::lock_guard lock(mutex_);
    if (!running_) return;
    running_ = false;
    moveLocked();
    joints_.halt();
  }
  thread_.stop();
  samples_.close(kStopped);
}

PortReply SimulatedPanTiltUnit::command(const PanTiltCommand& command) {
  const LimitedPanTiltCommand limited = limitCommand(params_.motion.limits, command);
  if (!limited.reply.ok()) return limited.reply;
  const std::lock_guard lock(mutex_);
  if (!running_) return PortReply::rejected(kStopped);
  moveLocked();
  joints_.command(limited.command);
  return limited.reply;
}

SampleBatch<PanTiltSample> SimulatedPanTiltUnit::samplesSince(StampUs after_us,
                                                              std::chrono::milliseconds timeout) {
  return samples_.since(after_us, timeout);
}

void SimulatedPanTiltUnit::moveLocked() {
  const auto now = Clock::now();
  inFineSteps(now - moved_until_, [this](double, double dt_s) { joints_.step(dt_s); });
  moved_until_ = now;
}

void SimulatedPanTiltUnit::round() {
  const std::lock_guard lock(mutex_);
  if (!running_) return;
  moveLocked();
  const PanTilt angles = joints_.angles();
  samples_.add({hostClock_us(), samples_given_++, angles.pan_rad, angles.tilt_rad});
}

std::unique_ptr<PanTiltUnit> makeSimulatedPanTiltUnit(ConfigReader& group) {
  SimulatedPanTiltUnit::Params params;
  group.describe({expert("Rate_hz", "samples a second")});
  params.rate_hz = group.real("Rate_hz", params.rate_hz, 1.0, 1000.0);
  readPanTiltParams(group, params.motion);
  return std::make_unique<SimulatedPanTiltUnit>(params);
}

}  // namespace vismem
