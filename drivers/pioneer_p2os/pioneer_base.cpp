#include "drivers/pioneer_p2os/pioneer_base.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

#include "common/drivers/host_clock.h"
#include "common/geometry/angles.h"
#include "common/robot/command_limits.h"

namespace vismem {
namespace {

using namespace std::chrono_literals;
using p2os::Command;
using p2os::command;

constexpr char kStopped[] = "the base is stopped";
/// Shortest interval of commands at 9600 bit/s: 18 bytes each.
constexpr auto kShortestInterval = 25ms;
/// A speed is repeated, in case the line lost it.
constexpr auto kRepeatSpeed = 200ms;
constexpr auto kRepeatHalt = 100ms;
constexpr auto kRepeatEnable = 300ms;
/// Robots stop by themselves 2 s (default) after the last packet.
constexpr auto kPulse = 400ms;
/// Motors are on within this time after the command.
constexpr auto kEnabling = 1000ms;
constexpr auto kBrakePatience = 2000ms;
/// Motors that went off are switched on again only after a pause of commands or a command of 0.
constexpr auto kFreshStart = 1000ms;

int rounded(double value) {
  return static_cast<int>(std::lround(value));
}

}  // namespace

PioneerBase::PioneerBase(const Params& params)
    : params_(params),
      link_(params.port, params.bauds_bps),
      samples_("the base is not started"),
      thread_(kStopped, {[this](const std::stop_token& stop) { return session(stop); },
                         [this] { link_.wake(); }, [this](const std::string& why) { lost(why); }}) {}

PioneerBase::~PioneerBase() {
  stop();
}

PortReply PioneerBase::start() {
  samples_.open("the robot is being connected");
  return thread_.start();
}

void PioneerBase::stop() {
  if (thread_.stop()) samples_.close(kStopped);
}

PortReply PioneerBase::setVelocity(double v_mps, double w_radps) {
  const LimitedVelocity limited = limitVelocity(params_.limits, v_mps, w_radps);
  if (!limited.reply.ok()) return limited.reply;
  const auto now = Clock::now();
  const Speeds speeds{rounded(1000.0 * limited.v_mps), rounded(radToDeg(limited.w_radps))};
  const bool moves = speeds != Speeds{};
  if (const std::string why = thread_.unavailable(); !why.empty()) return PortReply::rejected(why);
  {
    const std::lock_guard lock(mutex_);
    const bool begins_anew = !moves || now - moved_at_ > kFreshStart;
    if (moves) moved_at_ = now;
    if (stop_button_) return PortReply::rejected("the stop button is pressed");
    if (!motors_on_) {
      may_enable_ = may_enable_ || begins_anew;
      if (!may_enable_) {
        return PortReply::rejected(
            "the motors went off: command 0, or nothing for a second, before the next");
      }
    }
    order_ = Order{speeds, now};
  }
  link_.wake();
  return limited.reply;
}

SampleBatch<OdometrySample> PioneerBase::samplesSince(StampUs after_us, std::chrono::milliseconds timeout) {
  return samples_.since(after_us, timeout);
}

void PioneerBase::lost(const std::string& why) {
  was_lost_ = true;
  {
    const std::lock_guard lock(mutex_);
    order_.reset();
  }
  samples_.setWaiting(why);
}

std::string PioneerBase::session(const std::stop_token& stop) {
  std::string why = link_.connect([&stop] { return stop.stop_requested(); });
  if (why.empty() && !stop.stop_requested()) why = beginSession();
  if (why.empty()) why = converse(stop);
  if (why.empty() || stop.stop_requested()) {
    link_.disconnect();
    was_lost_ = false;
    return {};
  }
  link_.drop();
  return why;
}

std::string PioneerBase::beginSession() {
  const p2os::Identity& robot = link_.identity();
  const auto known = p2os::scaleOf(robot.subclass);
  if (!params_.scale && !known) {
    return params_.port + ": the scales of a " + robot.robot_class + " " + robot.subclass +
           " are not known: set DistanceUnit_mm and TurnFactor_radpm";
  }
  scale_ = params_.scale ? *params_.scale : *known;
  odometry_.setScale(scale_);
  odometry_.restart();
  {
    // A robot that returns is treated as after a stop button.
    const std::lock_guard lock(mutex_);
    order_.reset();
    motors_on_ = false;
    stop_button_ = false;
    may_enable_ = true;
  }
  sent_ = {};
  stands_ = false;
  robot_.reset();
  sent_at_ = enabled_at_ = heard_at_ = Clock::now();
  const BaseLimits& limits = params_.limits;
  for (const p2os::Bytes& packet :
       {command(Command::kOpen), command(Command::kSpeed, 0), command(Command::kTurnRate, 0),
        command(Command::kSonar, 0), command(Command::kSetMaxSpeed, rounded(1000.0 * limits.max_speed_mps)),
        command(Command::kSetMaxTurnRate, rounded(radToDeg(limits.max_turn_rate_radps))),
        command(Command::kSetAcceleration, rounded(1000.0 * params_.acceleration_mps2)),
        command(Command::kSetAcceleration, -rounded(1000.0 * params_.deceleration_mps2)),
        command(Command::kSetTurnAcceleration, rounded(radToDeg(params_.turn_acceleration_radps2))),
        command(Command::kSetTurnAcceleration, -rounded(radToDeg(params_.turn_deceleration_radps2))),
        command(Command::kConfig, 1), command(Command::kEnable, 1)}) {
    if (std::string why = link_.send(packet); !why.empty()) return why;
  }
  return {};
}

std::string PioneerBase::converse(const std::stop_token& stop) {
  const std::string silent = params_.port + ": the robot says nothing any more";
  while (!stop.stop_requested()) {
    const p2os::Link::Received received = link_.receive(Clock::now() + kShortestInterval);
    if (!received.lost.empty()) return received.lost;
    if (received.data) handle(*received.data);
    const auto silence = Clock::now() - heard_at_;
    if (silence >= params_.lost_after) return silent;
    if (silence >= params_.silent_after) thread_.away(silent);
    if (std::string why = sendDue(); !why.empty()) return why;
  }
  brake();
  return {};
}

void PioneerBase::brake() {
  const auto end = Clock::now() + kBrakePatience;
  sent_ = {};
  stands_ = false;
  while (!stands_ && Clock::now() < end) {
    if (!link_.sendHalt().empty()) return;
    const auto again = Clock::now() + kRepeatHalt;
    while (!stands_ && Clock::now() < again) {
      const auto received = link_.receive(again);
      if (!received.lost.empty()) return;
      if (received.data) handle(*received.data);
    }
  }
}

void PioneerBase::handle(const p2os::Bytes& data) {
  if (const auto sip = p2os::parseSip(data)) {
    heard(*sip, data.size());
  } else if (auto config = p2os::parseConfig(data)) {
    robot_ = std::move(config);
  }
}

void PioneerBase::heard(const p2os::Sip& sip, std::size_t bytes) {
  heard_at_ = Clock::now();
  // The measurement precedes the transmission of its bytes, 10 bits each, with header and checksum.
  const StampUs on_the_way_us = static_cast<StampUs>(bytes + 5) * 10 * kSecondUs / link_.baud_bps();
  stands_ = sent_ == Speeds{} && sip.left_mmps == 0 && sip.right_mmps == 0;
  bool ready = false;
  {
    const std::lock_guard lock(mutex_);
    watchMotorsLocked(sip);
    samples_.setCondition(conditionLocked(sip));
    // Ready once the motors are on, or kept off by a button.
    ready = motors_on_ || stop_button_ || was_lost_ || enabled_at_ + kEnabling < heard_at_;
  }
  samples_.add({hostClock_us() - on_the_way_us, samples_given_++, odometry_.add(sip), p2os::forwardSpeed(sip),
                p2os::turnRate(sip, scale_)});
  if (ready) thread_.ready();
}

void PioneerBase::watchMotorsLocked(const p2os::Sip& sip) {
  const bool on = sip.motors_on && !sip.stop_button;
  if ((motors_on_ && !on) || sip.stop_button) {
    may_enable_ = false;
    order_.reset();
  }
  motors_on_ = on;
  stop_button_ = sip.stop_button;
}

std::string PioneerBase::conditionLocked(const p2os::Sip& sip) const {
  if (stop_button_) return "the stop button is pressed";
  if (!motors_on_ && heard_at_ - enabled_at_ > kRepeatEnable) return "the motors are off";
  if (sip.left_stalled && sip.right_stalled) return "both wheels are stalled";
  if (sip.left_stalled) return "the left wheel is stalled";
  if (sip.right_stalled) return "the right wheel is stalled";
  if (robot_ && robot_->watchdog_ms == 0) {
    return "the robot's own watchdog is off: it would drive on without this process (set its watchdog "
           "parameter)";
  }
  if (sip.battery_V < params_.low_battery_V) {
    std::ostringstream text;
    text << "the battery is low: under " << params_.low_battery_V << " V";
    return text.str();
  }
  return {};
}

PioneerBase::Speeds PioneerBase::wantedLocked(Clock::time_point now) {
  const auto watchdog = std::chrono::duration<double>(params_.limits.watchdog_s);
  if (order_ && now - order_->at >= watchdog) order_.reset();
  return order_ && motors_on_ && thread_.unavailable().empty() ? order_->speeds : Speeds{};
}

std::string PioneerBase::sendDue() {
  const auto now = Clock::now();
  const auto since = now - sent_at_;
  Speeds wanted;
  bool enable = false;
  {
    const std::lock_guard lock(mutex_);
    wanted = wantedLocked(now);
    enable = !motors_on_ && !stop_button_ && may_enable_ && order_ && order_->speeds != Speeds{};
  }
  if (enable && now - enabled_at_ >= kRepeatEnable) {
    // Stops first: the motors must not resume their old speed.
    if (std::string why = link_.sendHalt(); !why.empty()) return why;
    enabled_at_ = now;
    return link_.send(command(Command::kEnable, 1));
  }
  std::string why;
  if (wanted == Speeds{}) {
    if (sent_ != wanted || (!stands_ && since >= kRepeatHalt)) {
      why = link_.sendHalt();
    } else if (since >= kPulse) {
      why = link_.send(command(Command::kPulse));
    } else {
      return {};
    }
  } else {
    if (since < (sent_ == wanted ? kRepeatSpeed : std::chrono::milliseconds(kShortestInterval))) return {};
    why = link_.send(command(Command::kSpeed, wanted.v_mmps));
    if (why.empty()) why = link_.send(command(Command::kTurnRate, wanted.w_degps));
  }
  if (sent_ != wanted) stands_ = false;
  sent_ = wanted;
  sent_at_ = now;
  return why;
}

std::unique_ptr<MobileBase> makePioneerBase(ConfigReader& group) {
  PioneerBase::Params params;
  group.describe(
      {basic("Port", "better by a name that udev gives"),
       expert("Baud_bps", "rate of that port; 0: tries all of these robots"),
       basic("MaximumSpeed_mps", "highest speed, also set in the robot"),
       basic("MaximumTurnRate_degps", "highest rate of turning, also set in the robot"),
       basic("Watchdog_s", "so long after the last command the robot gets a stop command"),
       expert("Acceleration_mps2", "on the way to a higher speed"),
       expert("TurnAcceleration_degps2", "on the way to a higher rate of turning"),
       basic("Deceleration_mps2", "when it brakes; less for a high mast lengthens the stop"),
       basic("TurnDeceleration_degps2", "the same when it turns"),
       expert("LowBattery_V", "below this the server is degraded"),
       expert("DistanceUnit_mm", "of the robot's odometry; needed for unknown models"),
       expert(
           "TurnFactor_radpm",
           "turn for a metre that the wheels go apart, 2 over the wheel base; needed for unknown models")});
  params.port = group.requiredText("Port", "the robot's serial port, such as /dev/ttyUSB0");
  if (const long baud = group.integer("Baud_bps", 0, 0, 4'000'000); baud != 0) {
    if (!isBaudRate(static_cast<int>(baud))) {
      group.problem("Baud_bps", "must be a rate of serial ports, such as 9600, or 0 to try all");
    }
    params.bauds_bps = {static_cast<int>(baud)};
  }
  params.limits.max_speed_mps = group.real("MaximumSpeed_mps", params.limits.max_speed_mps, 0.01, 2.2);
  params.limits.max_turn_rate_radps = group.angleDeg("MaximumTurnRate_degps", 100.0, 1.0, 500.0);
  params.limits.watchdog_s = group.real("Watchdog_s", params.limits.watchdog_s, 0.05, 2.0);
  params.acceleration_mps2 = group.real("Acceleration_mps2", params.acceleration_mps2, 0.01, 10.0);
  params.deceleration_mps2 = group.real("Deceleration_mps2", params.deceleration_mps2, 0.01, 10.0);
  params.turn_acceleration_radps2 = group.angleDeg("TurnAcceleration_degps2", 200.0, 1.0, 5000.0);
  params.turn_deceleration_radps2 = group.angleDeg("TurnDeceleration_degps2", 1000.0, 1.0, 5000.0);
  params.low_battery_V = group.real("LowBattery_V", params.low_battery_V, 0.0, 60.0);
  const auto unit_mm = group.optionalReal("DistanceUnit_mm", 0.01, 100.0);
  const auto turn_factor = group.optionalReal("TurnFactor_radpm", 0.1, 100.0);
  if (unit_mm && turn_factor) {
    params.scale = p2os::Scale{*unit_mm, 1e-3 * *turn_factor};
  } else if (unit_mm || turn_factor) {
    group.problem(unit_mm ? "DistanceUnit_mm" : "TurnFactor_radpm",
                  "must be set together with " + group.key(unit_mm ? "TurnFactor_radpm" : "DistanceUnit_mm"));
  }
  return std::make_unique<PioneerBase>(params);
}

}  // namespace vismem
