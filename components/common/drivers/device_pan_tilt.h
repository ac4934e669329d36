/// @file Base class of pan-tilt units on a bus: a thread owns the device, executes the last command and polls
/// the angles.
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

/// *Thread-safe*. A driver implements the operations of its device; its destructor calls stop().
class DevicePanTilt : public PanTiltUnit {
 public:
  PortReply start() final;
  PortReply command(const PanTiltCommand& command) final;
  SampleBatch<PanTiltSample> samplesSince(StampUs after_us, std::chrono::milliseconds timeout) final;
  /// Stops the unit and closes its device.
  void stop() final;

 protected:
  using Clock = std::chrono::steady_clock;

  /// @param rate_hz rate of polling the angles [Hz].
  explicit DevicePanTilt(double rate_hz);

  // Called on the thread. Strings give the reason why the device is lost; empty without a failure.

  /// Opens the device and makes it ready for commands.
  /// @param stop ends it early.
  virtual std::string connect(const std::stop_token& stop) = 0;
  /// A command within limits().
  virtual std::string obey(const PanTiltCommand& command) = 0;
  /// Reads the angles and publishes them (give, setCondition). Once a period, first after connect().
  virtual std::string poll() = 0;
  /// @param halt stop the unit, as far as it still receives commands.
  virtual void disconnect(bool halt) = 0;
  /// Waits for a command; wake() ends it.
  virtual std::string pauseUntil(Clock::time_point until, const std::stop_token& stop);

  // On any thread.

  virtual void wake() {}
  /// Changes a velocity to one that the device can execute; the reply reports the change.
  virtual void adjustVelocity(PanTiltCommand&, PortReply&) const {}

  // For the driver, on the thread.

  /// Commands are refused until the connection is made: "the unit finds its zero".
  void refuseBecause(const std::string& why) { thread_.away(why); }
  /// @param asked_us time of the request [us]; the stamp is half-way between it and now.
  void give(StampUs asked_us, double pan_rad, double tilt_rad);
  /// Condition of a unit that still delivers angles; empty: none.
  void setCondition(const std::string& condition) { samples_.setCondition(condition); }

 private:
  std::string session(const std::stop_token& stop);

  const Clock::duration period_;

  // Of the thread.
  std::uint64_t samples_given_ = 0;
  bool is_ready_ = false;  ///< commands are accepted
  std::optional<PanTiltSample>
      first_;  ///< held back until then: a published sample means that commands are accepted

  std::mutex mutex_;
  std::condition_variable_any commanded_;
  std::optional<PanTiltCommand> command_;

  SampleBuffer<PanTiltSample> samples_;
  DeviceThread thread_;  ///< last member: joined before the others are destroyed
};

}  // namespace vismem
