/// @file A model of a Pololu Maestro by its guide and SDK, for any bus.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace vismem {

/// Pulses move at the set speed, and at once from off and with speed 0. *Thread-safe*.
class MaestroModel {
 public:
  /// @param product 0x0089 is a Micro Maestro 6, 0x008A a Mini Maestro 12.
  explicit MaestroModel(std::uint16_t product = 0x0089, std::string serial = "00012345")
      : product_(product), serial_(std::move(serial)), servos_(product == 0x0089 ? 6U : 12U) {}

  /// Faults: refuses requests of this number (0: none); is silent; reports these error bits; sends half of
  /// the answers.
  void refuse(int request);
  void setSilent(bool silent);
  void setErrors(unsigned bits);
  void setShortAnswers(bool shorter);
  void switchOff(int channel);

  int position_qus(int channel);
  int target_qus(int channel);
  int speed(int channel);
  bool silent();

  struct Transfer {
    int status = 0;  ///< 0 or a negative errno
    std::vector<std::uint8_t> data;
  };
  /// A control transfer: vendor requests, and descriptors as the standard has them.
  Transfer control(const std::array<std::uint8_t, 8>& setup);
  /// The device's and its configuration's, one after the other.
  std::vector<std::uint8_t> descriptors() const;

 protected:
  std::uint16_t product() const { return product_; }

 private:
  using Clock = std::chrono::steady_clock;
  struct Servo {
    double position = 0.0;
    int target = 0;
    int speed = 0;
  };
  void moveLocked();
  bool micro() const { return product_ == 0x0089; }

  const std::uint16_t product_;
  const std::string serial_;
  std::mutex mutex_;
  std::vector<Servo> servos_;
  Clock::time_point moved_until_ = Clock::now();
  int refused_ = 0;
  bool silent_ = false;
  bool short_ = false;
  unsigned errors_ = 0;
};

}  // namespace vismem
