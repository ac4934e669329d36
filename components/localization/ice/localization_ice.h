/// @file Localization over Ice: servant and client.
#pragma once

#include <avm/localization.h>

#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "common/robot_ice/latest_value.h"
#include "common/robot_ice/pose3d_ice.h"
#include "common/robot_ice/remote.h"
#include "localization/core/likelihood/health_map.h"
#include "localization/core/pose_estimate.h"

namespace vismem {

avm::PoseEstimate toIce(const PoseEstimate& estimate);
PoseEstimate fromIce(const avm::PoseEstimate& estimate);
avm::HealthMapRequest toIce(const HealthMapRequest& request);
HealthMapRequest fromIce(const avm::HealthMapRequest& request);
avm::HealthGrid toIce(const HealthMap& map);
/// @return empty unless each place has one finite value.
std::optional<HealthMap> fromIce(const avm::HealthGrid& map);

/// The newest estimate, from the component's loop to its clients. Revisions start at 1.
using LatestEstimate = LatestValue<PoseEstimate>;

/// Computes health maps for the servant. *Thread-safe.*
class HealthMapSource {
 public:
  /// Called once, on any thread.
  /// @param map empty without a map; `why` has the reason.
  using Done = std::function<void(std::optional<HealthMap> map, const std::string& why)>;

  virtual ~HealthMapSource() = default;
  /// @return empty if the request is valid and small enough, else field, value and rule.
  virtual std::string check(const HealthMapRequest& request) const = 0;
  /// @param request accepted by `check`.
  /// @return rejected with the reason; `done` is not called then.
  virtual PortReply draw(const HealthMapRequest& request, Done done) = 0;
};

/// avm::Localization, which includes jderobot::Pose3D. *Thread-safe* if its commands are. Commands, estimates
/// and source of health maps must outlive the adapter.
class LocalizationServant : public avm::Localization {
 public:
  /// @param map as clients get it.
  /// @param pose3d_scale of JdeRobot's positions: 1 for metres, 1000 for millimetre clients.
  LocalizationServant(PoseCommands& commands, LatestEstimate& estimates, HealthMapSource& health_maps,
                      avm::MapContents map, double pose3d_scale = 1.0)
      : commands_(commands),
        estimates_(estimates),
        health_maps_(health_maps),
        map_(std::move(map)),
        pose3d_scale_(pose3d_scale) {}

  avm::PoseEstimate latest(const Ice::Current&) override;
  void nextAsync(Ice::Long after_revision, std::function<void(const avm::EstimateResult&)> response,
                 std::function<void(std::exception_ptr)> exception, const Ice::Current&) override;
  avm::CommandReply setPose(avm::Pose2 T_world_robot, const Ice::Current&) override;
  avm::CommandReply relocalize(const Ice::Current&) override;
  void healthMapAsync(avm::HealthMapRequest request, std::function<void(const avm::HealthGrid&)> response,
                      std::function<void(std::exception_ptr)> exception, const Ice::Current&) override;
  avm::MapContents getMap(const Ice::Current&) override {
    const std::lock_guard lock(map_mutex_);
    return map_;
  }
  /// What clients get from now on.
  void setMap(avm::MapContents map) {
    const std::lock_guard lock(map_mutex_);
    map_ = std::move(map);
  }

  /// @throws Ice::UnknownException without a pose: JdeRobot declares no failure here.
  std::shared_ptr<jderobot::Pose3DData> getPose3DData(const Ice::Current&) override;
  int setPose3DData(std::shared_ptr<jderobot::Pose3DData> data, const Ice::Current&) override;

 private:
  PoseCommands& commands_;
  LatestEstimate& estimates_;
  HealthMapSource& health_maps_;
  std::mutex map_mutex_;
  avm::MapContents map_;
  double pose3d_scale_;
};

/// Remote localization as a port. Calls block for at most their timeout or one second; an absent peer gives
/// an empty answer or a rejection with the reason. *Thread-safe.*
class RemoteLocalization : public LocalizationControl {
 public:
  explicit RemoteLocalization(const std::shared_ptr<avm::LocalizationPrx>& proxy, LinkReport report = {});

  std::optional<PoseEstimate> latest() const override;
  /// The newest estimate with another revision (0: any). A lower revision means a restarted peer.
  std::optional<PoseEstimate> next(std::uint64_t after_revision, std::chrono::milliseconds timeout) override;
  PortReply setPose(const Pose2& T_world_robot) override;
  PortReply relocalize() override;

  struct HealthMapResult {
    std::optional<HealthMap> map;
    std::string why;  ///< reason without a map
  };
  /// Waits for at most 120 s: the time of a map of the largest size after a full queue.
  HealthMapResult healthMap(const HealthMapRequest& request);

 private:
  std::shared_ptr<avm::LocalizationPrx> proxy_;
  std::shared_ptr<avm::LocalizationPrx> commands_;
  std::shared_ptr<avm::LocalizationPrx> drawings_;
  PendingCall<avm::EstimateResult> estimates_;
};

}  // namespace vismem
