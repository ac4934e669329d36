/// @file A USB camera (UVC 1.0, bulk) with pan-tilt motors, in software.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "hwkernel/usb_model.h"

namespace vismem {

/// Gives YUYV pictures of one grey, or one JPEG file again and again, 30 a second. Turns by the standard's
/// absolute control, or as Logitech's Orbit by its extension unit.
class UvcModel : public UsbModel {
 public:
  enum class Motors { kAbsolute, kOrbit };
  static constexpr int kWidth = 160;
  static constexpr int kHeight = 120;
  static constexpr std::uint8_t kGrey = 77;

  /// @param jpeg of kWidth x kHeight.
  UvcModel(Motors motors, std::vector<std::uint8_t> jpeg) : motors_(motors), jpeg_(std::move(jpeg)) {}

  Answer control(const Setup& setup, std::span<const std::uint8_t> data) override;
  std::optional<std::vector<std::uint8_t>> bulkIn(std::size_t most) override;
  bool isHighSpeed() const override { return true; }
  /// "pan tilt resets" [arc seconds, or 64ths of a degree of an Orbit].
  std::string state() override;

 private:
  std::vector<std::uint8_t> deviceDescriptor() const;
  std::vector<std::uint8_t> configuration() const;
  Answer standard(const Setup& setup) const;
  Answer streaming(const Setup& setup, std::span<const std::uint8_t> data);
  Answer entity(const Setup& setup, std::span<const std::uint8_t> data);

  const Motors motors_;
  const std::vector<std::uint8_t> jpeg_;
  std::int32_t pan_ = 0;
  std::int32_t tilt_ = 0;
  int resets_ = 0;
  int format_ = 1;  ///< 1: YUYV, 2: JPEG
  bool toggle_ = false;
  std::vector<std::uint8_t> payload_;  ///< of the picture that is on its way
  std::size_t sent_ = 0;
  Clock::time_point due_{};
};

}  // namespace vismem
