/// @file A Directed Perception PTU-46 or D46 on a serial line as a pan-tilt unit. See C1.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <stop_token>
#include <string>
#include <vector>

#include "common/config/config_reader.h"
#include "common/drivers/device_pan_tilt.h"
#include "common/robot/ports.h"
#include "common/serial/serial_port.h"
#include "drivers/ptu46/ptu46_codec.h"

namespace vismem {

/// A thread owns the session: it sends the last command and polls the angles, `rate_hz` times a second. A
/// velocity is sent as a motion to the limit in its direction, which units of every age support; it therefore
/// ends at the limits. The stepper motors have no feedback: a jam is not detected, but a reached limit switch
/// is reported as a condition. *Thread-safe*.
class Ptu46Unit : public DevicePanTilt {
 public:
  struct AxisParams {
    double minimum_rad = 0.0, maximum_rad = 0.0, rate_radps = 0.0;
    ptu46::AxisFrame frame;
  };
  struct Params {
    std::string port;
    int baud_bps = 9600;
    AxisParams pan{-2.7, 2.7, 1.7, {}};
    AxisParams tilt{-0.78, 0.52, 1.7, {}};
    double rate_hz = 20.0;
    bool reset = false;  ///< finds its zero at the first connection
  };

  explicit Ptu46Unit(const Params& params);
  ~Ptu46Unit() override;

  /// Limits of the configuration; once the unit was reached, within its own limits.
  PanTiltLimits limits() const override;

 protected:
  std::string connect(const std::stop_token& stop) override;
  std::string obey(const PanTiltCommand& command) override { return unlessOnce(sendCommand(command)); }
  std::string poll() override { return unlessOnce(sample()); }
  void disconnect(bool halt) override;
  std::string pauseUntil(Clock::time_point until, const std::stop_token& stop) override;
  void wake() override { port_.wake(); }
  /// A velocity below the unit's slowest becomes the slowest or 0, whichever is nearer.
  void adjustVelocity(PanTiltCommand& command, PortReply& reply) const override;

 private:
  using Ranges = std::array<ptu46::AxisRange, 2>;

  std::string begin();
  /// Tolerates the loss of one reply.
  /// @return `why`, or empty for the first of several silences.
  std::string unlessOnce(std::string why);
  std::string learnRanges();
  /// Sends commands and waits for one reply each.
  /// @return the reason why the line is lost or silent.
  std::string ask(const std::string& commands, std::chrono::milliseconds patience);
  std::string askNumber(ptu46::Axis axis, char what, double& value);
  std::string sendCommand(const PanTiltCommand& command);
  std::string sample();
  void readUntilQuiet();
  double slowest(const ptu46::AxisRange& range) const {
    return range.step_rad * static_cast<double>(range.slowest);
  }

  const Params params_;

  // Of the thread alone.
  SerialPort port_;
  std::stop_token stop_;  ///< ends a wait for replies
  ptu46::ReplyReader reader_;
  std::vector<ptu46::Reply> replies_;  ///< to the last ask()
  bool reset_done_ = false;
  std::string refused_;  ///< the part of the last command that the unit refused
  std::string limit_hit_;
  int silent_ = 0;  ///< consecutive periods without a reply

  mutable std::mutex mutex_;
  Ranges ranges_;  ///< step_rad 0 before the unit was reached
};

/// Reads the keys that drivers/ptu46/README.md documents. Problems stay in the reader.
std::unique_ptr<PanTiltUnit> makePtu46Unit(ConfigReader& group);

}  // namespace vismem
