/// @file Localization over Ice: broadcaster, servant, and the client, which is a LocalizationControl again.
#pragma once

#include <avm/localization.h>

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "common/robot_ice/latest_value.h"
#include "common/robot_ice/pose3d_ice.h"
#include "common/robot_ice/remote.h"
#include "localization/core/health_map.h"
#include "localization/core/pose_estimate.h"

namespace vismem {

avm::PoseEstimate toIce(const PoseEstimate& estimate);
PoseEstimate fromIce(const avm::PoseEstimate& estimate);
avm::HealthMapRequest toIce(const HealthMapRequest& request);
HealthMapRequest fromIce(const avm::HealthMapRequest& request);
avm::HealthGrid toIce(const HealthMap& map);
/// @return empty unless there is one finite value a place.
std::optional<HealthMap> fromIce(const avm::HealthGrid& map);

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

/// Draws health maps for the servant. *Thread-safe.*
class HealthMapSource {
 public:
  /// @param map empty: `why` says why there is none. Called once, on any thread.
  using Done = std::function<void(std::optional<HealthMap> map, const std::string& why)>;

  virtual ~HealthMapSource() = default;
  /// @return empty if the request makes sense and is small enough, else field, value and rule.
  virtual std::string check(const HealthMapRequest& request) const = 0;
  /// @param request that `check` approves. @return rejected, with the reason: `done` will not be called.
  virtual PortReply draw(const HealthMapRequest& request, Done done) = 0;
};

/// avm::Localization and with it jderobot::Pose3D. *Thread-safe* over a control that is; it, the
/// broadcaster and the source of health maps must outlive the adapter.
class LocalizationServant : public avm::Localization {
 public:
  /// @param control takes setPose and relocalize; reads come from the broadcaster.
  /// @param pose3d_scale of JdeRobot's positions: 1 for metres, 1000 serves old millimetre clients.
  LocalizationServant(LocalizationControl& control, EstimateBroadcaster& estimates,
                      HealthMapSource& health_maps, double pose3d_scale = 1.0)
      : control_(control), estimates_(estimates), health_maps_(health_maps), pose3d_scale_(pose3d_scale) {}

  avm::PoseEstimate latest(const Ice::Current&) override;
  void nextAsync(Ice::Long after_revision, std::function<void(const avm::EstimateResult&)> response,
                 std::function<void(std::exception_ptr)> exception, const Ice::Current&) override;
  avm::CommandReply setPose(avm::Pose2 T_world_robot, const Ice::Current&) override;
  avm::CommandReply relocalize(const Ice::Current&) override;
  void healthMapAsync(avm::HealthMapRequest request, std::function<void(const avm::HealthGrid&)> response,
                      std::function<void(std::exception_ptr)> exception, const Ice::Current&) override;

  /// Throws Ice::UnknownException while there is no pose: JdeRobot declares no failure here.
  std::shared_ptr<jderobot::Pose3DData> getPose3DData(const Ice::Current&) override;
  int setPose3DData(std::shared_ptr<jderobot::Pose3DData> data, const Ice::Current&) override;

 private:
  LocalizationControl& control_;
  EstimateBroadcaster& estimates_;
  HealthMapSource& health_maps_;
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

  struct HealthMapResult {
    std::optional<HealthMap> map;
    std::string why;  ///< there is none
  };
  /// Waits for 120 s at most: for a map of the largest size and those asked for before it.
  HealthMapResult healthMap(const HealthMapRequest& request);

 private:
  std::shared_ptr<avm::LocalizationPrx> proxy_;
  std::shared_ptr<avm::LocalizationPrx> commands_;
  std::shared_ptr<avm::LocalizationPrx> drawings_;
  PendingCall<avm::EstimateResult> estimates_;
};

}  // namespace vismem
