/// @file A Pioneer robot (P2OS or ARCOS) on a serial line as a mobile base. SPEC C1.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "common/config/config_reader.h"
#include "common/drivers/device_thread.h"
#include "common/drivers/sample_buffer.h"
#include "common/robot/ports.h"
#include "drivers/pioneer_p2os/p2os_link.h"

namespace vismem {

/// A thread holds the session, finds the robot again when it was away, and sends the speeds; a command only
/// leaves it what to send. What makes it safe:
/// - a speed is sent while its command is younger than the watchdog; then the robot is told to stand, again
///   and again until it says that it does, and only then it is kept content with pulses. So a process that
///   was frozen, or a line that was pulled out, never revives an old speed;
/// - motors that went off (stop button, motors button) are switched on only for a command that begins anew:
///   after one of 0, or after a second without any;
/// - stop() returns when the robot stands (or has said nothing for a while).
/// Speeds go out in whole mm/s and whole degrees/s. Stamps are the host's clock when the packet began to
/// arrive. *Thread-safe*.
class PioneerBase : public MobileBase {
 public:
  struct Params {
    std::string port;
    std::vector<int> bauds_bps = {9600, 38400, 19200, 115200, 57600};
    BaseLimits limits{0.5, 1.7453292519943295, 0.2};
    double acceleration_mps2 = 0.5;
    double deceleration_mps2 = 4.0;
    double turn_acceleration_radps2 = 3.5;
    double turn_deceleration_radps2 = 17.5;
    double low_battery_V = 11.5;
    /// Those of the model that the robot names, unless set.
    std::optional<p2os::Scale> scale;
    /// Information comes every 100 ms: so long without it and the robot counts as silent, then as lost.
    std::chrono::milliseconds silent_after{1000};
    std::chrono::milliseconds lost_after{2500};
  };

  explicit PioneerBase(const Params& params);
  ~PioneerBase() override;

  BaseLimits limits() const override { return params_.limits; }
  /// Waits for a robot that is there (a second); adjusted with what is waited for if there is none.
  PortReply start() override;
  PortReply setVelocity(double v_mps, double w_radps) override;
  SampleBatch<OdometrySample> samplesSince(StampUs after_us, std::chrono::milliseconds timeout) override;
  void stop() override;

 private:
  using Clock = std::chrono::steady_clock;
  /// As it goes over the line.
  struct Speeds {
    int v_mmps = 0;
    int w_degps = 0;
    bool operator==(const Speeds&) const = default;
  };
  struct Order {
    Speeds speeds;
    Clock::time_point at;
  };

  /// From the handshake to the loss of the robot, or to its standing after a stop.
  std::string session(const std::stop_token& stop);
  std::string beginSession();
  /// @return why the robot was lost; empty after a stop.
  std::string converse(const std::stop_token& stop);
  void brake();
  void handle(const p2os::Bytes& data);
  void heard(const p2os::Sip& sip, std::size_t bytes);
  void watchMotorsLocked(const p2os::Sip& sip);
  std::string conditionLocked(const p2os::Sip& sip) const;
  /// Sends what is due. @return why the line is lost.
  std::string sendDue();
  Speeds wantedLocked(Clock::time_point now);
  void lost(const std::string& why);

  const Params params_;

  // Of the thread alone.
  p2os::Link link_;
  p2os::Scale scale_;
  p2os::Odometry odometry_;
  Speeds sent_;
  Clock::time_point sent_at_;
  Clock::time_point enabled_at_;
  Clock::time_point heard_at_;
  bool was_lost_ = false;                   ///< since the start
  bool stands_ = false;                     ///< the robot says so, and was told so
  std::optional<p2os::RobotConfig> robot_;  ///< what it told of itself in this session
  std::uint64_t samples_given_ = 0;

  std::mutex mutex_;  ///< of what follows
  std::optional<Order> order_;
  Clock::time_point moved_at_;  ///< of the last command other than 0, refused ones included
  bool motors_on_ = false;
  bool stop_button_ = false;
  bool may_enable_ = true;  ///< commands have begun anew since the motors went off

  SampleBuffer<OdometrySample> samples_;
  DeviceThread thread_;  ///< last: ends before the rest goes
};

/// Reads the keys that drivers/pioneer_p2os/README.md documents. Problems stay in the reader.
std::unique_ptr<MobileBase> makePioneerBase(ConfigReader& group);

}  // namespace vismem
