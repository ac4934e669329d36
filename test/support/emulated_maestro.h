/// @file A Pololu Maestro for tests of its driver: what its guide says it does, on umockdev's USB. A test
/// that uses it is declared with EMULATED_DEVICES.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace vismem {

/// Pulses move at the set speed, and at once from off and with speed 0. *Thread-safe*.
class EmulatedMaestro {
 public:
  /// @param product 0x0089 is a Micro Maestro 6, 0x008A a Mini Maestro 12. Plugged in.
  /// @param number of its USB port, from 1; each only once.
  explicit EmulatedMaestro(std::uint16_t product = 0x0089, const std::string& serial = "00012345",
                           int number = 1);
  ~EmulatedMaestro();

  void unplug();
  void plugIn();
  /// It refuses requests of this number (0: none); says nothing; reports these error bits; answers in half.
  void refuse(int request);
  void setSilent(bool silent);
  void setErrors(unsigned bits);
  void setShortAnswers(bool shorter);
  void switchOff(int channel);

  int position_qus(int channel);
  int target_qus(int channel);
  int speed(int channel);

  /// What its device node does; for the emulation.
  struct Transfer {
    int status = 0;  ///< 0 or a negative errno
    std::vector<std::uint8_t> data;
  };
  Transfer control(const std::array<std::uint8_t, 8>& setup);
  bool silent();

 private:
  using Clock = std::chrono::steady_clock;
  struct Servo {
    double position = 0.0;
    int target = 0;
    int speed = 0;
  };
  struct Node;

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
  std::unique_ptr<Node> node_;
};

}  // namespace vismem
