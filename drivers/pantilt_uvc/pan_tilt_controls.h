/// @file The two command sets of cameras with pan-tilt motors.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "common/v4l2/v4l2_device.h"

namespace vismem::uvc {

/// A turn of both axes in the device's own steps.
struct Steps {
  std::int64_t pan = 0;
  std::int64_t tilt = 0;
  bool operator==(const Steps&) const = default;
};

/// Range of one axis, in steps.
struct AxisRange {
  std::int64_t minimum = 0;
  std::int64_t maximum = 0;
  std::int64_t step = 1;
};

/// Turns the camera of an open device. *Single-threaded* (owner: the driver's thread). Strings give the
/// reason of a failure; empty without one.
class PanTiltControls {
 public:
  virtual ~PanTiltControls() = default;
  /// Radians of one step.
  virtual double step_rad() const = 0;
  /// @return whether the device reports the ranges of its axes.
  virtual bool ranges(AxisRange& pan, AxisRange& tilt) const = 0;
  /// Whether the device needs a reset to know its angles; at() is then invalid before.
  virtual bool needsReset() const = 0;
  /// Starts the motion to 0, which takes seconds.
  virtual std::string reset() = 0;
  virtual std::string turnTo(const Steps& target) = 0;
  /// The present position, or the commanded one if the device does not report it.
  virtual std::string at(Steps& now) = 0;
};

/// The standard's absolute controls, in arc seconds.
/// @return nullptr if the device does not have them.
std::unique_ptr<PanTiltControls> makeAbsoluteControls(const V4l2Device& device);

/// Logitech's QuickCam Orbit and Sphere: relative motions in 1/64 degree, and a reset to 0, through an
/// extension unit that is registered with the kernel first. They do not report their position; the steps are
/// counted. Source: the data of uvcdynctrl (logitech.xml); never compared with a real one.
/// @return nullptr if the device does not have them.
std::unique_ptr<PanTiltControls> makeOrbitControls(const V4l2Device& device);

}  // namespace vismem::uvc
