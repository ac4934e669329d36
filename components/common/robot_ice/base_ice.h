/// @file A mobile base over Ice: servants over any MobileBase, and the client, which is one again. JdeRobot's
/// Encoders speak millimetres and degrees; they are converted here and nowhere else. SPEC C4.
#pragma once

#include <avm/base.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "common/robot/ports.h"
#include "common/robot_ice/remote.h"
#include "common/robot_ice/sample_broadcaster.h"

namespace vismem {

avm::OdometrySample toIce(const OdometrySample& sample);
OdometrySample fromIce(const avm::OdometrySample& sample);
avm::BaseLimits toIce(const BaseLimits& limits);
BaseLimits fromIce(const avm::BaseLimits& limits);
/// Millimetres; degrees in [0, 360).
jderobot::EncodersData toEncoders(const Pose2& T_odom_robot);

/// avm::Base and with it jderobot::Motors. *Thread-safe* over a base that takes commands while samplesSince
/// waits; commands exclude each other here. The base must be started and outlive the adapter.
class BaseServant : public avm::Base {
 public:
  using Now = std::function<std::chrono::steady_clock::time_point()>;

  /// @param now is replaced in tests only.
  explicit BaseServant(MobileBase& base, Now now = std::chrono::steady_clock::now)
      : base_(base), now_(std::move(now)) {}

  avm::BaseLimits getLimits(const Ice::Current&) override;
  avm::CommandReply setVelocity(double v_mps, double w_radps, const Ice::Current&) override;

  /// What was commanded, brought to the limits; 0 once the watchdog has stopped the base.
  float getV(const Ice::Current&) override;
  float getW(const Ice::Current&) override;
  float getL(const Ice::Current&) override { return 0.0F; }
  /// One speed; the other stays as it is commanded now.
  int setV(float v, const Ice::Current&) override;
  int setW(float w, const Ice::Current&) override;
  /// Only 0: the base cannot move sideways.
  int setL(float l, const Ice::Current&) override { return l == 0.0F ? 0 : -1; }

 private:
  struct Speeds {
    double v_mps = 0.0;
    double w_radps = 0.0;
  };
  Speeds commanded() const;
  PortReply commandLocked(Speeds speeds);

  MobileBase& base_;
  Now now_;
  mutable std::mutex commands_;
  Speeds last_;
  std::optional<std::chrono::steady_clock::time_point> last_time_;
};

/// avm::Odometry and with it jderobot::Encoders and Pose3D, as PanTiltServant does it for its samples.
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
  /// In odom, metres.
  std::shared_ptr<jderobot::Pose3DData> getPose3DData(const Ice::Current&) override;
  /// Refused: dead reckoning goes on from where it is.
  int setPose3DData(std::shared_ptr<jderobot::Pose3DData>, const Ice::Current&) override { return -1; }

 private:
  Pose2 newestPose() const;

  Samples samples_;
};

/// A remote base as a port; either proxy may be null: without motors commands are rejected, without encoders
/// no samples come. Commands block for at most a second. *Thread-safe.*
class RemoteMobileBase : public MobileBase {
 public:
  RemoteMobileBase(const std::shared_ptr<avm::BasePrx>& motors,
                   const std::shared_ptr<avm::OdometryPrx>& encoders, LinkReport encoders_report = {});

  /// As the server said last; all zero before it was reached. Never blocks.
  BaseLimits limits() const override;
  /// Waits up to a second for the motors, if there are any; accepted even without them.
  PortReply start() override;
  PortReply setVelocity(double v_mps, double w_radps) override;
  SampleBatch<OdometrySample> samplesSince(StampUs after_us, std::chrono::milliseconds timeout) override;
  /// The base stops if this client's last command was a speed; whoever else drives it is not disturbed.
  void stop() override;

 private:
  std::string askLimits(std::chrono::milliseconds timeout) const;

  std::shared_ptr<avm::BasePrx> motors_;
  std::shared_ptr<avm::OdometryPrx> encoders_;
  PendingCall<avm::OdometryBatch> samples_;
  mutable PendingCall<avm::BaseLimits> asked_limits_;
  mutable std::mutex mutex_;
  mutable std::optional<BaseLimits> limits_;
  std::atomic<bool> driving_ = false;  ///< by this client's last command
};

}  // namespace vismem
