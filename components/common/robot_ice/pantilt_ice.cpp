#include "common/robot_ice/pantilt_ice.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/geometry/angles.h"
#include "common/robot/command_limits.h"
#include "common/robot_ice/conversions.h"

namespace vismem {
namespace {

/// A position command counts as reached this close to it on both axes.
const double kReached_rad = degToRad(0.5);

float toFloatDeg(double angle_rad) {
  return static_cast<float>(radToDeg(angle_rad));
}

/// JdeRobot's counter of samples: positive and 31 bits wide.
int toClock(std::uint64_t seq) {
  return static_cast<int>(seq & 0x7fffffff);
}

void requireRateBound(const char* name, double value) {
  requireFinite(name, value);
  if (value < 0)
    throw avm::InvalidArgument(std::string(name) + " = " + std::to_string(value) + " (must be >= 0)");
}

}  // namespace

avm::PanTiltSample toIce(const PanTiltSample& s) {
  return {s.stamp_us, static_cast<Ice::Long>(s.seq), s.pan_rad, s.tilt_rad};
}

PanTiltSample fromIce(const avm::PanTiltSample& s) {
  return {s.stampUs, static_cast<std::uint64_t>(s.seq), s.panRad, s.tiltRad};
}

avm::PanTiltLimits toIce(const PanTiltLimits& l) {
  return {l.min_pan_rad,  l.max_pan_rad,        l.min_tilt_rad,
          l.max_tilt_rad, l.max_pan_rate_radps, l.max_tilt_rate_radps};
}

PanTiltLimits fromIce(const avm::PanTiltLimits& l) {
  return {l.minPanRad, l.maxPanRad, l.minTiltRad, l.maxTiltRad, l.maxPanRateRadps, l.maxTiltRateRadps};
}

PanTiltServant::PanTiltServant(PanTiltUnit& unit, const Eigen::Vector3d& p_robot, LeaseGuard::Now now)
    : LeasedServant(std::move(now)),
      unit_(unit),
      p_robot_(p_robot),
      samples_([&unit](StampUs after_us, std::chrono::milliseconds timeout) {
        return unit.samplesSince(after_us, timeout);
      }) {}

avm::CommandReply PanTiltServant::follow(const PanTiltCommand& command, const Ice::Current& current) {
  const std::lock_guard lock(commands_);
  lease_.require(current);
  return toIce(commandLocked(command));
}

void PanTiltServant::endMotion() {
  const std::lock_guard lock(commands_);
  if (turning_) commandLocked({PanTiltCommand::Kind::kVelocity, 0, 0, 0, 0});
}

PortReply PanTiltServant::commandLocked(const PanTiltCommand& command) {
  PortReply reply = unit_.command(command);
  if (!reply.ok()) return reply;
  turning_ = command.kind == PanTiltCommand::Kind::kVelocity &&
             (command.pan_rate_radps != 0.0 || command.tilt_rate_radps != 0.0);
  position_.reset();
  if (command.kind == PanTiltCommand::Kind::kPosition) {
    position_ = command;
    // The limits of a remote unit are unknown until it was reached.
    const PanTiltLimits limits = unit_.limits();
    if (limits.min_pan_rad < limits.max_pan_rad || limits.min_tilt_rad < limits.max_tilt_rad) {
      const PanTiltCommand followed = limitCommand(limits, command).command;
      position_->pan_rad = followed.pan_rad;
      position_->tilt_rad = followed.tilt_rad;
    }
    last_goal_ = {position_->pan_rad, position_->tilt_rad};
  }
  return reply;
}

avm::PanTiltLimits PanTiltServant::getLimits(const Ice::Current&) {
  return toIce(unit_.limits());
}

avm::CommandReply PanTiltServant::moveTo(avm::PanTiltAngles goal, double pan_rate_radps,
                                         double tilt_rate_radps, const Ice::Current& current) {
  requireFinite("panRad", goal.panRad);
  requireFinite("tiltRad", goal.tiltRad);
  requireRateBound("panRateRadps", pan_rate_radps);
  requireRateBound("tiltRateRadps", tilt_rate_radps);
  return follow({PanTiltCommand::Kind::kPosition, goal.panRad, goal.tiltRad, pan_rate_radps, tilt_rate_radps},
                current);
}

avm::CommandReply PanTiltServant::setRates(double pan_rate_radps, double tilt_rate_radps,
                                           const Ice::Current& current) {
  requireFinite("panRateRadps", pan_rate_radps);
  requireFinite("tiltRateRadps", tilt_rate_radps);
  return follow({PanTiltCommand::Kind::kVelocity, 0, 0, pan_rate_radps, tilt_rate_radps}, current);
}

avm::PanTiltStatus PanTiltServant::getPanTiltStatus(const Ice::Current&) {
  const auto newest = samples_.newest();
  const std::lock_guard lock(commands_);
  const bool done = position_ && newest && std::abs(newest->pan_rad - position_->pan_rad) <= kReached_rad &&
                    std::abs(newest->tilt_rad - position_->tilt_rad) <= kReached_rad;
  return {done, toIce(last_goal_)};
}

void PanTiltServant::samplesSinceAsync(Ice::Long after_us,
                                       std::function<void(const avm::PanTiltBatch&)> response,
                                       std::function<void(std::exception_ptr)> exception,
                                       const Ice::Current&) {
  answerSamples(samples_, after_us, std::move(response), std::move(exception));
}

int PanTiltServant::setPTMotorsData(std::shared_ptr<jderobot::PTMotorsData> data,
                                    const Ice::Current& current) {
  return data ? moveToDegrees(data->pan, data->tilt, data->panSpeed, data->tiltSpeed, current) : -1;
}

int PanTiltServant::moveToDegrees(double pan_deg, double tilt_deg, double pan_bound_degps,
                                  double tilt_bound_degps, const Ice::Current& current) {
  if (!allFinite({pan_deg, tilt_deg, pan_bound_degps, tilt_bound_degps})) return -1;
  if (pan_bound_degps < 0 || tilt_bound_degps < 0) return -1;
  const PanTiltCommand wanted{PanTiltCommand::Kind::kPosition, degToRad(pan_deg), degToRad(tilt_deg),
                              degToRad(pan_bound_degps), degToRad(tilt_bound_degps)};
  const std::lock_guard lock(commands_);
  return lease_.admits(current) && commandLocked(wanted).ok() ? 0 : -1;
}

std::shared_ptr<jderobot::PTMotorsParams> PanTiltServant::getPTMotorsParams(const Ice::Current&) {
  const PanTiltLimits limits = unit_.limits();
  return std::make_shared<jderobot::PTMotorsParams>(
      toFloatDeg(limits.max_pan_rad), toFloatDeg(limits.min_pan_rad), toFloatDeg(limits.max_tilt_rad),
      toFloatDeg(limits.min_tilt_rad), toFloatDeg(limits.max_pan_rate_radps),
      toFloatDeg(limits.max_tilt_rate_radps));
}

std::shared_ptr<jderobot::PTEncodersData> PanTiltServant::getPTEncodersData(const Ice::Current&) {
  const PanTiltSample newest = newestSample();
  return std::make_shared<jderobot::PTEncodersData>(toFloatDeg(newest.pan_rad), toFloatDeg(newest.tilt_rad),
                                                    toClock(newest.seq));
}

PanTiltSample PanTiltServant::newestSample() const {
  const auto newest = samples_.newest();
  if (!newest) throw Ice::UnknownException(__FILE__, __LINE__, "the pan-tilt unit has given no sample yet");
  return *newest;
}

int PanTiltServant::setPose3DMotorsData(std::shared_ptr<jderobot::Pose3DMotorsData> data,
                                        const Ice::Current& current) {
  if (!data || !allFinite({data->x, data->y, data->z, data->roll})) return -1;
  return moveToDegrees(data->pan, data->tilt, data->panSpeed, data->tiltSpeed, current);
}

std::shared_ptr<jderobot::Pose3DMotorsData> PanTiltServant::getPose3DMotorsData(const Ice::Current&) {
  std::optional<PanTiltCommand> position;
  {
    const std::lock_guard lock(commands_);
    position = position_;
  }
  if (!position) {
    const PanTiltSample newest = newestSample();
    position.emplace();
    position->pan_rad = newest.pan_rad;
    position->tilt_rad = newest.tilt_rad;
  }
  const Eigen::Vector3f p = p_robot_.cast<float>();
  return std::make_shared<jderobot::Pose3DMotorsData>(
      p.x(), p.y(), p.z(), toFloatDeg(position->pan_rad), toFloatDeg(position->tilt_rad), 0.F,
      toFloatDeg(position->pan_rate_radps), toFloatDeg(position->tilt_rate_radps));
}

std::shared_ptr<jderobot::Pose3DMotorsParams> PanTiltServant::getPose3DMotorsParams(
    const Ice::Current& current) {
  const auto p = getPTMotorsParams(current);
  return std::make_shared<jderobot::Pose3DMotorsParams>(p->maxPan, p->minPan, p->maxTilt, p->minTilt,
                                                        p->maxPanSpeed, p->maxTiltSpeed);
}

std::shared_ptr<jderobot::Pose3DEncodersData> PanTiltServant::getPose3DEncodersData(const Ice::Current&) {
  const PanTiltSample newest = newestSample();
  const PanTiltLimits l = unit_.limits();
  const Eigen::Vector3f p = p_robot_.cast<float>();
  return std::make_shared<jderobot::Pose3DEncodersData>(
      p.x(), p.y(), p.z(), toFloatDeg(newest.pan_rad), toFloatDeg(newest.tilt_rad), 0.F, toClock(newest.seq),
      toFloatDeg(l.max_pan_rad), toFloatDeg(l.max_tilt_rad), toFloatDeg(l.min_pan_rad),
      toFloatDeg(l.min_tilt_rad));
}

RemotePanTiltUnit::RemotePanTiltUnit(const std::shared_ptr<avm::PanTiltPrx>& proxy, LinkReport report)
    : proxy_(boundedProxy(proxy, kInvocationTimeout_ms)),
      commands_(boundedProxy(proxy, kCommandTimeout_ms)),
      samples_(proxy_, std::move(report)),
      limits_(proxy_, [this](auto done, auto failed) {
        proxy_->getLimitsAsync(std::move(done), std::move(failed));
      }) {}

PanTiltLimits RemotePanTiltUnit::limits() const {
  if (!limits_.last()) limits_.ask(std::chrono::milliseconds(0));
  const auto known = limits_.last();
  return known ? fromIce(*known) : PanTiltLimits{};
}

PortReply RemotePanTiltUnit::start() {
  if (!proxy_) return PortReply::rejected("no pan-tilt unit is configured");
  samples_.allow();
  limits_.allow();
  const std::string failure = limits_.ask(kLongPollWait);
  return failure.empty() ? PortReply::accepted()
                         : PortReply::adjusted("waiting for the pan-tilt unit: " + failure);
}

PortReply RemotePanTiltUnit::command(const PanTiltCommand& command) {
  PortReply reply = runRemote(commands_, "pan-tilt unit", [&command](avm::PanTiltPrx& unit) {
    if (command.kind == PanTiltCommand::Kind::kVelocity) {
      return unit.setRates(command.pan_rate_radps, command.tilt_rate_radps);
    }
    return unit.moveTo({command.pan_rad, command.tilt_rad}, command.pan_rate_radps, command.tilt_rate_radps);
  });
  if (reply.ok()) {
    turning_ = command.kind == PanTiltCommand::Kind::kVelocity &&
               (command.pan_rate_radps != 0.0 || command.tilt_rate_radps != 0.0);
  }
  return reply;
}

void RemotePanTiltUnit::stop() {
  samples_.interrupt();
  limits_.interrupt();
  if (turning_) command({PanTiltCommand::Kind::kVelocity, 0.0, 0.0, 0.0, 0.0});
}

SampleBatch<PanTiltSample> RemotePanTiltUnit::samplesSince(StampUs after_us,
                                                           std::chrono::milliseconds timeout) {
  return pollRemoteSamples<PanTiltSample>(
      samples_, after_us, timeout,
      [this, after_us](auto done, auto failed) {
        proxy_->samplesSinceAsync(after_us, std::move(done), std::move(failed));
      },
      [](const avm::PanTiltSample& sample) { return fromIce(sample); });
}

}  // namespace vismem
