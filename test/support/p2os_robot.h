/// @file A Pioneer robot for tests of its driver: the microcontroller by its manual, on a pseudo terminal,
/// with simulated motion.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "drivers/pioneer_p2os/p2os_codec.h"
#include "support/pty_line.h"

namespace vismem {

/// As a real one, it resumes its last speed with *any* packet after its watchdog has stopped it, and
/// interprets the handshake's numbers as commands while a session is open. Its motors are off at first, its
/// session survives a disconnected line, and its position counters have 15 bits. *Thread-safe*.
class P2osRobot {
 public:
  struct Traits {
    std::string subclass = "p2dx";
    int baud_bps = 0;  ///< the only one it understands; 0: any
    std::chrono::milliseconds sip_period{100};
    double watchdog_s = 2.0;
    int reported_watchdog_ms = 2000;
  };
  /// The faults of the robot.
  struct Faults {
    bool silent = false;            ///< receives without answers
    bool deaf = false;              ///< neither receives nor sends
    bool wrong_checksums = false;   ///< of all packets it sends
    bool stubborn_session = false;  ///< it does not close a session
    bool stop_button = false;
    bool left_stalled = false;
    bool right_stalled = false;
    double battery_V = 12.8;
  };
  struct Heard {
    std::chrono::steady_clock::time_point at;
    p2os::Bytes data;
  };

  P2osRobot() : P2osRobot(Traits{}) {}
  explicit P2osRobot(const Traits& traits);
  ~P2osRobot();

  std::string path() const { return line_.path(); }
  void change(const std::function<void(Faults&)>& what);
  void switchMotorsOff();
  void unplug();
  void plugIn();
  void babble(std::span<const std::uint8_t> bytes);
  /// The state after a killed program: an open session at this speed, stopped by the watchdog.
  void leaveOldSession(double speed_mmps);

  double speed_mmps() const;
  double turnRate_degps() const;
  double setSpeed_mmps() const;
  bool sessionOpen() const;
  bool motorsOn() const;
  bool watchdogCame() const;
  /// The highest speed since the last call.
  double fastest_mmps();
  /// All packets so far.
  std::vector<Heard> heard() const;

 private:
  using Clock = std::chrono::steady_clock;

  void run(const std::stop_token& stop);
  void obey(const p2os::Bytes& data);
  void answer(std::span<const std::uint8_t> data);
  void move(double dt_s);
  void sendSip();
  void sendConfig();

  const Traits traits_;
  mutable std::mutex mutex_;
  PtyLine line_;
  p2os::PacketReader reader_;
  Faults faults_;
  std::vector<Heard> heard_;
  int sync_ = 0;  ///< the step of the handshake that is expected; 3: all done
  bool open_ = false;
  bool motors_on_ = false;
  bool watchdog_came_ = false;
  double set_speed_ = 0.0, set_turn_ = 0.0;  ///< [mm/s], [deg/s]
  double speed_ = 0.0, turn_ = 0.0;
  double acceleration_ = 300.0, deceleration_ = 300.0;
  double turn_acceleration_ = 100.0, turn_deceleration_ = 100.0;
  double x_mm_ = 0.0, y_mm_ = 0.0, heading_rad_ = 0.0;
  double fastest_ = 0.0;
  Clock::time_point last_packet_ = Clock::now();
  Clock::time_point next_sip_ = Clock::now();
  std::jthread thread_;
};

}  // namespace vismem
