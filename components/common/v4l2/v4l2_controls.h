/// @file The settings of a video device: exposure, gain, focus, pan, tilt ...
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/v4l2/v4l2_device.h"

namespace vismem {

struct V4l2Control {
  std::uint32_t id = 0;
  std::string name;  ///< as v4l2-ctl writes it: "exposure_time_absolute"
  std::int32_t minimum = 0;
  std::int32_t maximum = 0;
  std::int32_t step = 1;
  std::int32_t standard = 0;  ///< the device's own default
  /// Switches (yes or no, one of a list) decide whether numbers may be set, so they come first.
  bool is_switch = false;
  bool is_button = false;
};

/// Those that hold a number of 32 bits, a switch or a button and are not disabled.
std::vector<V4l2Control> listControls(const V4l2Device& device);
/// @return empty if it has none of this number.
std::optional<V4l2Control> findControl(const V4l2Device& device, std::uint32_t id);

/// @return 0 or the errno.
int readControl(const V4l2Device& device, std::uint32_t id, std::int32_t& value);
int writeControl(const V4l2Device& device, std::uint32_t id, std::int32_t value);
/// Both at once, where the device moves both together.
int writeControls(const V4l2Device& device, std::uint32_t first, std::int32_t first_value,
                  std::uint32_t second, std::int32_t second_value);

struct ControlSetting {
  std::string name;
  std::int32_t value = 0;
};
/// Sets them, switches before numbers, and reads them back.
/// @return empty, or the first that cannot be: "/dev/video0: no control gian (it has brightness, gain)", "...
/// gain = 300 (must be 0..255)", "... gain cannot be set now (an automatic is on?)", "... gain became 4, not
/// 5".
std::string applyControls(const V4l2Device& device, const std::vector<ControlSetting>& settings);

/// What V4L2 calls it as v4l2-ctl writes it: "Exposure Time, Absolute" is "exposure_time_absolute". Pure.
std::string controlName(const std::string& title);

}  // namespace vismem
