/// @file A Pioneer robot (P2OS or ARCOS) on a serial line as a mobile base. See C1.
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

/// A thread owns the session, reconnects after a loss of the robot, and sends the speeds of the last command.
/// Safety rules:
/// - a speed is sent while its command is younger than the watchdog. Then stop commands are repeated until
///   the robot reports that it stands; only then pulses keep its watchdog reset. A frozen process or a
///   disconnected line therefore never resumes an old speed;
/// - motors that went off (stop button, motors button) are switched on only after a command of 0, or after a
///   second without commands;
/// - stop() returns when the robot stands, or after a time without packets.
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
    /// Unit scales; empty: those of the model that the robot reports.
    std::optional<p2os::Scale> scale;
    /// The robot sends its state every 100 ms. After this time without it the robot counts as silent, later
    /// as lost.
    std::chrono::milliseconds silent_after{1000};
    std::chrono::milliseconds lost_after{2500};
  };

  explicit PioneerBase(const Params& params);
  ~PioneerBase() override;

  BaseLimits limits() const override { return params_.limits; }
  /// Waits 1 s for the robot; adjusted with the reason if it is absent.
  PortReply start() override;
  PortReply setVelocity(double v_mps, double w_radps) override;
  SampleBatch<OdometrySample> samplesSince(StampUs after_us, std::chrono::milliseconds timeout) override;
  void stop() override;

 private:
  using Clock = std::chrono::steady_clock;
  /// Speeds in the units of the line.
  struct Speeds {
    int v_mmps = 0;
    int w_degps = 0;
    bool operator==(const Speeds&) const = default;
  };
  struct Order {
    Speeds speeds;
    Clock::time_point at;
  };

  /// From the handshake to the loss of the robot, or to its standstill after a stop.
  std::string session(const std::stop_token& stop);
  std::string beginSession();
  /// @return why the robot was lost; empty after a stop.
  std::string converse(const std::stop_token& stop);
  void brake();
  void handle(const p2os::Bytes& data);
  void heard(const p2os::Sip& sip, std::size_t bytes);
  void watchMotorsLocked(const p2os::Sip& sip);
  std::string conditionLocked(const p2os::Sip& sip) const;
  /// Sends all due packets.
  /// @return the reason why the line is lost.
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
  bool stands_ = false;                     ///< commanded and reported by the robot
  std::optional<p2os::RobotConfig> robot_;  ///< its settings in this session
  std::uint64_t samples_given_ = 0;

  std::mutex mutex_;  ///< of what follows
  std::optional<Order> order_;
  Clock::time_point moved_at_;  ///< of the last command other than 0, refused ones included
  bool motors_on_ = false;
  bool stop_button_ = false;
  bool may_enable_ = true;  ///< a pause or a command of 0 has followed since the motors went off

  SampleBuffer<OdometrySample> samples_;
  DeviceThread thread_;  ///< last member: joined before the others are destroyed
};

/// Reads the keys that drivers/pioneer_p2os/README.md documents. Problems stay in the reader.
std::unique_ptr<MobileBase> makePioneerBase(ConfigReader& group);

}  // namespace vismem
