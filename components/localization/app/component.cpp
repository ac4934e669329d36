#include "localization/app/component.h"

#include <cmath>
#include <optional>
#include <utility>

#include "active_visual_memory/ice/visual_memory_ice.h"
#include "common/geometry/angles.h"
#include "localization/app/gaze_sender.h"
#include "localization/app/health_map_worker.h"
#include "localization/app/localization_loop.h"
#include "localization/ice/localization_ice.h"

namespace vismem {
namespace {

void tellOdometry(const OdometryBelief& belief, StatusBoard& status) {
  const auto tell = [&](const char* name, int i, double scale, const char* unit) {
    status.gauge({name, scale * belief.errors[i], scale * std::sqrt(belief.P(i, i)), unit});
  };
  tell("odometry turns too little", 0, radToDeg(1.0), "deg/m");
  tell("odometry turns too narrow", 1, 100.0, "%");
  tell("odometry goes too short", 2, 100.0, "%");
}

class LocalizationComponent final : public Component, public LocalizationControl {
 public:
  LocalizationComponent(LocalizationConfig config, SegmentMap map_edges)
      : config_(std::move(config)),
        map_edges_(std::move(map_edges)),
        localizer_(config_.params, map_edges_, config_.seed) {
    if (!config_.gaze_proxy.empty()) planner_.emplace(config_.gaze, config_.params, map_edges_);
    if (config_.start) localizer_.setPose(*config_.start);
  }

  void start(ComponentHost& host) override {
    const auto proxy = host.communicator()->stringToProxy(config_.visual_memory_proxy);
    auto link = std::make_shared<PeerLink>("VisualMemory", proxy, host.status(), host.log());
    memory_ = std::make_unique<VisualMemoryClient>(Ice::uncheckedCast<avm::VisualMemoryPrx>(proxy),
                                                   [link](const std::string& failure) {
                                                     if (failure.empty()) {
                                                       link->succeeded();
                                                     } else {
                                                       link->failed(failure);
                                                     }
                                                   });
    loop_ = std::make_unique<LocalizationLoop>(std::move(localizer_), *memory_);
    if (planner_) {
      gaze_ = std::make_unique<GazeSender>(host.communicator()->stringToProxy(config_.gaze_proxy),
                                           host.status(), host.log());
      loop_->seekGaze(std::move(*planner_), [this, &host](const GazePlan& plan, double plan_s) {
        host.status().latency("gaze plan", plan_s);
        gaze_->send(plan);
      });
    } else {
      host.status().note("asks for no gaze: Localization.Gaze.Proxy is not set");
    }
    health_maps_ =
        std::make_unique<HealthMapWorker>(config_.params, map_edges_, [this] { return loop_->newest(); });
    host.serve("Localization",
               std::make_shared<LocalizationServant>(*this, estimates_, *health_maps_, config_.pose3d_scale));
    loop_->start(
        [this, &host](const PoseEstimate& estimate, double step_s) {
          host.status().count("estimates");
          host.status().latency("step", step_s);
          if (estimate.odometry) tellOdometry(*estimate.odometry, host.status());
          estimates_.publish(estimate);
        },
        [this, &host](SourceState state, const std::string& why) {
          if (state == SourceState::kRunning) {
            host.status().healthy("visual memory");
            return;  // the next estimate tells the clients
          }
          estimates_.setState(state, "no visual memory: " + why);
          if (state == SourceState::kFinished) {
            host.status().healthy("visual memory");
          } else {
            host.status().fault("visual memory", "no news (" + why + ")");
          }
        },
        [&host](std::exception_ptr failure) { host.fail(std::move(failure)); },
        [this, &host] {
          host.status().alive("localization");
          if (gaze_) gaze_->keepInTouch();
        });
  }

  void stop() override {
    if (health_maps_) health_maps_->stop();
    if (loop_) loop_->stop();
    if (gaze_) gaze_->close();
    estimates_.stop();
  }

  std::optional<PoseEstimate> latest() const override { return estimates_.latest(); }
  std::optional<PoseEstimate> next(std::uint64_t after_revision, std::chrono::milliseconds timeout) override {
    return estimates_.next(after_revision, timeout);
  }
  PortReply setPose(const Pose2& T_world_robot) override { return loop_->setPose(T_world_robot); }
  PortReply relocalize() override { return loop_->relocalize(); }

 private:
  const LocalizationConfig config_;
  const SegmentMap map_edges_;
  Localizer localizer_;                 ///< until start(), then the loop's
  std::optional<GazePlanner> planner_;  ///< until start(), then the loop's
  EstimateBroadcaster estimates_;
  std::unique_ptr<VisualMemoryClient> memory_;
  std::unique_ptr<GazeSender> gaze_;              ///< null: no gaze is asked for
  std::unique_ptr<LocalizationLoop> loop_;        ///< its thread uses all of the above
  std::unique_ptr<HealthMapWorker> health_maps_;  ///< last member: its thread asks the loop
};

}  // namespace

std::unique_ptr<Component> makeLocalization(const LocalizationConfig& config) {
  return std::make_unique<LocalizationComponent>(config, loadMapEdges(config.map, config.palette));
}

ComponentSpec localizationSpec() {
  ComponentSpec spec;
  spec.name = "localization";
  spec.prefix = "Localization";
  spec.summary = "Tells where in the map the robot is, from what its visual memory holds.";
  spec.default_endpoints = "tcp -h 127.0.0.1 -p 9971:ws -h 127.0.0.1 -p 11005";
  spec.configure = [](ConfigReader& root) -> std::unique_ptr<Component> {
    ConfigReader reader = root.group("Localization");
    const LocalizationConfig config = readLocalizationConfig(reader);
    if (!reader.good()) return nullptr;
    return makeLocalization(config);
  };
  return spec;
}

}  // namespace vismem
