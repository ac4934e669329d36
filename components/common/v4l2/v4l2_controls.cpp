#include "common/v4l2/v4l2_controls.h"

#include <linux/videodev2.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cstring>

#include "common/config/text_format.h"

namespace vismem {
namespace {

std::optional<V4l2Control> usable(const v4l2_queryctrl& found) {
  if ((found.flags & V4L2_CTRL_FLAG_DISABLED) != 0) return std::nullopt;
  V4l2Control control;
  switch (found.type) {
    case V4L2_CTRL_TYPE_INTEGER:
      break;
    case V4L2_CTRL_TYPE_BOOLEAN:
    case V4L2_CTRL_TYPE_MENU:
    case V4L2_CTRL_TYPE_INTEGER_MENU:
      control.is_switch = true;
      break;
    case V4L2_CTRL_TYPE_BUTTON:
      control.is_button = true;
      break;
    default:
      return std::nullopt;
  }
  const char* const title = reinterpret_cast<const char*>(found.name);
  control.id = found.id;
  control.name = controlName({title, strnlen(title, sizeof found.name)});
  control.minimum = found.minimum;
  control.maximum = found.maximum;
  control.step = std::max(1, found.step);
  control.standard = found.default_value;
  return control;
}

std::string namesOf(const std::vector<V4l2Control>& controls) {
  return controls.empty() ? "none" : joined(controls, ", ", &V4l2Control::name);
}

}  // namespace

std::string controlName(const std::string& title) {
  std::string name;
  for (const char c : title) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0) {
      name += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    } else if (!name.empty() && name.back() != '_') {
      name += '_';
    }
  }
  if (!name.empty() && name.back() == '_') name.pop_back();
  return name;
}

std::vector<V4l2Control> listControls(const V4l2Device& device) {
  std::vector<V4l2Control> controls;
  v4l2_queryctrl found{};
  found.id = V4L2_CTRL_FLAG_NEXT_CTRL;
  while (device.request(VIDIOC_QUERYCTRL, &found) == 0) {
    const std::uint32_t id = found.id;
    if (const auto control = usable(found)) controls.push_back(*control);
    found = {};
    found.id = id | V4L2_CTRL_FLAG_NEXT_CTRL;
  }
  return controls;
}

std::optional<V4l2Control> findControl(const V4l2Device& device, std::uint32_t id) {
  v4l2_queryctrl found{};
  found.id = id;
  if (device.request(VIDIOC_QUERYCTRL, &found) != 0) return std::nullopt;
  return usable(found);
}

int readControl(const V4l2Device& device, std::uint32_t id, std::int32_t& value) {
  v4l2_control control{id, 0};
  const int error = device.request(VIDIOC_G_CTRL, &control);
  if (error == 0) value = control.value;
  return error;
}

int writeControl(const V4l2Device& device, std::uint32_t id, std::int32_t value) {
  v4l2_control control{id, value};
  return device.request(VIDIOC_S_CTRL, &control);
}

int writeControls(const V4l2Device& device, std::uint32_t first, std::int32_t first_value,
                  std::uint32_t second, std::int32_t second_value) {
  std::array<v4l2_ext_control, 2> both{};
  both[0].id = first;
  both[0].value = first_value;
  both[1].id = second;
  both[1].value = second_value;
  v4l2_ext_controls request{};
  request.which = V4L2_CTRL_WHICH_CUR_VAL;
  request.count = both.size();
  request.controls = both.data();
  return device.request(VIDIOC_S_EXT_CTRLS, &request);
}

std::string applyControls(const V4l2Device& device, const std::vector<ControlSetting>& settings) {
  if (settings.empty()) return {};
  const std::vector<V4l2Control> all = listControls(device);
  for (const bool switches : {true, false}) {
    for (const auto& [name, value] : settings) {
      const auto control =
          std::find_if(all.begin(), all.end(), [&](const V4l2Control& c) { return c.name == name; });
      if (control == all.end()) return device.failed("no control " + name + " (it has " + namesOf(all) + ")");
      if (control->is_switch != switches) continue;
      const std::string set = name + " = " + std::to_string(value);
      if (!control->is_button && (value < control->minimum || value > control->maximum)) {
        return device.failed(set + " (must be " + std::to_string(control->minimum) + ".." +
                             std::to_string(control->maximum) + ")");
      }
      const int error = writeControl(device, control->id, value);
      if (error == EACCES || error == EBUSY || error == EPERM) {
        return device.failed(name + " cannot be set now (it is read-only, or an automatic is on)");
      }
      if (error != 0) return device.failed(set, error);
      std::int32_t became = value;
      if (!control->is_button && readControl(device, control->id, became) == 0 && became != value) {
        return device.failed(name + " became " + std::to_string(became) + ", not " + std::to_string(value) +
                             " (its step is " + std::to_string(control->step) + ")");
      }
    }
  }
  return {};
}

}  // namespace vismem
