/// @file The USB requests of Pololu's Maestro servo controllers and their answers. Pure.
/// All are vendor requests to the device itself, so no interface is claimed. Source: Pololu's USB SDK
/// (protocol.h, Usc.cs) and the Maestro user's guide.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace vismem::maestro {

constexpr std::uint16_t kVendor = 0x1FFB;

struct Model {
  std::uint16_t product = 0;
  const char* name = "";
  int channels = 0;
  bool micro = false;
};
/// @return nullptr if the ids are not those of a Maestro.
const Model* modelOf(std::uint16_t vendor, std::uint16_t product);

/// A control transfer to or from the device; `length` bytes are read, none are written.
struct Request {
  std::uint8_t type = 0;
  std::uint8_t request = 0;
  std::uint16_t value = 0;
  std::uint16_t index = 0;
  std::uint16_t length = 0;
};

/// Commands a pulse length [quarter microseconds]; 0 switches the servo off.
Request setTarget(int channel, int target_qus);
/// @param speed [25 us/s], 1..16383; 0: the servo's maximum.
Request setSpeed(int channel, int speed);
/// The state of all servos.
Request getServos(const Model& model);
Request clearErrors();

struct Servo {
  int position_qus = 0;  ///< of the pulse now; 0: off
  int target_qus = 0;
  int speed = 0;
};
struct State {
  std::vector<Servo> servos;
  unsigned errors = 0;  ///< bits; reported by a Micro Maestro only
};
/// @return empty if the answer to getServos is too short.
std::optional<State> parseServos(const Model& model, std::span<const std::uint8_t> bytes);

/// One unit of speed [us/s].
constexpr double kSpeedUnit_usps = 25.0;
constexpr int kFastest = 16383;

/// Conversion of a pulse length to the angle of its joint.
struct Pulse {
  double centre_us = 1500.0;
  double us_per_rad = 0.0;  ///< negative where a longer pulse turns right, or down

  double angle(int position_qus) const { return (0.25 * position_qus - centre_us) / us_per_rad; }
  int target_qus(double angle_rad) const;
  /// The nearest speed in units of kSpeedUnit_usps, at least 1.
  int speed(double rate_radps) const;
  double slowest_radps() const { return kSpeedUnit_usps / (us_per_rad < 0 ? -us_per_rad : us_per_rad); }
};

}  // namespace vismem::maestro
