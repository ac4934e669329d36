#include "common/robot_ice/base_ice.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/geometry/angles.h"
#include "common/robot_ice/conversions.h"
#include "common/robot_ice/pose3d_ice.h"

namespace vismem {
namespace {

double clampTo(double value, double limit) {
  return limit > 0 ? std::clamp(value, -limit, limit) : value;
}

}  // namespace

avm::OdometrySample toIce(const OdometrySample& s) {
  return {s.stamp_us, static_cast<Ice::Long>(s.seq), toIce(s.T_odom_robot), s.v_mps, s.w_radps};
}

OdometrySample fromIce(const avm::OdometrySample& s) {
  return {s.stampUs, static_cast<std::uint64_t>(s.seq), fromIce(s.robotInOdom), s.vMps, s.wRadps};
}

avm::BaseLimits toIce(const BaseLimits& l) {
  return {l.max_speed_mps, l.max_turn_rate_radps, l.watchdog_s};
}
BaseLimits fromIce(const avm::BaseLimits& l) {
  return {l.maxSpeedMps, l.maxTurnRateRadps, l.watchdogS};
}

jderobot::EncodersData toEncoders(const Pose2& T_odom_robot) {
  double theta_deg = radToDeg(wrapAngle(T_odom_robot.theta));
  if (theta_deg < 0) theta_deg += 360.0;
  auto theta = static_cast<float>(theta_deg);
  if (theta >= 360.0F) theta = 0.0F;  // a tiny negative angle rounds up
  return {static_cast<float>(T_odom_robot.x * 1000.0), static_cast<float>(T_odom_robot.y * 1000.0), theta,
          static_cast<float>(std::cos(T_odom_robot.theta)), static_cast<float>(std::sin(T_odom_robot.theta))};
}

void BaseServant::limitSpeed(double speed_mps) {
  highest_speed_mps_ = speed_mps;
}

void BaseServant::limitTurnRate(double turn_rate_radps) {
  highest_turn_rate_radps_ = turn_rate_radps;
}

BaseLimits BaseServant::limits() const {
  BaseLimits limits = base_.limits();
  // A base that was not reached yet has limits of 0, which are none.
  const auto lower = [](double own, double set) { return own > 0 ? std::min(own, set) : own; };
  limits.max_speed_mps = lower(limits.max_speed_mps, highest_speed_mps_);
  limits.max_turn_rate_radps = lower(limits.max_turn_rate_radps, highest_turn_rate_radps_);
  return limits;
}

avm::BaseLimits BaseServant::getLimits(const Ice::Current&) {
  return toIce(limits());
}

CommandLease::Duration BaseServant::commandTime() const {
  const double watchdog_s = base_.limits().watchdog_s;
  if (watchdog_s <= 0) return CommandLease::kImplicitTimeout;
  return std::chrono::duration_cast<CommandLease::Duration>(std::chrono::duration<double>(watchdog_s));
}

BaseServant::Speeds BaseServant::commanded() const {
  const double watchdog_s = base_.limits().watchdog_s;
  if (!last_time_) return {};
  const std::chrono::duration<double> age = now_() - *last_time_;
  // The speed of a disconnected client must not return with the first command of the next one.
  if (watchdog_s > 0 && age.count() > watchdog_s) return {};
  return last_;
}

PortReply BaseServant::commandLocked(Speeds speeds) {
  const Speeds wanted{
      std::clamp<double>(speeds.v_mps, -highest_speed_mps_, highest_speed_mps_),
      std::clamp<double>(speeds.w_radps, -highest_turn_rate_radps_, highest_turn_rate_radps_)};
  PortReply reply = base_.setVelocity(wanted.v_mps, wanted.w_radps);
  if (!reply.ok()) return reply;
  const BaseLimits limits = base_.limits();
  last_ = {clampTo(wanted.v_mps, limits.max_speed_mps), clampTo(wanted.w_radps, limits.max_turn_rate_radps)};
  last_time_ = now_();
  const bool slowed = wanted.v_mps != speeds.v_mps || wanted.w_radps != speeds.w_radps;
  if (!slowed || reply.kind == PortReply::Kind::kAdjusted) return reply;
  return PortReply::adjusted("brought to " + std::to_string(wanted.v_mps) + " m/s, " +
                             std::to_string(wanted.w_radps) + " rad/s by the limits set at run time");
}

avm::CommandReply BaseServant::setVelocity(double v_mps, double w_radps, const Ice::Current& current) {
  requireFinite("vMps", v_mps);
  requireFinite("wRadps", w_radps);
  const std::lock_guard lock(commands_);
  lease_.require(current, commandTime());
  return toIce(commandLocked({v_mps, w_radps}));
}

avm::CommandReply BaseServant::stop(const Ice::Current&) {
  lease_.stop();
  const std::lock_guard lock(commands_);
  return toIce(commandLocked({}));
}

void BaseServant::endMotion() {
  const std::lock_guard lock(commands_);
  commandLocked({});
}

float BaseServant::getV(const Ice::Current&) {
  const std::lock_guard lock(commands_);
  return static_cast<float>(commanded().v_mps);
}

float BaseServant::getW(const Ice::Current&) {
  const std::lock_guard lock(commands_);
  return static_cast<float>(commanded().w_radps);
}

int BaseServant::setV(float v, const Ice::Current& current) {
  if (!std::isfinite(v)) return -1;
  const std::lock_guard lock(commands_);
  if (!lease_.admits(current, commandTime())) return -1;
  return commandLocked({v, commanded().w_radps}).ok() ? 0 : -1;
}

int BaseServant::setW(float w, const Ice::Current& current) {
  if (!std::isfinite(w)) return -1;
  const std::lock_guard lock(commands_);
  if (!lease_.admits(current, commandTime())) return -1;
  return commandLocked({commanded().v_mps, w}).ok() ? 0 : -1;
}

OdometryServant::OdometryServant(MobileBase& base)
    : samples_([&base](StampUs after_us, std::chrono::milliseconds timeout) {
        return base.samplesSince(after_us, timeout);
      }) {}

void OdometryServant::samplesSinceAsync(Ice::Long after_us,
                                        std::function<void(const avm::OdometryBatch&)> response,
                                        std::function<void(std::exception_ptr)> exception,
                                        const Ice::Current&) {
  answerSamples(samples_, after_us, std::move(response), std::move(exception));
}

std::shared_ptr<jderobot::EncodersData> OdometryServant::getEncodersData(const Ice::Current&) {
  return std::make_shared<jderobot::EncodersData>(toEncoders(newestPose()));
}

std::shared_ptr<jderobot::Pose3DData> OdometryServant::getPose3DData(const Ice::Current&) {
  return std::make_shared<jderobot::Pose3DData>(toPose3D(newestPose()));
}

Pose2 OdometryServant::newestPose() const {
  const auto newest = samples_.newest();
  if (!newest) throw Ice::UnknownException(__FILE__, __LINE__, "the base has given no odometry yet");
  return newest->T_odom_robot;
}

RemoteMobileBase::RemoteMobileBase(const std::shared_ptr<avm::BasePrx>& motors,
                                   const std::shared_ptr<avm::OdometryPrx>& encoders,
                                   LinkReport encoders_report)
    : motors_(boundedProxy(motors, kCommandTimeout_ms)),
      encoders_(boundedProxy(encoders, kInvocationTimeout_ms)),
      samples_(encoders_, std::move(encoders_report)),
      limits_(motors_, [this](auto done, auto failed) {
        motors_->getLimitsAsync(std::move(done), std::move(failed));
      }) {}

BaseLimits RemoteMobileBase::limits() const {
  if (!limits_.last()) limits_.ask(std::chrono::milliseconds(0));
  const auto known = limits_.last();
  return known ? fromIce(*known) : BaseLimits{};
}

PortReply RemoteMobileBase::start() {
  samples_.allow();
  limits_.allow();
  if (!motors_) return PortReply::accepted();
  const std::string failure = limits_.ask(kLongPollWait);
  return failure.empty() ? PortReply::accepted() : PortReply::adjusted("waiting for the motors: " + failure);
}

PortReply RemoteMobileBase::setVelocity(double v_mps, double w_radps) {
  PortReply reply = runRemote(motors_, "base with motors", [v_mps, w_radps](avm::BasePrx& base) {
    return base.setVelocity(v_mps, w_radps);
  });
  if (reply.ok()) driving_ = v_mps != 0.0 || w_radps != 0.0;
  return reply;
}

void RemoteMobileBase::stop() {
  samples_.interrupt();
  limits_.interrupt();
  if (driving_) setVelocity(0.0, 0.0);
}

SampleBatch<OdometrySample> RemoteMobileBase::samplesSince(StampUs after_us,
                                                           std::chrono::milliseconds timeout) {
  return pollRemoteSamples<OdometrySample>(
      samples_, after_us, timeout,
      [this, after_us](auto done, auto failed) {
        encoders_->samplesSinceAsync(after_us, std::move(done), std::move(failed));
      },
      [](const avm::OdometrySample& sample) { return fromIce(sample); });
}

}  // namespace vismem
