#include "drivers/ptu46/ptu46_unit.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "common/drivers/axis_keys.h"
#include "common/drivers/host_clock.h"
#include "common/drivers/slowest_rate.h"
#include "common/geometry/angles.h"

namespace vismem {
namespace {

using namespace std::chrono_literals;
using ptu46::Axis;
using ptu46::Reply;

constexpr double kArcSecond_rad = std::numbers::pi / 180.0 / 3600.0;
/// A reply takes about 10 ms at 9600 bit/s; a USB adapter delays bytes by 16 ms.
constexpr auto kAnswer = 500ms;
/// Duration of a reset: both axes move to their ends.
constexpr auto kReset = 30'000ms;
constexpr auto kQuiet = 60ms;
constexpr auto kQuietAtMost = 600ms;
constexpr int kSilentRounds = 3;

std::string bytesText(const std::string& command) {
  return command.substr(0, command.find_last_not_of(' ') + 1);
}

}  // namespace

Ptu46Unit::Ptu46Unit(const Params& params) : DevicePanTilt(params.rate_hz), params_(params) {}

Ptu46Unit::~Ptu46Unit() {
  stop();
}

PanTiltLimits Ptu46Unit::limits() const {
  PanTiltLimits limits{params_.pan.minimum_rad,  params_.pan.maximum_rad, params_.tilt.minimum_rad,
                       params_.tilt.maximum_rad, params_.pan.rate_radps,  params_.tilt.rate_radps};
  const std::lock_guard lock(mutex_);
  const auto narrow = [](const ptu46::AxisRange& range, const AxisParams& axis, double& low, double& high,
                         double& rate) {
    if (range.step_rad == 0.0) return;
    const double a = axis.frame.angle(static_cast<double>(range.minimum), range.step_rad);
    const double b = axis.frame.angle(static_cast<double>(range.maximum), range.step_rad);
    low = std::max(low, std::min(a, b));
    high = std::min(high, std::max(a, b));
    rate = std::min(rate, static_cast<double>(range.fastest) * range.step_rad);
  };
  narrow(ranges_[0], params_.pan, limits.min_pan_rad, limits.max_pan_rad, limits.max_pan_rate_radps);
  narrow(ranges_[1], params_.tilt, limits.min_tilt_rad, limits.max_tilt_rad, limits.max_tilt_rate_radps);
  return limits;
}

void Ptu46Unit::adjustVelocity(PanTiltCommand& command, PortReply& reply) const {
  const std::lock_guard lock(mutex_);
  atLeastSlowest("pan", slowest(ranges_[0]), command.pan_rate_radps, reply);
  atLeastSlowest("tilt", slowest(ranges_[1]), command.tilt_rate_radps, reply);
}

void Ptu46Unit::readUntilQuiet() {
  const auto end = Clock::now() + kQuietAtMost;
  while (Clock::now() < end) {
    const auto input = port_.read(std::min(Clock::now() + kQuiet, end));
    if (input.kind == SerialPort::Input::Kind::kNothing || input.kind == SerialPort::Input::Kind::kGone)
      break;
  }
  reader_.reset();
}

std::string Ptu46Unit::ask(const std::string& commands, std::chrono::milliseconds patience) {
  replies_.clear();
  const auto wanted = static_cast<std::size_t>(std::count(commands.begin(), commands.end(), ' '));
  const auto deadline = Clock::now() + patience;
  const std::span<const char> text(commands);
  const std::vector<std::uint8_t> bytes(text.begin(), text.end());
  if (std::string why = port_.write(bytes, deadline); !why.empty()) return why;
  while (replies_.size() < wanted) {
    while (const auto reply = reader_.next()) {
      switch (reply->kind) {
        case Reply::Kind::kPanLimit:
          limit_hit_ = "pan";
          break;
        case Reply::Kind::kTiltLimit:
          limit_hit_ = "tilt";
          break;
        default:
          replies_.push_back(*reply);
      }
    }
    if (replies_.size() >= wanted) break;
    const auto input = port_.read(deadline);
    if (input.kind == SerialPort::Input::Kind::kGone) return input.why;
    if (input.kind == SerialPort::Input::Kind::kBytes) reader_.add(input.bytes);
    if (stop_.stop_requested()) return params_.port + ": stopped";
    if (input.kind != SerialPort::Input::Kind::kBytes && Clock::now() >= deadline) {
      return params_.port + ": the pan-tilt unit says nothing any more";
    }
  }
  return {};
}

std::string Ptu46Unit::askNumber(Axis axis, char what, double& value) {
  const std::string command = ptu46::query(axis, what);
  if (std::string why = ask(command, kAnswer); !why.empty()) return why;
  const auto number =
      replies_[0].kind == Reply::Kind::kDone ? ptu46::numberIn(replies_[0].text) : std::optional<double>();
  if (!number) {
    return params_.port + ": to " + bytesText(command) + " the unit says \"" + replies_[0].text +
           "\", not a number";
  }
  value = *number;
  return {};
}

std::string Ptu46Unit::learnRanges() {
  Ranges ranges;
  for (const Axis axis : {Axis::kPan, Axis::kTilt}) {
    std::array<double, 5> values{};
    double arc_seconds = 0.0;
    std::string why = askNumber(axis, ptu46::kResolution, arc_seconds);
    const std::array asked{ptu46::kMinimum, ptu46::kMaximum, ptu46::kSlowest, ptu46::kFastest};
    for (std::size_t i = 0; i < asked.size() && why.empty(); ++i) why = askNumber(axis, asked[i], values[i]);
    if (!why.empty()) return why;
    ranges[axis == Axis::kPan ? 0 : 1] = {arc_seconds * kArcSecond_rad, std::lround(values[0]),
                                          std::lround(values[1]), std::lround(values[2]),
                                          std::lround(values[3])};
    if (arc_seconds <= 0.0 || values[0] >= values[1] || values[3] <= 0.0) {
      return params_.port + ": the unit reports an invalid range";
    }
  }
  {
    const std::lock_guard lock(mutex_);
    ranges_ = ranges;
  }
  const PanTiltLimits all = limits();
  if (all.min_pan_rad >= all.max_pan_rad || all.min_tilt_rad >= all.max_tilt_rad) {
    return params_.port + ": nothing of the configured limits is within the unit's own";
  }
  return {};
}

std::string Ptu46Unit::begin() {
  if (std::string why = port_.open(params_.port, params_.baud_bps); !why.empty()) return why;
  limit_hit_.clear();
  refused_.clear();
  // The first blank ends an incomplete earlier command; the unit may answer it with an error.
  const std::array<std::uint8_t, 1> blank{' '};
  if (std::string why = port_.write(blank, Clock::now() + kAnswer); !why.empty()) return why;
  readUntilQuiet();
  // Terse mode, no echo, position control, immediate execution; and stop. Bytes before the replies are echo.
  std::string why = ask("ED FT ", kAnswer);
  if (!why.empty() && port_.isOpen() && replies_.empty() && !stop_.stop_requested()) {
    const bool garbage = reader_.otherBytes() > 0;
    return params_.port +
           (garbage ? ": what answers is no pan-tilt unit (" : ": no pan-tilt unit answers (") +
           std::to_string(params_.baud_bps) + " bit/s)";
  }
  if (why.empty()) why = ask("CI I H ", kAnswer);
  if (!why.empty()) return why;
  if (params_.reset && !reset_done_) {
    refuseBecause(params_.port + ": the pan-tilt unit finds its zero");
    if (why = ask("R ", kReset); !why.empty()) return why;
    limit_hit_.clear();  // the reset uses the limit switches
    reset_done_ = true;
  }
  return learnRanges();
}

std::string Ptu46Unit::connect(const std::stop_token& stop) {
  stop_ = stop;
  silent_ = 0;
  return begin();
}

std::string Ptu46Unit::pauseUntil(Clock::time_point until, const std::stop_token&) {
  // No reply is due: bytes are messages of limit switches, or the line has ended.
  const auto input = port_.read(until);
  if (input.kind == SerialPort::Input::Kind::kGone) return input.why;
  if (input.kind == SerialPort::Input::Kind::kBytes) reader_.add(input.bytes);
  return {};
}

std::string Ptu46Unit::unlessOnce(std::string why) {
  if (why.empty()) {
    silent_ = 0;
    return {};
  }
  const bool gone = why.find("says nothing") == std::string::npos;
  if (gone || ++silent_ >= kSilentRounds) return why;
  // Late replies must not be taken for those to the next commands.
  readUntilQuiet();
  return {};
}

void Ptu46Unit::disconnect(bool halt) {
  if (halt && port_.isOpen()) {
    stop_ = {};
    readUntilQuiet();
    static_cast<void>(ask("H ", kAnswer));
  }
  port_.close();
}

std::string Ptu46Unit::sendCommand(const PanTiltCommand& command) {
  Ranges ranges;
  {
    const std::lock_guard lock(mutex_);
    ranges = ranges_;
  }
  const PanTiltLimits bounds = limits();
  std::string text;
  const auto add = [&](Axis axis, const AxisParams& params, const ptu46::AxisRange& range, double angle_rad,
                       double rate_radps, double low, double high, double fastest) {
    const bool velocity = command.kind == PanTiltCommand::Kind::kVelocity;
    if (velocity && rate_radps == 0.0) {
      text += axis == Axis::kPan ? "HP " : "HT ";
      return;
    }
    const double target = velocity ? (rate_radps > 0.0 ? high : low) : angle_rad;
    const double rate = velocity ? std::abs(rate_radps) : (rate_radps > 0.0 ? rate_radps : fastest);
    const long speed = std::clamp(std::lround(rate / range.step_rad), range.slowest, range.fastest);
    const long steps =
        std::clamp(std::lround(params.frame.steps(target, range.step_rad)), range.minimum, range.maximum);
    text += ptu46::set(axis, ptu46::kSpeed, speed) + ptu46::set(axis, ptu46::kPosition, steps);
  };
  add(Axis::kPan, params_.pan, ranges[0], command.pan_rad, command.pan_rate_radps, bounds.min_pan_rad,
      bounds.max_pan_rad, bounds.max_pan_rate_radps);
  add(Axis::kTilt, params_.tilt, ranges[1], command.tilt_rad, command.tilt_rate_radps, bounds.min_tilt_rad,
      bounds.max_tilt_rad, bounds.max_tilt_rate_radps);
  if (std::string why = ask(text, kAnswer); !why.empty()) return why;
  refused_.clear();
  for (const Reply& reply : replies_) {
    if (reply.kind == Reply::Kind::kError) refused_ = "the unit refused a command: " + reply.text;
  }
  return {};
}

std::string Ptu46Unit::sample() {
  Ranges ranges;
  {
    const std::lock_guard lock(mutex_);
    ranges = ranges_;
  }
  const StampUs asked_us = hostClock_us();
  if (std::string why = ask("PP TP ", kAnswer); !why.empty()) return why;
  const auto pan = ptu46::numberIn(replies_[0].text);
  const auto tilt = ptu46::numberIn(replies_[1].text);
  if (!pan || !tilt || replies_[0].kind != Reply::Kind::kDone || replies_[1].kind != Reply::Kind::kDone) {
    readUntilQuiet();
    refused_ =
        "the unit answered \"" + replies_[0].text + "\" and \"" + replies_[1].text + "\" for its angles";
    setCondition(refused_);
    return {};
  }
  setCondition(limit_hit_.empty() ? refused_
                                  : limit_hit_ + " ran into its limit switch: its zero may be lost");
  give(asked_us, params_.pan.frame.angle(*pan, ranges[0].step_rad),
       params_.tilt.frame.angle(*tilt, ranges[1].step_rad));
  return {};
}

std::unique_ptr<PanTiltUnit> makePtu46Unit(ConfigReader& group) {
  Ptu46Unit::Params params;
  group.describe({basic("Port", "better by a name that udev gives"), expert("Baud_bps", "rate of that port"),
                  expert("Rate_hz", "samples a second; 9600 bit/s carry about 25"),
                  expert("Reset", "find the zero at the first connection")});
  params.port = group.requiredText("Port", "the unit's serial port, such as /dev/ttyUSB0");
  params.baud_bps = static_cast<int>(group.integer("Baud_bps", params.baud_bps, 50, 4'000'000));
  if (!isBaudRate(params.baud_bps)) group.problem("Baud_bps", "must be a rate of serial ports, such as 9600");
  params.rate_hz = group.real("Rate_hz", params.rate_hz, 1.0, 50.0);
  params.reset = group.boolean("Reset", params.reset);
  const auto read = [&](const std::string& name, Ptu46Unit::AxisParams& axis, double low_deg,
                        double high_deg) {
    describeAxis(group.group(name));
    group.group(name).describe({basic("Zero_deg", "the unit's own angle where the driver has 0")});
    axis.minimum_rad = group.angleDeg(name + ".Minimum_deg", low_deg, -180.0, 180.0);
    axis.maximum_rad = group.angleDeg(name + ".Maximum_deg", high_deg, -180.0, 180.0);
    if (axis.minimum_rad >= axis.maximum_rad) {
      group.problem(name + ".Minimum_deg", "must be less than " + group.key(name + ".Maximum_deg"));
    }
    axis.rate_radps = group.angleDeg(name + ".Rate_degps", 100.0, 1.0, 300.0);
    axis.frame.zero_rad = group.angleDeg(name + ".Zero_deg", 0.0, -180.0, 180.0);
    axis.frame.inverted = group.boolean(name + ".Inverted", false);
  };
  read("Pan", params.pan, -155.0, 155.0);
  read("Tilt", params.tilt, -45.0, 30.0);
  return std::make_unique<Ptu46Unit>(params);
}

}  // namespace vismem
