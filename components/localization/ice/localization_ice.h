/// @file Localization over Ice: broadcaster, servant, and the client, which is a LocalizationControl again.
#pragma once

#include <avm/localization.h>

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>

#include "common/robot_ice/latest_value.h"
#include "common/robot_ice/pose3d_ice.h"
#include "common/robot_ice/remote.h"
#include "localization/core/pose_estimate.h"

namespace vismem {

avm::PoseEstimate toIce(const PoseEstimate& estimate);
PoseEstimate fromIce(const avm::PoseEstimate& estimate);

/// Gives the newest estimate to any number of local and remote readers. The component's loop publishes.
/// Revisions begin at 1. *Thread-safe.*
class EstimateBroadcaster {
 public:
  using Latest = LatestValue<PoseEstimate>;

  void publish(PoseEstimate estimate);
  /// Nothing comes for now: `message` says what is waited for. kFinished: the log is at its end.
  void setState(SourceState state, std::string message) { newest_.setState(state, std::move(message)); }
  /// For the component's own LocalizationControl::latest and ::next.
  std::optional<PoseEstimate> latest() const;
  std::optional<PoseEstimate> next(std::uint64_t after_revision, std::chrono::milliseconds timeout) const;
  /// Answers all who wait, now and from now on.
  void stop() { newest_.stop(); }

  Latest& stream() { return newest_; }

 private:
  Latest newest_{"no estimate yet"};
};

/// avm::Localization and with it jderobot::Pose3D. *Thread-safe* over a control that is; it and the
/// broadcaster must outlive the adapter.
class LocalizationServant : public avm::Localization {
 public:
  /// @param control takes setPose and relocalize; reads come from the broadcaster.
  /// @param pose3d_scale of JdeRobot's positions: 1 for metres, 1000 serves old millimetre clients.
  LocalizationServant(LocalizationControl& control, EstimateBroadcaster& estimates, double pose3d_scale = 1.0)
      : control_(control), estimates_(estimates), pose3d_scale_(pose3d_scale) {}

  avm::PoseEstimate latest(const Ice::Current&) override;
  void nextAsync(Ice::Long after_revision, std::function<void(const avm::EstimateResult&)> response,
                 std::function<void(std::exception_ptr)> exception, const Ice::Current&) override;
  avm::CommandReply setPose(avm::Pose2 T_world_robot, const Ice::Current&) override;
  avm::CommandReply relocalize(const Ice::Current&) override;

  /// Throws Ice::UnknownException while there is no pose: JdeRobot declares no failure here.
  std::shared_ptr<jderobot::Pose3DData> getPose3DData(const Ice::Current&) override;
  int setPose3DData(std::shared_ptr<jderobot::Pose3DData> data, const Ice::Current&) override;

 private:
  LocalizationControl& control_;
  EstimateBroadcaster& estimates_;
  double pose3d_scale_;
};

/// Remote localization as a port. Calls block for at most their timeout or a second; a peer that is away is
/// an empty answer or a rejection with the reason. *Thread-safe.*
class RemoteLocalization : public LocalizationControl {
 public:
  explicit RemoteLocalization(const std::shared_ptr<avm::LocalizationPrx>& proxy, LinkReport report = {});

  std::optional<PoseEstimate> latest() const override;
  /// The newest estimate with another revision (0: any); a lower one means that the peer restarted.
  std::optional<PoseEstimate> next(std::uint64_t after_revision, std::chrono::milliseconds timeout) override;
  PortReply setPose(const Pose2& T_world_robot) override;
  PortReply relocalize() override;

 private:
  std::shared_ptr<avm::LocalizationPrx> proxy_;
  std::shared_ptr<avm::LocalizationPrx> commands_;
  PendingCall<avm::EstimateResult> estimates_;
};

}  // namespace vismem
