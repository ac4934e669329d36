#include "common/drivers/device_pan_tilt.h"

#include <algorithm>
#include <utility>

#include "common/drivers/host_clock.h"
#include "common/robot/command_limits.h"

namespace vismem {
namespace {

constexpr char kStopped[] = "the pan-tilt unit is stopped";

}  // namespace

DevicePanTilt::DevicePanTilt(double rate_hz)
    : period_(std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1.0 / rate_hz))),
      samples_("the pan-tilt unit is not started"),
      thread_(kStopped, {[this](const std::stop_token& stop) { return session(stop); }, [this] { wake(); },
                         [this](const std::string& why) { samples_.setWaiting(why); }}) {}

PortReply DevicePanTilt::start() {
  samples_.open("no sample yet");
  return thread_.start();
}

void DevicePanTilt::stop() {
  if (thread_.stop()) samples_.close(kStopped);
}

PortReply DevicePanTilt::command(const PanTiltCommand& command) {
  LimitedPanTiltCommand limited = limitCommand(limits(), command);
  if (!limited.reply.ok()) return limited.reply;
  if (const std::string why = thread_.unavailable(); !why.empty()) return PortReply::rejected(why);
  if (command.kind == PanTiltCommand::Kind::kVelocity) adjustVelocity(limited.command, limited.reply);
  {
    const std::lock_guard lock(mutex_);
    command_ = limited.command;
  }
  commanded_.notify_all();
  wake();
  return limited.reply;
}

SampleBatch<PanTiltSample> DevicePanTilt::samplesSince(StampUs after_us, std::chrono::milliseconds timeout) {
  return samples_.since(after_us, timeout);
}

std::string DevicePanTilt::pauseUntil(Clock::time_point until, const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  commanded_.wait_until(lock, stop, until, [this] { return command_.has_value(); });
  return {};
}

void DevicePanTilt::give(StampUs asked_us, double pan_rad, double tilt_rad) {
  const PanTiltSample sample{asked_us + (hostClock_us() - asked_us) / 2, samples_given_++, pan_rad, tilt_rad};
  if (is_ready_) {
    samples_.add(sample);
  } else {
    first_ = sample;
  }
}

std::string DevicePanTilt::session(const std::stop_token& stop) {
  {
    const std::lock_guard lock(mutex_);
    command_.reset();
  }
  is_ready_ = false;
  first_.reset();
  std::string why = connect(stop);
  if (why.empty()) why = poll();
  if (why.empty()) {
    thread_.ready();
    is_ready_ = true;
    if (first_) samples_.add(*first_);
  }
  auto next = Clock::now() + period_;
  while (why.empty() && !stop.stop_requested()) {
    // Command and poll in one round: continuous commands must not delay the angles, nor a slow device the
    // commands.
    if (Clock::now() >= next) {
      next = std::max(next + period_, Clock::now());
      why = poll();
      if (!why.empty()) break;
    }
    std::optional<PanTiltCommand> command;
    {
      const std::lock_guard lock(mutex_);
      command = std::exchange(command_, std::nullopt);
    }
    why = command ? obey(*command) : pauseUntil(next, stop);
  }
  disconnect(stop.stop_requested());
  return why;
}

}  // namespace vismem
