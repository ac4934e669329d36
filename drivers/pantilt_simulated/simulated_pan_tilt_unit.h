/// @file A pan-tilt unit without hardware: simulated joints that turn in real time.
#pragma once

#include <chrono>
#include <memory>
#include <mutex>

#include "common/config/config_reader.h"
#include "common/drivers/periodic_thread.h"
#include "common/drivers/sample_buffer.h"
#include "common/kinematics/kinematics.h"
#include "common/robot/ports.h"

namespace vismem {

/// Two joints with limits of angle, rate and acceleration; the angles are exact. A thread delivers samples
/// with stamps of CLOCK_REALTIME. The motion follows the steady clock and does not depend on delays of the
/// thread. The unit begins at 0, 0 and keeps its angles from stop() to start(). *Thread-safe*.
class SimulatedPanTiltUnit : public PanTiltUnit {
 public:
  struct Params {
    PanTiltParams motion;
    double rate_hz = 100.0;  ///< of the samples
  };

  explicit SimulatedPanTiltUnit(const Params& params);
  ~SimulatedPanTiltUnit() override;

  PanTiltLimits limits() const override { return params_.motion.limits; }
  PortReply start() override;
  PortReply command(const PanTiltCommand& command) override;
  SampleBatch<PanTiltSample> samplesSince(StampUs after_us, std::chrono::milliseconds timeout) override;
  /// Stops the joints at once.
  void stop() override;

 private:
  using Clock = std::chrono::steady_clock;

  void round();
  void moveLocked();

  const Params params_;
  std::mutex mutex_;
  SimulatedPanTilt joints_;
  Clock::time_point moved_until_;
  bool running_ = false;
  std::uint64_t samples_given_ = 0;
  SampleBuffer<PanTiltSample> samples_;
  PeriodicThread thread_;  ///< last member: joined before the others are destroyed
};

/// Reads Rate_hz and the keys of readPanTiltParams. Problems stay in the reader.
std::unique_ptr<PanTiltUnit> makeSimulatedPanTiltUnit(ConfigReader& group);

}  // namespace vismem
