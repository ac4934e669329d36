#include "drivers/pololu_maestro/maestro_pan_tilt.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>
#include <vector>

#include "common/drivers/axis_keys.h"
#include "common/drivers/host_clock.h"
#include "common/drivers/slowest_rate.h"
#include "common/geometry/angles.h"

namespace vismem {

MaestroPanTilt::MaestroPanTilt(const Params& params) : DevicePanTilt(params.rate_hz), params_(params) {}

MaestroPanTilt::~MaestroPanTilt() {
  stop();
}

PanTiltLimits MaestroPanTilt::limits() const {
  return {params_.pan.minimum_rad,  params_.pan.maximum_rad, params_.tilt.minimum_rad,
          params_.tilt.maximum_rad, params_.pan.rate_radps,  params_.tilt.rate_radps};
}

void MaestroPanTilt::adjustVelocity(PanTiltCommand& command, PortReply& reply) const {
  atLeastSlowest("pan", params_.pan.pulse.slowest_radps(), command.pan_rate_radps, reply);
  atLeastSlowest("tilt", params_.tilt.pulse.slowest_radps(), command.tilt_rate_radps, reply);
}

std::string MaestroPanTilt::connect(const std::stop_token&) {
  std::string why = usb_.open(params_.serial);
  if (!why.empty()) return why;
  const int channels = usb_.model().channels;
  for (const Joint* joint : {&params_.pan, &params_.tilt}) {
    if (joint->channel >= channels) {
      return std::string("a ") + usb_.model().name + " has no channel " + std::to_string(joint->channel) +
             " (they are 0.." + std::to_string(channels - 1) + ")";
    }
  }
  if (why = usb_.transfer(maestro::clearErrors()); !why.empty()) return why;
  if (why = readState(); !why.empty()) return why;
  for (const Joint* joint : {&params_.pan, &params_.tilt}) {
    if (servo(*joint).position_qus != 0) continue;
    why = move(*joint, std::clamp(0.0, joint->minimum_rad, joint->maximum_rad), joint->rate_radps);
    if (!why.empty()) return why;
  }
  return {};
}

void MaestroPanTilt::disconnect(bool halt) {
  if (halt && usb_.isOpen()) {
    // A stop that cannot be sent is not needed: the motion ends at the limits by itself.
    if (stay(params_.pan).empty()) static_cast<void>(stay(params_.tilt));
  }
  usb_.close();
}

std::string MaestroPanTilt::stay(const Joint& joint) {
  if (std::string why = readState(); !why.empty()) return why;
  return usb_.transfer(maestro::setTarget(joint.channel, servo(joint).position_qus));
}

std::string MaestroPanTilt::move(const Joint& joint, double target_rad, double rate_radps) {
  // The speed first, so that the motion never starts at the previous speed.
  if (std::string why = usb_.transfer(maestro::setSpeed(joint.channel, joint.pulse.speed(rate_radps)));
      !why.empty()) {
    return why;
  }
  return usb_.transfer(maestro::setTarget(joint.channel, joint.pulse.target_qus(target_rad)));
}

std::string MaestroPanTilt::obey(const PanTiltCommand& command) {
  const auto send = [&](const Joint& joint, double angle_rad, double rate_radps) -> std::string {
    if (command.kind == PanTiltCommand::Kind::kPosition) {
      return move(joint, angle_rad, rate_radps > 0.0 ? rate_radps : joint.rate_radps);
    }
    if (rate_radps == 0.0) return stay(joint);
    return move(joint, rate_radps > 0.0 ? joint.maximum_rad : joint.minimum_rad, rate_radps);
  };
  std::string why = send(params_.pan, command.pan_rad, command.pan_rate_radps);
  if (why.empty()) why = send(params_.tilt, command.tilt_rad, command.tilt_rate_radps);
  return why;
}

std::string MaestroPanTilt::readState() {
  std::vector<std::uint8_t> answer;
  if (std::string why = usb_.transfer(maestro::getServos(usb_.model()), answer); !why.empty()) return why;
  auto state = maestro::parseServos(usb_.model(), answer);
  if (!state) return "the Maestro's answer is too short";
  state_ = std::move(*state);
  return {};
}

std::string MaestroPanTilt::poll() {
  const StampUs asked_us = hostClock_us();
  if (std::string why = readState(); !why.empty()) return why;
  const int pan_qus = servo(params_.pan).position_qus;
  const int tilt_qus = servo(params_.tilt).position_qus;
  std::ostringstream condition;
  if (pan_qus == 0 || tilt_qus == 0) {
    condition << (pan_qus == 0 ? "the pan" : "the tilt")
              << " servo is switched off (by a script of the Maestro?)";
  } else if (state_.errors != 0) {
    condition << "the Maestro reports errors, bits 0x" << std::hex << state_.errors;
  }
  setCondition(condition.str());
  if (pan_qus != 0 && tilt_qus != 0) {
    give(asked_us, params_.pan.pulse.angle(pan_qus), params_.tilt.pulse.angle(tilt_qus));
  }
  return {};
}

std::unique_ptr<PanTiltUnit> makeMaestroPanTilt(ConfigReader& group) {
  MaestroPanTilt::Params params;
  group.describe({basic("Serial", "number of the Maestro, where there are several; empty: any"),
                  expert("Rate_hz", "samples a second")});
  params.serial = group.text("Serial", "");
  params.rate_hz = group.real("Rate_hz", params.rate_hz, 1.0, 200.0);
  const auto read = [&](const std::string& name, MaestroPanTilt::Joint& joint, int channel,
                        double range_deg) {
    describeAxis(group.group(name));
    group.group(name).describe(
        {basic("Channel", "of the servo"), basic("Centre_us", "length of the pulse at 0"),
         basic("PulsePerDegree_us", "additional length a degree; to be measured, since servos differ")});
    joint.channel = static_cast<int>(group.integer(name + ".Channel", channel, 0, 23));
    joint.minimum_rad = group.angleDeg(name + ".Minimum_deg", -range_deg, -180.0, 180.0);
    joint.maximum_rad = group.angleDeg(name + ".Maximum_deg", range_deg, -180.0, 180.0);
    if (joint.minimum_rad >= joint.maximum_rad) {
      group.problem(name + ".Minimum_deg", "must be less than " + group.key(name + ".Maximum_deg"));
    }
    joint.rate_radps = group.angleDeg(name + ".Rate_degps", 150.0, 1.0, 1000.0);
    joint.pulse.centre_us = group.real(name + ".Centre_us", 1500.0, 500.0, 2500.0);
    joint.pulse.us_per_rad = radToDeg(group.real(name + ".PulsePerDegree_us", 10.0, 0.5, 100.0));
    if (group.boolean(name + ".Inverted", false)) joint.pulse.us_per_rad = -joint.pulse.us_per_rad;
  };
  read("Pan", params.pan, 0, 60.0);
  read("Tilt", params.tilt, 1, 40.0);
  if (params.pan.channel == params.tilt.channel) {
    group.problem("Tilt.Channel", "must be another than " + group.key("Pan.Channel"));
  }
  return std::make_unique<MaestroPanTilt>(params);
}

}  // namespace vismem
