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
  /// True for yes/no and menu controls. They enable number controls, so they are set first.
  bool is_switch = false;
  bool is_button = false;
};

/// The enabled controls of a device: 32-bit numbers, switches and buttons.
std::vector<V4l2Control> listControls(const V4l2Device& device);
/// @return empty if the device has no control of this id.
std::optional<V4l2Control> findControl(const V4l2Device& device, std::uint32_t id);

/// @return 0 or the errno.
int readControl(const V4l2Device& device, std::uint32_t id, std::int32_t& value);
int writeControl(const V4l2Device& device, std::uint32_t id, std::int32_t value);
/// Writes several controls at once, for devices that move axes together.
int writeControls(const V4l2Device& device, std::uint32_t first, std::int32_t first_value,
                  std::uint32_t second, std::int32_t second_value);

struct ControlSetting {
  std::string name;
  std::int32_t value = 0;
};
/// Sets them, switches before numbers, and reads them back.
/// @return empty, or the first failure: "/dev/video0: no control gian (it has brightness, gain)", "... gain =
/// 300 (must be 0..255)", "... gain cannot be set now (an automatic is on?)", "... gain became 4, not 5".
std::string applyControls(const V4l2Device& device, const std::vector<ControlSetting>& settings);

/// The name of a control in the form of v4l2-ctl: "Exposure Time, Absolute" becomes "exposure_time_absolute".
/// Pure.
std::string controlName(const std::string& title);

}  // namespace vismem
