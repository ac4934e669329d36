/// @file What all pan-tilt units on a bus have in common: a thread that holds the device, obeys the last
/// command and asks for the angles.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>

#include "common/drivers/device_thread.h"
#include "common/drivers/sample_buffer.h"
#include "common/robot/ports.h"

namespace vismem {

/// *Thread-safe*. A driver fills in what is its device's own; the destructor of each calls stop().
class DevicePanTilt : public PanTiltUnit {
 public:
  PortReply start() final;
  PortReply command(const PanTiltCommand& command) final;
  SampleBatch<PanTiltSample> samplesSince(StampUs after_us, std::chrono::milliseconds timeout) final;
  /// The unit stands, and its device is closed.
  void stop() final;

 protected:
  using Clock = std::chrono::steady_clock;

  /// @param rate_hz how often the angles are asked for.
  explicit DevicePanTilt(double rate_hz);

  // All on the thread. Strings say why the device is lost; empty while all is well.

  /// Opens the device and makes it ready for commands. @param stop ends it early.
  virtual std::string connect(const std::stop_token& stop) = 0;
  /// A command within limits().
  virtual std::string obey(const PanTiltCommand& command) = 0;
  /// Reads the angles, and gives them on (give, tell). Once a period, first after connect().
  virtual std::string poll() = 0;
  /// @param halt it shall stand, as far as it can still be told.
  virtual void disconnect(bool halt) = 0;
  /// Waits for a command; wake() ends it.
  virtual std::string pauseUntil(Clock::time_point until, const std::stop_token& stop);

  // On any thread.

  virtual void wake() {}
  /// What the device makes of a velocity, such as one below its slowest; says so in the reply.
  virtual void adjustVelocity(PanTiltCommand&, PortReply&) const {}

  // For the driver, on the thread.

  /// Commands are refused until the connection is made: "the unit finds its zero".
  void refuseBecause(const std::string& why) { thread_.away(why); }
  /// @param asked_us when the angles were asked for: they were measured half-way between that and now.
  void give(StampUs asked_us, double pan_rad, double tilt_rad);
  /// A condition that does not keep it from delivering; empty: none.
  void tell(const std::string& condition) { samples_.setCondition(condition); }

 private:
  std::string session(const std::stop_token& stop);

  const Clock::duration period_;

  // Of the thread.
  std::uint64_t samples_given_ = 0;
  bool is_ready_ = false;               ///< commands are taken
  std::optional<PanTiltSample> first_;  ///< held back until they are: whoever has a sample may command

  std::mutex mutex_;
  std::condition_variable_any commanded_;
  std::optional<PanTiltCommand> command_;

  SampleBuffer<PanTiltSample> samples_;
  DeviceThread thread_;  ///< last: ends before the rest goes
};

}  // namespace vismem
