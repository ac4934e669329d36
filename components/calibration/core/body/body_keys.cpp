#include "calibration/core/body/body_keys.h"

#include <cmath>
#include <iomanip>
#include <sstream>

#include "common/geometry/angles.h"

namespace vismem {
namespace {

constexpr const char* kPrefix = "ActiveVisualMemory.";

std::string numbers(const std::vector<double>& values, int digits) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(digits);
  for (std::size_t i = 0; i < values.size(); ++i) text << (i == 0 ? "" : " ") << values[i];
  return text.str();
}

void addMount(const BodyEstimate& estimate, const CameraMount& described, std::vector<KeyValue>& keys) {
  // Without height and tilt nothing of the mounting is worth writing; without a drive the head's place on the
  // robot stays as described.
  const auto& place = estimate.place;
  if (!place[2].sigma || !place[3].sigma || !place[4].sigma) return;
  std::array<double, kBodySize> b = estimate.parameters.body;
  if (!place[0].sigma || !place[1].sigma || !place[5].sigma) {
    const BodyParameters old = nominalBody(described, {}, 1.0);
    for (const BodyIndex i : {kUnitX, kUnitY, kUnitYaw}) b[i] = old.body[i];
  }
  const auto add = [&](const std::string& part, std::size_t position, std::size_t rotation) {
    keys.emplace_back(kPrefix + part + ".Position_m",
                      numbers({b[position], b[position + 1], b[position + 2]}, 4));
    keys.emplace_back(
        kPrefix + part + ".Rotation_deg",
        numbers({radToDeg(b[rotation]), radToDeg(b[rotation + 1]), radToDeg(b[rotation + 2])}, 3));
  };
  add("Mount.PanTilt", kUnitX, kUnitRoll);
  add("Mount.Camera", kCameraX, kCameraRoll);
  keys.emplace_back(std::string(kPrefix) + "Mount.CalibratedTilt_deg",
                    numbers({radToDeg(std::hypot(*place[3].sigma, *place[4].sigma))}, 3));
}

}  // namespace

std::vector<KeyValue> bodyKeys(const BodyEstimate& estimate, const CameraMount& described,
                               double reported_base_m) {
  std::vector<KeyValue> keys;
  addMount(estimate, described, keys);
  const auto add = [&](const char* name, double value, int digits) {
    keys.emplace_back(std::string(kPrefix) + name, numbers({value}, digits));
  };
  const BodyParameters& p = estimate.parameters;
  if (estimate.isObservable(kPanScale)) add("Joints.PanScale", p.body[kPanScale], 5);
  if (estimate.isObservable(kTiltScale)) add("Joints.TiltScale", p.body[kTiltScale], 5);
  if (estimate.isObservable(kJointDelay)) add("Joints.Delay_s", p.body[kJointDelay], 4);
  const auto wheel = [&](WheelIndex i) { return estimate.isObservable(wheelParameter(i)); };
  if (wheel(kLeftScale) && wheel(kRightScale) && wheel(kBase)) {
    add("Wheels.ReportedBase_m", reported_base_m, 5);
    add("Wheels.LeftScale", p.wheels[kLeftScale], 5);
    add("Wheels.RightScale", p.wheels[kRightScale], 5);
    add("Wheels.Base_m", p.wheels[kBase], 5);
  }
  if (wheel(kOdometryDelay)) add("Wheels.Delay_s", p.wheels[kOdometryDelay], 4);
  return keys;
}

}  // namespace vismem
