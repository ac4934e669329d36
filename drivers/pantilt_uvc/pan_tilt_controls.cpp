#include "drivers/pantilt_uvc/pan_tilt_controls.h"

#include <linux/uvcvideo.h>
#include <linux/videodev2.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <numbers>

#include "common/v4l2/v4l2_controls.h"

namespace vismem::uvc {
namespace {

constexpr double kDegree_rad = std::numbers::pi / 180.0;

class Absolute : public PanTiltControls {
 public:
  Absolute(const V4l2Device& device, const V4l2Control& pan, const V4l2Control& tilt)
      : device_(device),
        pan_{pan.minimum, pan.maximum, pan.step},
        tilt_{tilt.minimum, tilt.maximum, tilt.step} {}

  double step_rad() const override { return kDegree_rad / 3600.0; }
  bool ranges(AxisRange& pan, AxisRange& tilt) const override {
    pan = pan_;
    tilt = tilt_;
    return true;
  }
  bool needsReset() const override { return false; }
  std::string reset() override { return turnTo({}); }
  std::string turnTo(const Steps& target) override {
    const int error = writeControls(device_, V4L2_CID_PAN_ABSOLUTE, static_cast<std::int32_t>(target.pan),
                                    V4L2_CID_TILT_ABSOLUTE, static_cast<std::int32_t>(target.tilt));
    return error == 0 ? std::string() : device_.failed("does not turn", error);
  }
  std::string at(Steps& now) override {
    std::int32_t pan = 0;
    std::int32_t tilt = 0;
    int error = readControl(device_, V4L2_CID_PAN_ABSOLUTE, pan);
    if (error == 0) error = readControl(device_, V4L2_CID_TILT_ABSOLUTE, tilt);
    if (error != 0) return device_.failed("does not report its angles", error);
    now = {pan, tilt};
    return {};
  }

 private:
  const V4l2Device& device_;
  const AxisRange pan_;
  const AxisRange tilt_;
};

/// 63610682-5070-49ab-b8cc-b3855e8d2256, Logitech's motors, in the byte order of descriptors.
constexpr std::array<std::uint8_t, 16> kMotors{0x82, 0x06, 0x61, 0x63, 0x70, 0x50, 0xab, 0x49,
                                               0xb8, 0xcc, 0xb3, 0x85, 0x5e, 0x8d, 0x22, 0x56};
constexpr std::uint8_t kRelative = 1;
constexpr std::uint8_t kReset = 2;
constexpr std::int64_t kStepsPerDegree = 64;
/// Above the whole range of the camera; a single command holds 16 bits.
constexpr std::int64_t kMostAtOnce = 100 * kStepsPerDegree;

class Orbit : public PanTiltControls {
 public:
  explicit Orbit(const V4l2Device& device) : device_(device) {}

  double step_rad() const override { return kDegree_rad / kStepsPerDegree; }
  bool ranges(AxisRange&, AxisRange&) const override { return false; }
  bool needsReset() const override { return true; }
  std::string reset() override {
    // One after the other: of two simultaneous resets the camera executes only one.
    int error = writeControl(device_, V4L2_CID_PAN_RESET, 1);
    if (error == 0) error = writeControl(device_, V4L2_CID_TILT_RESET, 1);
    counted_ = {};
    return error == 0 ? std::string() : device_.failed("does not go to its zero", error);
  }
  std::string turnTo(const Steps& target) override {
    const auto part = [](std::int64_t way) { return std::clamp(way, -kMostAtOnce, kMostAtOnce); };
    const Steps way{part(target.pan - counted_.pan), part(target.tilt - counted_.tilt)};
    if (way == Steps{}) return {};
    const int error = writeControls(device_, V4L2_CID_PAN_RELATIVE, static_cast<std::int32_t>(way.pan),
                                    V4L2_CID_TILT_RELATIVE, static_cast<std::int32_t>(way.tilt));
    if (error != 0) return device_.failed("does not turn", error);
    counted_ = {counted_.pan + way.pan, counted_.tilt + way.tilt};
    return {};
  }
  std::string at(Steps& now) override {
    now = counted_;
    // Counting continues for an absent camera.
    return device_.isThere() ? std::string() : device_.failed("was unplugged");
  }

 private:
  const V4l2Device& device_;
  Steps counted_;  ///< from 0, which the last reset went to
};

/// @return 0 or the errno.
int registerExtension(const V4l2Device& device, std::uint32_t id, const char* name, std::uint8_t selector,
                      std::uint8_t bits, std::uint8_t first_bit, bool is_button) {
  uvc_xu_control_mapping mapping{};
  mapping.id = id;
  std::strncpy(reinterpret_cast<char*>(mapping.name), name, sizeof mapping.name - 1);
  std::copy(kMotors.begin(), kMotors.end(), mapping.entity);
  mapping.selector = selector;
  mapping.size = bits;
  mapping.offset = first_bit;
  mapping.v4l2_type = is_button ? V4L2_CTRL_TYPE_BUTTON : V4L2_CTRL_TYPE_INTEGER;
  mapping.data_type = is_button ? UVC_CTRL_DATA_TYPE_UNSIGNED : UVC_CTRL_DATA_TYPE_SIGNED;
  const int error = device.request(UVCIOC_CTRL_MAP, &mapping);
  return error == EEXIST ? 0 : error;
}

}  // namespace

std::unique_ptr<PanTiltControls> makeAbsoluteControls(const V4l2Device& device) {
  const auto pan = findControl(device, V4L2_CID_PAN_ABSOLUTE);
  const auto tilt = findControl(device, V4L2_CID_TILT_ABSOLUTE);
  return pan && tilt ? std::make_unique<Absolute>(device, *pan, *tilt) : nullptr;
}

std::unique_ptr<PanTiltControls> makeOrbitControls(const V4l2Device& device) {
  const bool known =
      registerExtension(device, V4L2_CID_PAN_RELATIVE, "Pan (relative)", kRelative, 16, 0, false) == 0 &&
      registerExtension(device, V4L2_CID_TILT_RELATIVE, "Tilt (relative)", kRelative, 16, 16, false) == 0 &&
      registerExtension(device, V4L2_CID_PAN_RESET, "Pan Reset", kReset, 1, 0, true) == 0 &&
      registerExtension(device, V4L2_CID_TILT_RESET, "Tilt Reset", kReset, 1, 1, true) == 0;
  return known ? std::make_unique<Orbit>(device) : nullptr;
}

}  // namespace vismem::uvc
