/// @file A pan-tilt unit over Ice: the servant of a PanTiltUnit, and a client that implements PanTiltUnit.
/// JdeRobot's operations use degrees; only this file converts them. See C4.
#pragma once

#include <avm/pantilt.h>

#include <Eigen/Core>
#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "common/robot/ports.h"
#include "common/robot_ice/lease_ice.h"
#include "common/robot_ice/remote.h"
#include "common/robot_ice/sample_broadcaster.h"

namespace vismem {

avm::PanTiltSample toIce(const PanTiltSample& sample);
PanTiltSample fromIce(const avm::PanTiltSample& sample);
avm::PanTiltLimits toIce(const PanTiltLimits& limits);
PanTiltLimits fromIce(const avm::PanTiltLimits& limits);

/// Serves avm::PanTilt and with it jderobot::PTMotors, PTEncoders, Pose3DMotors, Pose3DEncoders and the
/// lease. *Thread-safe* for a unit that accepts commands while samplesSince waits; commands exclude each
/// other here. The unit must be started and outlive stop() and the adapter.
class PanTiltServant : public LeasedServant<avm::PanTilt> {
 public:
  using Samples = SampleBroadcaster<PanTiltSample>;

  /// @param p_robot crossing point of the axes on the robot [m], reported to clients of Pose3DMotors and
  /// Pose3DEncoders.
  /// @param now is replaced in tests only.
  explicit PanTiltServant(PanTiltUnit& unit, const Eigen::Vector3d& p_robot = Eigen::Vector3d::Zero(),
                          LeaseGuard::Now now = std::chrono::steady_clock::now);

  /// Starts and stops the polling of the unit; stop answers all waiting requests.
  /// @param report called with each answer of the unit.
  void start(Samples::Report report = {}) { samples_.start(std::move(report)); }
  void stop() { samples_.stop(); }

  avm::PanTiltLimits getLimits(const Ice::Current&) override;
  avm::CommandReply moveTo(avm::PanTiltAngles goal, double pan_rate_radps, double tilt_rate_radps,
                           const Ice::Current&) override;
  avm::CommandReply setRates(double pan_rate_radps, double tilt_rate_radps, const Ice::Current&) override;
  avm::PanTiltStatus getPanTiltStatus(const Ice::Current&) override;
  void samplesSinceAsync(Ice::Long after_us, std::function<void(const avm::PanTiltBatch&)> response,
                         std::function<void(std::exception_ptr)> exception, const Ice::Current&) override;

  // JdeRobot declares no failure for reading: before the first sample Ice::UnknownException is thrown.
  int setPTMotorsData(std::shared_ptr<jderobot::PTMotorsData> data, const Ice::Current&) override;
  std::shared_ptr<jderobot::PTMotorsParams> getPTMotorsParams(const Ice::Current&) override;
  std::shared_ptr<jderobot::PTEncodersData> getPTEncodersData(const Ice::Current&) override;
  /// Executes pan and tilt; x, y, z and roll must be finite and are ignored.
  int setPose3DMotorsData(std::shared_ptr<jderobot::Pose3DMotorsData> data, const Ice::Current&) override;
  /// The present position command with its maximum rates; without one, the measured angles.
  std::shared_ptr<jderobot::Pose3DMotorsData> getPose3DMotorsData(const Ice::Current&) override;
  std::shared_ptr<jderobot::Pose3DMotorsParams> getPose3DMotorsParams(const Ice::Current&) override;
  std::shared_ptr<jderobot::Pose3DEncodersData> getPose3DEncodersData(const Ice::Current&) override;

 protected:
  void endMotion() override;

 private:
  /// Follows a command of a caller whose lease allows it. @throws avm::LeaseRefused.
  avm::CommandReply follow(const PanTiltCommand& command, const Ice::Current& current);
  PortReply commandLocked(const PanTiltCommand& command);
  /// A position in JdeRobot's degrees.
  /// @return 0 when taken, -1 when refused.
  int moveToDegrees(double pan_deg, double tilt_deg, double pan_bound_degps, double tilt_bound_degps,
                    const Ice::Current& current);
  PanTiltSample newestSample() const;

  PanTiltUnit& unit_;
  const Eigen::Vector3d p_robot_;
  std::mutex commands_;
  std::optional<PanTiltCommand> position_;  ///< the present position command, within the limits
  vismem::PanTilt last_goal_;
  bool turning_ = false;  ///< the last command was a velocity other than 0
  Samples samples_;
};

/// A remote pan-tilt unit as a port. Commands block for at most a second; a peer that is away gives kWaiting
/// and kRejected with the reason. *Thread-safe.*
class RemotePanTiltUnit : public PanTiltUnit {
 public:
  explicit RemotePanTiltUnit(const std::shared_ptr<avm::PanTiltPrx>& proxy, LinkReport report = {});

  /// The last limits from the server; all zero before it was reached. Never blocks.
  PanTiltLimits limits() const override;
  /// Waits up to a second for the server; accepted even without it.
  PortReply start() override;
  PortReply command(const PanTiltCommand& command) override;
  SampleBatch<PanTiltSample> samplesSince(StampUs after_us, std::chrono::milliseconds timeout) override;
  /// Stops the unit if this client's last command was a velocity; commands of other clients stay in effect.
  void stop() override;

 private:
  std::shared_ptr<avm::PanTiltPrx> proxy_;
  std::shared_ptr<avm::PanTiltPrx> commands_;
  PendingCall<avm::PanTiltBatch> samples_;
  mutable AskedValue<avm::PanTiltLimits> limits_;
  std::atomic<bool> turning_ = false;  ///< by this client's last command
};

}  // namespace vismem
