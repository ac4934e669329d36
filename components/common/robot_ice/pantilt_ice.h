/// @file A pan-tilt unit over Ice: the servant over any PanTiltUnit, and the client, which is one again.
/// JdeRobot's operations speak degrees; they are converted here and nowhere else. SPEC C4.
#pragma once

#include <avm/pantilt.h>

#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "common/robot/ports.h"
#include "common/robot_ice/remote.h"
#include "common/robot_ice/sample_broadcaster.h"

namespace vismem {

avm::PanTiltSample toIce(const PanTiltSample& sample);
PanTiltSample fromIce(const avm::PanTiltSample& sample);
avm::PanTiltLimits toIce(const PanTiltLimits& limits);
PanTiltLimits fromIce(const avm::PanTiltLimits& limits);

/// avm::PanTilt and with it jderobot::PTMotors and PTEncoders. *Thread-safe* over a unit that takes commands
/// while samplesSince waits; commands exclude each other here. The unit must be started and outlive stop()
/// and the adapter.
class PanTiltServant : public avm::PanTilt {
 public:
  explicit PanTiltServant(PanTiltUnit& unit);

  /// Begins and ends the polling of the unit; stop answers all waiting requests.
  void start() { samples_.start(); }
  void stop() { samples_.stop(); }

  avm::PanTiltLimits getLimits(const Ice::Current&) override;
  avm::CommandReply moveTo(avm::PanTiltAngles goal, double pan_rate_radps, double tilt_rate_radps,
                           const Ice::Current&) override;
  avm::CommandReply setRates(double pan_rate_radps, double tilt_rate_radps, const Ice::Current&) override;
  avm::PanTiltStatus getPanTiltStatus(const Ice::Current&) override;
  void samplesSinceAsync(Ice::Long after_us, std::function<void(const avm::PanTiltBatch&)> response,
                         std::function<void(std::exception_ptr)> exception, const Ice::Current&) override;

  int setPTMotorsData(std::shared_ptr<jderobot::PTMotorsData> data, const Ice::Current&) override;
  std::shared_ptr<jderobot::PTMotorsParams> getPTMotorsParams(const Ice::Current&) override;
  /// Throws Ice::UnknownException before the first sample: JdeRobot declares no failure here.
  std::shared_ptr<jderobot::PTEncodersData> getPTEncodersData(const Ice::Current&) override;

 private:
  PortReply command(const PanTiltCommand& command);

  PanTiltUnit& unit_;
  std::mutex commands_;
  std::optional<vismem::PanTilt> goal_;  ///< of the position command being followed
  vismem::PanTilt last_goal_;
  SampleBroadcaster<PanTiltSample> samples_;
};

/// A remote pan-tilt unit as a port. Commands block for at most a second; a peer that is away gives kWaiting
/// and kRejected with the reason. *Thread-safe.*
class RemotePanTiltUnit : public PanTiltUnit {
 public:
  explicit RemotePanTiltUnit(const std::shared_ptr<avm::PanTiltPrx>& proxy, LinkReport report = {});

  /// As the server said last; all zero before it was reached. Never blocks.
  PanTiltLimits limits() const override;
  /// Waits up to a second for the server; accepted even without it.
  PortReply start() override;
  PortReply command(const PanTiltCommand& command) override;
  SampleBatch<PanTiltSample> samplesSince(StampUs after_us, std::chrono::milliseconds timeout) override;
  void stop() override {}

 private:
  std::string askLimits(std::chrono::milliseconds timeout) const;

  std::shared_ptr<avm::PanTiltPrx> proxy_;
  std::shared_ptr<avm::PanTiltPrx> commands_;
  PendingCall<avm::PanTiltBatch> samples_;
  mutable PendingCall<avm::PanTiltLimits> asked_limits_;
  mutable std::mutex mutex_;
  mutable std::optional<PanTiltLimits> limits_;
};

}  // namespace vismem
