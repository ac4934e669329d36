#include "drivers/pantilt_uvc/uvc_pan_tilt.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "common/drivers/axis_keys.h"
#include "common/drivers/host_clock.h"
#include "common/geometry/angles.h"

namespace vismem {
namespace {

using namespace std::chrono_literals;

/// A camera that stands this long away from its commanded position is blocked.
constexpr auto kFollows = 2000ms;
constexpr double kThere_rad = 0.035;

}  // namespace

void UvcPanTilt::Way::goOn(double dt_s) {
  const double left = target_rad - at_rad;
  const double most = rate_radps * dt_s;
  at_rad = std::abs(left) <= most ? target_rad : at_rad + std::copysign(most, left);
}

UvcPanTilt::UvcPanTilt(const Params& params)
    : DevicePanTilt(params.rate_hz), params_(params), limits_{params.pan.minimum_rad,
                                                              params.pan.maximum_rad,
                                                              params.tilt.minimum_rad,
                                                              params.tilt.maximum_rad,
                                                              params.pan.rate_radps,
                                                              params.tilt.rate_radps} {}

UvcPanTilt::~UvcPanTilt() {
  stop();
}

PanTiltLimits UvcPanTilt::limits() const {
  const std::lock_guard lock(mutex_);
  return limits_;
}

double UvcPanTilt::angle(const Axis& axis, std::int64_t steps) const {
  return axis.zero_rad + axis.sign * static_cast<double>(steps) * controls_->step_rad();
}

std::int64_t UvcPanTilt::steps(const Axis& axis, const uvc::AxisRange& range, double angle_rad) const {
  const double exact = axis.sign * (angle_rad - axis.zero_rad) / controls_->step_rad();
  const auto whole = range.minimum + range.step * std::lround((exact - static_cast<double>(range.minimum)) /
                                                              static_cast<double>(range.step));
  return std::clamp(whole, range.minimum, range.maximum);
}

std::string UvcPanTilt::learnRanges() {
  PanTiltLimits limits{params_.pan.minimum_rad,  params_.pan.maximum_rad, params_.tilt.minimum_rad,
                       params_.tilt.maximum_rad, params_.pan.rate_radps,  params_.tilt.rate_radps};
  const auto stepsOfLimits = [this](const Axis& axis) {
    const double a = axis.sign * (axis.minimum_rad - axis.zero_rad) / controls_->step_rad();
    const double b = axis.sign * (axis.maximum_rad - axis.zero_rad) / controls_->step_rad();
    return uvc::AxisRange{std::lround(std::min(a, b)), std::lround(std::max(a, b)), 1};
  };
  pan_range_ = stepsOfLimits(params_.pan);
  tilt_range_ = stepsOfLimits(params_.tilt);
  uvc::AxisRange pan;
  uvc::AxisRange tilt;
  if (controls_->ranges(pan, tilt)) {
    if (pan.minimum >= pan.maximum || tilt.minimum >= tilt.maximum) {
      return device_.failed("reports an invalid range");
    }
    pan_range_ = pan;
    tilt_range_ = tilt;
    const auto narrow = [this](const Axis& axis, const uvc::AxisRange& range, double& low, double& high) {
      const double a = angle(axis, range.minimum);
      const double b = angle(axis, range.maximum);
      low = std::max(low, std::min(a, b));
      high = std::min(high, std::max(a, b));
    };
    narrow(params_.pan, pan, limits.min_pan_rad, limits.max_pan_rad);
    narrow(params_.tilt, tilt, limits.min_tilt_rad, limits.max_tilt_rad);
  }
  if (limits.min_pan_rad >= limits.max_pan_rad || limits.min_tilt_rad >= limits.max_tilt_rad) {
    return device_.failed("nothing of the configured limits is within the camera's own");
  }
  const std::lock_guard lock(mutex_);
  limits_ = limits;
  return {};
}

std::string UvcPanTilt::home(const std::stop_token& stop) {
  if (std::string why = controls_->reset(); !why.empty()) return why;
  refuseBecause(device_.failed("finds its zero"));
  const auto end = Clock::now() + params_.reset_takes;
  while (!stop.stop_requested() && Clock::now() < end) {
    pauseUntil(std::min(end, Clock::now() + 100ms), stop);
    if (!device_.isThere()) return device_.failed("was unplugged");
  }
  return {};
}

std::string UvcPanTilt::connect(const std::stop_token& stop) {
  if (std::string why = device_.open(params_.device); !why.empty()) return why;
  controls_.reset();
  if (params_.kind != Kind::kOrbit) controls_ = uvc::makeAbsoluteControls(device_);
  if (!controls_ && params_.kind != Kind::kAbsolute) controls_ = uvc::makeOrbitControls(device_);
  if (!controls_) {
    if (!device_.isThere()) return device_.failed("was unplugged");
    const std::string card = " (\"" + device_.identity().card + "\")";
    return device_.failed(params_.kind == Kind::kOrbit      ? "has not the motors of an Orbit" + card
                          : params_.kind == Kind::kAbsolute ? "has no control of absolute angles" + card
                                                            : "cannot turn" + card);
  }
  std::string why = learnRanges();
  if (why.empty() && controls_->needsReset()) why = home(stop);
  uvc::Steps now;
  if (why.empty()) why = controls_->at(now);
  if (!why.empty()) return why;
  sent_ = now;
  pan_.at_rad = pan_.target_rad = angle(params_.pan, now.pan);
  tilt_.at_rad = tilt_.target_rad = angle(params_.tilt, now.tilt);
  moved_at_ = arrived_at_ = Clock::now();
  return {};
}

std::string UvcPanTilt::obey(const PanTiltCommand& command) {
  const PanTiltLimits bounds = limits();
  const auto begin = [&](Way& way, double angle_rad, double rate_radps, double low, double high,
                         double fastest) {
    if (command.kind == PanTiltCommand::Kind::kPosition) {
      way.target_rad = angle_rad;
      way.rate_radps = rate_radps > 0.0 ? rate_radps : fastest;
    } else {
      way.target_rad = rate_radps == 0.0 ? way.at_rad : (rate_radps > 0.0 ? high : low);
      way.rate_radps = std::abs(rate_radps);
    }
  };
  // The motion until now had the previous rates.
  std::string why = poll();
  begin(pan_, command.pan_rad, command.pan_rate_radps, bounds.min_pan_rad, bounds.max_pan_rad,
        bounds.max_pan_rate_radps);
  begin(tilt_, command.tilt_rad, command.tilt_rate_radps, bounds.min_tilt_rad, bounds.max_tilt_rad,
        bounds.max_tilt_rate_radps);
  return why;
}

std::string UvcPanTilt::poll() {
  const auto now = Clock::now();
  const double dt_s = std::chrono::duration<double>(now - moved_at_).count();
  moved_at_ = now;
  pan_.goOn(dt_s);
  tilt_.goOn(dt_s);
  const uvc::Steps wanted{steps(params_.pan, pan_range_, pan_.at_rad),
                          steps(params_.tilt, tilt_range_, tilt_.at_rad)};
  if (wanted != sent_) {
    if (std::string why = controls_->turnTo(wanted); !why.empty()) return why;
    sent_ = wanted;
  }
  const StampUs asked_us = hostClock_us();
  uvc::Steps is;
  if (std::string why = controls_->at(is); !why.empty()) return why;
  setCondition(conditionOf(is, now));
  give(asked_us, angle(params_.pan, is.pan), angle(params_.tilt, is.tilt));
  return {};
}

std::string UvcPanTilt::conditionOf(const uvc::Steps& is, Clock::time_point now) {
  const double pan_off = std::abs(angle(params_.pan, is.pan) - angle(params_.pan, sent_.pan));
  const double tilt_off = std::abs(angle(params_.tilt, is.tilt) - angle(params_.tilt, sent_.tilt));
  const bool there = pan_off <= kThere_rad && tilt_off <= kThere_rad;
  if (there || !pan_.rests() || !tilt_.rests()) arrived_at_ = now;
  if (now - arrived_at_ <= kFollows) return {};
  std::ostringstream text;
  text << "the camera does not follow (jammed?): ";
  text.precision(3);
  if (pan_off > kThere_rad) text << "pan is " << radToDeg(pan_off) << " deg off";
  if (tilt_off > kThere_rad) {
    text << (pan_off > kThere_rad ? ", " : "") << "tilt is " << radToDeg(tilt_off) << " deg off";
  }
  return text.str();
}

void UvcPanTilt::disconnect(bool) {
  // It was never sent beyond its present position.
  controls_.reset();
  device_.close();
}

std::unique_ptr<PanTiltUnit> makeUvcPanTilt(ConfigReader& group) {
  using Kind = UvcPanTilt::Kind;
  UvcPanTilt::Params params;
  group.describe({basic("Device", "better by a persistent name"),
                  expert("Motors",
                         "absolute: the controls of the standard; orbit: of Logitech's Orbit and Sphere; "
                         "auto: what it has"),
                  expert("Rate_hz", "steps and samples a second"),
                  expert("ResetTakes_s", "length of an Orbit's reset, whose end it does not report")});
  params.device = group.requiredText("Device", "the camera's device, such as /dev/video0");
  params.kind = group.choice("Motors", Kind::kAuto,
                             {{"auto", Kind::kAuto}, {"absolute", Kind::kAbsolute}, {"orbit", Kind::kOrbit}});
  params.rate_hz = group.real("Rate_hz", params.rate_hz, 1.0, 100.0);
  params.reset_takes =
      std::chrono::milliseconds(static_cast<long>(1000.0 * group.real("ResetTakes_s", 4.0, 0.0, 60.0)));
  const auto read = [&](const std::string& name, UvcPanTilt::Axis& axis, double range_deg, double sign) {
    describeAxis(group.group(name));
    group.group(name).describe({basic("Zero_deg", "the driver's angle where the camera has 0")});
    axis.minimum_rad = group.angleDeg(name + ".Minimum_deg", -range_deg, -180.0, 180.0);
    axis.maximum_rad = group.angleDeg(name + ".Maximum_deg", range_deg, -180.0, 180.0);
    if (axis.minimum_rad >= axis.maximum_rad) {
      group.problem(name + ".Minimum_deg", "must be less than " + group.key(name + ".Maximum_deg"));
    }
    axis.rate_radps = group.angleDeg(name + ".Rate_degps", 60.0, 1.0, 1000.0);
    axis.zero_rad = group.angleDeg(name + ".Zero_deg", 0.0, -180.0, 180.0);
    axis.sign = group.boolean(name + ".Inverted", false) ? -sign : sign;
  };
  // V4L2 counts to the right and up.
  read("Pan", params.pan, 60.0, -1.0);
  read("Tilt", params.tilt, 25.0, 1.0);
  return std::make_unique<UvcPanTilt>(params);
}

}  // namespace vismem
