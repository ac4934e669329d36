/// @file Two servos on a Pololu Maestro as a pan-tilt unit. SPEC C1.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>

#include "common/config/config_reader.h"
#include "common/drivers/device_thread.h"
#include "common/drivers/sample_buffer.h"
#include "common/robot/ports.h"
#include "drivers/pololu_maestro/maestro_usb.h"

namespace vismem {

/// A thread holds the device: it sends the last command and reads the pulses, `rate_hz` times a second. The
/// angles are those of the pulses, which the Maestro moves at the commanded speed: servos tell nothing back,
/// and a jam is not seen. Servos that are off at the beginning are sent to 0, at which they jump.
/// *Thread-safe*.
class MaestroPanTilt : public PanTiltUnit {
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
  PortReply start() override;
  /// A velocity below the slowest becomes that, or 0, whichever is nearer, which is an adjustment.
  PortReply command(const PanTiltCommand& command) override;
  SampleBatch<PanTiltSample> samplesSince(StampUs after_us, std::chrono::milliseconds timeout) override;
  /// The servos stay where they are, under power.
  void stop() override;

 private:
  std::string session(const std::stop_token& stop);
  std::string connect();
  std::string halt();
  std::string sendCommand(const PanTiltCommand& command);
  std::string move(const Joint& joint, double target_rad, double rate_radps);
  std::string readState();

  const Params params_;

  // Of the thread alone.
  maestro::Usb usb_;
  maestro::State state_;
  std::uint64_t samples_given_ = 0;

  std::mutex mutex_;  ///< of what follows
  std::condition_variable_any commanded_;
  std::optional<PanTiltCommand> command_;

  SampleBuffer<PanTiltSample> samples_;
  DeviceThread thread_;  ///< last: ends before the rest goes
};

/// Reads the keys that drivers/pololu_maestro/README.md documents. Problems stay in the reader.
std::unique_ptr<PanTiltUnit> makeMaestroPanTilt(ConfigReader& group);

}  // namespace vismem
