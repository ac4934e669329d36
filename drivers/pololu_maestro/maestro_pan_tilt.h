/// @file Two servos on a Pololu Maestro as a pan-tilt unit. See C1.
#pragma once

#include <cstdint>
#include <memory>
#include <stop_token>
#include <string>

#include "common/config/config_reader.h"
#include "common/drivers/device_pan_tilt.h"
#include "common/robot/ports.h"
#include "drivers/pololu_maestro/maestro_usb.h"

namespace vismem {

/// A thread owns the device: it sends the last command and reads the pulses, `rate_hz` times a second. The
/// angles are those of the pulses, which the Maestro moves at the commanded speed. Servos have no feedback,
/// so a jam is not detected. Servos that are off at the beginning jump to 0. *Thread-safe*.
class MaestroPanTilt : public DevicePanTilt {
 public:
  struct Joint {
    int channel = 0;
    double minimum_rad = 0.0, maximum_rad = 0.0, rate_radps = 0.0;
    maestro::Pulse pulse;
  };
  struct Params {
    std::string serial;  ///< of the device; empty: the only one
    Joint pan, tilt;
    double rate_hz = 50.0;
  };

  explicit MaestroPanTilt(const Params& params);
  ~MaestroPanTilt() override;

  PanTiltLimits limits() const override;

 protected:
  std::string connect(const std::stop_token& stop) override;
  std::string obey(const PanTiltCommand& command) override;
  std::string poll() override;
  /// The servos keep their position under power.
  void disconnect(bool halt) override;
  /// A velocity below the slowest becomes the slowest or 0, whichever is nearer.
  void adjustVelocity(PanTiltCommand& command, PortReply& reply) const override;

 private:
  std::string readState();
  std::string move(const Joint& joint, double target_rad, double rate_radps);
  /// Stops a joint at its present pulse.
  std::string stay(const Joint& joint);
  const maestro::Servo& servo(const Joint& joint) const {
    return state_.servos[static_cast<std::size_t>(joint.channel)];
  }

  const Params params_;
  maestro::Usb usb_;      ///< of the thread
  maestro::State state_;  ///< of the thread
};

/// Reads the keys that drivers/pololu_maestro/README.md documents. Problems stay in the reader.
std::unique_ptr<PanTiltUnit> makeMaestroPanTilt(ConfigReader& group);

}  // namespace vismem
