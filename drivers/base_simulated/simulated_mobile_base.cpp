#include "drivers/base_simulated/simulated_mobile_base.h"

#include <limits>
#include <thread>

#include "common/drivers/host_clock.h"
#include "common/kinematics/fine_steps.h"
#include "common/kinematics/kinematics_config.h"
#include "common/robot/command_limits.h"

namespace vismem {
namespace {

constexpr char kStopped[] = "the simulated base is stopped";
constexpr char kNotStarted[] = "the simulated base is not started";
/// Period at which stop() checks whether the base stands.
constexpr std::chrono::milliseconds kLook{5};

}  // namespace

SimulatedMobileBase::SimulatedMobileBase(const Params& params)
    : params_(params),
      base_(params.motion, Pose2{}, {}),
      odometry_(params.odometry, params.motion.wheel_base_m, params.seed),
      samples_(kNotStarted) {}

SimulatedMobileBase::~SimulatedMobileBase() {
  stop();
}

PortReply SimulatedMobileBase::start() {
  {
    const std::lock_guard lock(mutex_);
    if (running_) return PortReply::accepted();
    running_ = true;
    braking_ = false;
    moved_until_ = Clock::now();
  }
  samples_.open("no sample yet");
  const auto period = std::chrono::duration<double>(1.0 / params_.rate_hz);
  thread_.start(std::chrono::duration_cast<Clock::duration>(period), [this] { round(); });
  return PortReply::accepted();
}

void SimulatedMobileBase::stop() {
  {
    std::unique_lock lock(mutex_);
    if (!running_) return;
    moveLocked();
    braking_ = true;
    base_.halt();
    while (base_.speed() != 0.0 || base_.turnRate() != 0.0) {
      lock.unlock();
      std::this_thread::sleep_for(kLook);
      lock.lock();
      moveLocked();
    }
    giveSampleLocked();
    running_ = false;
  }
  thread_.stop();
  samples_.close(kStopped);
}

PortReply SimulatedMobileBase::setVelocity(double v_mps, double w_radps) {
  const LimitedVelocity limited = limitVelocity(params_.motion.limits, v_mps, w_radps);
  if (!limited.reply.ok()) return limited.reply;
  const std::lock_guard lock(mutex_);
  if (!running_ || braking_) return PortReply::rejected(kStopped);
  moveLocked();
  base_.command(limited.v_mps, limited.w_radps, nowLocked_us());
  return limited.reply;
}

SampleBatch<OdometrySample> SimulatedMobileBase::samplesSince(StampUs after_us,
                                                              std::chrono::milliseconds timeout) {
  return samples_.since(after_us, timeout);
}

StampUs SimulatedMobileBase::nowLocked_us() const {
  return std::chrono::duration_cast<std::chrono::microseconds>(moved_until_ - made_).count();
}

void SimulatedMobileBase::moveLocked() {
  const auto now = Clock::now();
  const StampUs from_us = nowLocked_us();
  inFineSteps(now - moved_until_, [&](double from_s, double dt_s) {
    odometry_.add(base_.step(from_us + toStampUs(from_s + dt_s), dt_s));
  });
  moved_until_ = now;
}

void SimulatedMobileBase::giveSampleLocked() {
  samples_.add({hostClock_us(), samples_given_++, odometry_.pose(), base_.speed(), base_.turnRate()});
}

void SimulatedMobileBase::round() {
  const std::lock_guard lock(mutex_);
  if (!running_) return;
  moveLocked();
  giveSampleLocked();
}

std::unique_ptr<MobileBase> makeSimulatedMobileBase(ConfigReader& group) {
  SimulatedMobileBase::Params params;
  group.describe({expert("Rate_hz", "samples a second"), expert("Seed", "of the odometry's random errors")});
  params.rate_hz = group.real("Rate_hz", params.rate_hz, 1.0, 1000.0);
  params.seed = static_cast<std::uint64_t>(group.integer("Seed", 1, 0, std::numeric_limits<long>::max()));
  readBaseParams(group, params.motion);
  readOdometryErrorParams(group.group("Odometry"), params.odometry);
  return std::make_unique<SimulatedMobileBase>(params);
}

}  // namespace vismem
