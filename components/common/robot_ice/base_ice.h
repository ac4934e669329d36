/// @file A mobile base over Ice: servants of a MobileBase, and a client that implements MobileBase.
/// JdeRobot's Encoders use millimetres and degrees; only this file converts them. See C4.
#pragma once

#include <avm/base.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "common/robot/ports.h"
#include "common/robot_ice/lease_ice.h"
#include "common/robot_ice/remote.h"
#include "common/robot_ice/sample_broadcaster.h"

namespace vismem {

avm::OdometrySample toIce(const OdometrySample& sample);
OdometrySample fromIce(const avm::OdometrySample& sample);
avm::BaseLimits toIce(const BaseLimits& limits);
BaseLimits fromIce(const avm::BaseLimits& limits);
/// Millimetres; degrees in [0, 360).
jderobot::EncodersData toEncoders(const Pose2& T_odom_robot);

/// Serves avm::Base and with it jderobot::Motors and the lease. *Thread-safe* for a base that accepts
/// commands while samplesSince waits; commands exclude each other here. The base must be started and outlive
/// the adapter.
class BaseServant : public LeasedServant<avm::Base> {
 public:
  using Now = LeaseGuard::Now;

  /// @param now is replaced in tests only.
  explicit BaseServant(MobileBase& base, Now now = std::chrono::steady_clock::now)
      : LeasedServant(now), base_(base), now_(std::move(now)) {}

  /// Brings later commands to lower speeds than the base's own limits. *Thread-safe.*
  /// @param speed_mps, turn_rate_radps >= 0.
  void limitSpeed(double speed_mps);
  void limitTurnRate(double turn_rate_radps);

  /// The base's, or those set here where they are lower.
  avm::BaseLimits getLimits(const Ice::Current&) override;
  avm::CommandReply setVelocity(double v_mps, double w_radps, const Ice::Current&) override;
  avm::CommandReply stop(const Ice::Current&) override;

  /// The commanded speed within the limits; 0 once the watchdog has stopped the base.
  float getV(const Ice::Current&) override;
  float getW(const Ice::Current&) override;
  float getL(const Ice::Current&) override { return 0.0F; }
  /// Sets one speed; the other keeps its commanded value.
  int setV(float v, const Ice::Current&) override;
  int setW(float w, const Ice::Current&) override;
  /// Only 0: the base cannot move sideways.
  int setL(float l, const Ice::Current&) override { return l == 0.0F ? 0 : -1; }

 protected:
  void endMotion() override;

 private:
  struct Speeds {
    double v_mps = 0.0;
    double w_radps = 0.0;
  };
  BaseLimits limits() const;
  /// How long a speed holds: the base's watchdog.
  CommandLease::Duration commandTime() const;
  Speeds commanded() const;
  PortReply commandLocked(Speeds speeds);

  MobileBase& base_;
  Now now_;
  mutable std::mutex commands_;
  std::atomic<double> highest_speed_mps_ = std::numeric_limits<double>::infinity();
  std::atomic<double> highest_turn_rate_radps_ = std::numeric_limits<double>::infinity();
  Speeds last_;
  std::optional<std::chrono::steady_clock::time_point> last_time_;
};

/// Serves avm::Odometry and with it jderobot::Encoders and Pose3D, as PanTiltServant serves its samples.
/// *Thread-safe.*
class OdometryServant : public avm::Odometry {
 public:
  using Samples = SampleBroadcaster<OdometrySample>;

  explicit OdometryServant(MobileBase& base);

  void start(Samples::Report report = {}) { samples_.start(std::move(report)); }
  void stop() { samples_.stop(); }

  void samplesSinceAsync(Ice::Long after_us, std::function<void(const avm::OdometryBatch&)> response,
                         std::function<void(std::exception_ptr)> exception, const Ice::Current&) override;
  // JdeRobot declares no failure for reading: before the first sample Ice::UnknownException is thrown.
  std::shared_ptr<jderobot::EncodersData> getEncodersData(const Ice::Current&) override;
  /// Pose in odom [m].
  std::shared_ptr<jderobot::Pose3DData> getPose3DData(const Ice::Current&) override;
  /// Refused: dead reckoning keeps its pose.
  int setPose3DData(std::shared_ptr<jderobot::Pose3DData>, const Ice::Current&) override { return -1; }

 private:
  Pose2 newestPose() const;

  Samples samples_;
};

/// A remote base as a port. Either proxy may be null: without motors commands are rejected, without encoders
/// there are no samples. Commands block for at most a second. *Thread-safe.*
class RemoteMobileBase : public MobileBase {
 public:
  RemoteMobileBase(const std::shared_ptr<avm::BasePrx>& motors,
                   const std::shared_ptr<avm::OdometryPrx>& encoders, LinkReport encoders_report = {});

  /// The last limits from the server; all zero before it was reached. Never blocks.
  BaseLimits limits() const override;
  /// Waits up to a second for the motors, if there are any; accepted even without them.
  PortReply start() override;
  PortReply setVelocity(double v_mps, double w_radps) override;
  SampleBatch<OdometrySample> samplesSince(StampUs after_us, std::chrono::milliseconds timeout) override;
  /// Stops the base if this client's last command was a speed; commands of other clients stay in effect.
  void stop() override;

 private:
  std::shared_ptr<avm::BasePrx> motors_;
  std::shared_ptr<avm::OdometryPrx> encoders_;
  PendingCall<avm::OdometryBatch> samples_;
  mutable AskedValue<avm::BaseLimits> limits_;
  std::atomic<bool> driving_ = false;  ///< by this client's last command
};

}  // namespace vismem
