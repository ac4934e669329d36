/// @file A mobile base without hardware: a simulated differential drive that moves in real time on an empty
/// floor.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>

#include "common/config/config_reader.h"
#include "common/drivers/periodic_thread.h"
#include "common/drivers/sample_buffer.h"
#include "common/kinematics/kinematics.h"
#include "common/robot/ports.h"

namespace vismem {

/// Speeds within limits of speed and acceleration, a watchdog that brakes, wheel odometry with its errors. A
/// thread delivers samples with stamps of CLOCK_REALTIME. The motion follows the steady clock and does not
/// depend on delays of the thread. The base begins at the origin of odom and keeps its pose from stop() to
/// start(). *Thread-safe*.
class SimulatedMobileBase : public MobileBase {
 public:
  struct Params {
    BaseParams motion;
    OdometryErrorParams odometry = noOdometryError();
    std::uint64_t seed = 1;  ///< of the odometry's errors
    double rate_hz = 100.0;  ///< of the samples
  };

  explicit SimulatedMobileBase(const Params& params);
  ~SimulatedMobileBase() override;

  BaseLimits limits() const override { return params_.motion.limits; }
  PortReply start() override;
  PortReply setVelocity(double v_mps, double w_radps) override;
  SampleBatch<OdometrySample> samplesSince(StampUs after_us, std::chrono::milliseconds timeout) override;
  /// Brakes as the watchdog does and returns when it stands; the last sample has speed 0.
  void stop() override;

 private:
  using Clock = std::chrono::steady_clock;

  void round();
  void moveLocked();
  /// Time up to which the base has moved, in its own clock.
  StampUs nowLocked_us() const;
  void giveSampleLocked();

  const Params params_;
  std::mutex mutex_;
  SimulatedBase base_;
  SimulatedOdometry odometry_;
  const Clock::time_point made_ = Clock::now();
  Clock::time_point moved_until_ = made_;
  bool running_ = false;
  bool braking_ = false;  ///< for stop(): accepts no more commands
  std::uint64_t samples_given_ = 0;
  SampleBuffer<OdometrySample> samples_;
  PeriodicThread thread_;  ///< last member: joined before the others are destroyed
};

/// Reads Rate_hz, Seed, and the keys of readBaseParams and (group Odometry) readOdometryErrorParams. Problems
/// stay in the reader.
std::unique_ptr<MobileBase> makeSimulatedMobileBase(ConfigReader& group);

}  // namespace vismem
