/// @file A camera with pan-tilt motors (UVC) as a pan-tilt unit. See C1.
#pragma once

#include <chrono>
#include <memory>
#include <mutex>
#include <string>

#include "common/config/config_reader.h"
#include "common/drivers/device_pan_tilt.h"
#include "common/robot/ports.h"
#include "common/v4l2/v4l2_device.h"
#include "drivers/pantilt_uvc/pan_tilt_controls.h"

namespace vismem {

/// Such cameras accept positions only and move at a speed of their own. The driver therefore commands
/// intermediate positions at the commanded rate, `rate_hz` times a second. Streaming is possible meanwhile.
/// *Thread-safe*.
class UvcPanTilt : public DevicePanTilt {
 public:
  enum class Kind { kAuto, kAbsolute, kOrbit };
  struct Axis {
    double minimum_rad = 0.0, maximum_rad = 0.0, rate_radps = 0.0;
    double zero_rad = 0.0;  ///< angle of the unit at the device's 0
    double sign = 1.0;      ///< -1 where the device counts to the right, or down
  };
  struct Params {
    std::string device;
    Kind kind = Kind::kAuto;
    Axis pan, tilt;
    double rate_hz = 20.0;
    /// Duration of a reset; the device does not report its end.
    std::chrono::milliseconds reset_takes{4000};
  };

  explicit UvcPanTilt(const Params& params);
  ~UvcPanTilt() override;

  /// Limits of the configuration; once the camera was reached, within its own limits.
  PanTiltLimits limits() const override;

 protected:
  std::string connect(const std::stop_token& stop) override;
  std::string obey(const PanTiltCommand& command) override;
  std::string poll() override;
  /// The camera keeps its position.
  void disconnect(bool halt) override;

 private:
  /// The motion of one axis.
  struct Way {
    double at_rad = 0.0;
    double target_rad = 0.0;
    double rate_radps = 0.0;
    bool rests() const { return at_rad == target_rad; }
    void goOn(double dt_s);
  };
  std::string learnRanges();
  std::string home(const std::stop_token& stop);
  double angle(const Axis& axis, std::int64_t steps) const;
  std::int64_t steps(const Axis& axis, const uvc::AxisRange& range, double angle_rad) const;
  std::string conditionOf(const uvc::Steps& is, Clock::time_point now);

  const Params params_;

  // Of the thread.
  V4l2Device device_;
  std::unique_ptr<uvc::PanTiltControls> controls_;
  uvc::AxisRange pan_range_, tilt_range_;  ///< within the limits
  Way pan_, tilt_;
  uvc::Steps sent_;
  Clock::time_point moved_at_;    ///< the ways
  Clock::time_point arrived_at_;  ///< time when it last moved, or was at its target

  mutable std::mutex mutex_;
  PanTiltLimits limits_;
};

/// Reads the keys that drivers/pantilt_uvc/README.md documents. Problems stay in the reader.
std::unique_ptr<PanTiltUnit> makeUvcPanTilt(ConfigReader& group);

}  // namespace vismem
