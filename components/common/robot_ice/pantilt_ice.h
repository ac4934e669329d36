/// @file A pan-tilt unit over Ice: the servant over any PanTiltUnit, and the client, which is one again.
/// JdeRobot's operations speak degrees; they are converted here and nowhere else. SPEC C4.
#pragma once

#include <avm/pantilt.h>

#include <Eigen/Core>
#include <atomic>
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

/// avm::PanTilt and with it jderobot::PTMotors, PTEncoders, Pose3DMotors and Pose3DEncoders. *Thread-safe*
/// over a unit that takes commands while samplesSince waits; commands exclude each other here. The unit must
/// be started and outlive stop() and the adapter.
class PanTiltServant : public avm::PanTilt {
 public:
  using Samples = SampleBroadcaster<PanTiltSample>;

  /// @param p_robot where the axes cross on the robot [m]; told to clients of Pose3DMotors and
  /// Pose3DEncoders.
  explicit PanTiltServant(PanTiltUnit& unit, const Eigen::Vector3d& p_robot = Eigen::Vector3d::Zero());

  /// Begins and ends the polling of the unit; stop answers all waiting requests.
  /// @param report is told of each answer of the unit.
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
  /// Follows pan and tilt; x, y, z and roll must be finite, no more.
  int setPose3DMotorsData(std::shared_ptr<jderobot::Pose3DMotorsData> data, const Ice::Current&) override;
  /// The position command that is followed, with its bounds of the rates; where there is none, the angles as
  /// measured.
  std::shared_ptr<jderobot::Pose3DMotorsData> getPose3DMotorsData(const Ice::Current&) override;
  std::shared_ptr<jderobot::Pose3DMotorsParams> getPose3DMotorsParams(const Ice::Current&) override;
  std::shared_ptr<jderobot::Pose3DEncodersData> getPose3DEncodersData(const Ice::Current&) override;

 private:
  PortReply command(const PanTiltCommand& command);
  /// A position in JdeRobot's degrees. @return 0 when taken, -1 when refused.
  int moveToDegrees(double pan_deg, double tilt_deg, double pan_bound_degps, double tilt_bound_degps);
  PanTiltSample newestSample() const;

  PanTiltUnit& unit_;
  const Eigen::Vector3d p_robot_;
  std::mutex commands_;
  std::optional<PanTiltCommand> position_;  ///< the position command that is followed, within the limits
  vismem::PanTilt last_goal_;
  Samples samples_;
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
  /// The unit stands if this client's last command was a velocity; whoever else commands it is not disturbed.
  void stop() override;

 private:
  std::string askLimits(std::chrono::milliseconds timeout) const;

  std::shared_ptr<avm::PanTiltPrx> proxy_;
  std::shared_ptr<avm::PanTiltPrx> commands_;
  PendingCall<avm::PanTiltBatch> samples_;
  mutable PendingCall<avm::PanTiltLimits> asked_limits_;
  mutable std::mutex mutex_;
  mutable std::optional<PanTiltLimits> limits_;
  std::atomic<bool> turning_ = false;  ///< by this client's last command
};

}  // namespace vismem
