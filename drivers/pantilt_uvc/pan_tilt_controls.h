/// @file The two ways in which cameras that turn by themselves are told where to.
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

/// What one axis can do, in steps.
struct AxisRange {
  std::int64_t minimum = 0;
  std::int64_t maximum = 0;
  std::int64_t step = 1;
};

/// Turns the camera of an open device. *Single-threaded* (owner: the driver's thread). Strings say why it
/// failed; empty if it did not.
class PanTiltControls {
 public:
  virtual ~PanTiltControls() = default;
  /// Radians of one step.
  virtual double step_rad() const = 0;
  /// @return whether the device tells the ranges of its axes.
  virtual bool ranges(AxisRange& pan, AxisRange& tilt) const = 0;
  /// Whether it must be reset to know where it looks; then at() is meaningless before.
  virtual bool needsReset() const = 0;
  /// Begins the way to 0, which takes seconds.
  virtual std::string reset() = 0;
  virtual std::string turnTo(const Steps& target) = 0;
  /// Where it is, or where it was sent if it does not tell.
  virtual std::string at(Steps& now) = 0;
};

/// The standard's absolute controls, in arc seconds. @return nullptr if the device has them not.
std::unique_ptr<PanTiltControls> makeAbsoluteControls(const V4l2Device& device);

/// Logitech's QuickCam Orbit and Sphere: they turn by so many 64ths of a degree, and go to 0 on a reset. Both
/// through an extension unit, which the kernel is told of first. They do not say where they are: it is
/// counted.
/// Source: the data of uvcdynctrl (logitech.xml); never compared with a real one. @return nullptr if the
/// device has them not.
std::unique_ptr<PanTiltControls> makeOrbitControls(const V4l2Device& device);

}  // namespace vismem::uvc
