#include "localization/app/component.h"

#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include "common/config/config_error.h"
#include "common/geometry/angles.h"
#include "common/memory_ice/visual_memory_ice.h"
#include "common/process/parameter_table.h"
#include "common/process/peer.h"
#include "localization/app/config.h"
#include "localization/app/gaze_sender.h"
#include "localization/app/health_map_worker.h"
#include "localization/app/label_watch.h"
#include "localization/app/localization_loop.h"
#include "localization/app/map_watch.h"
#include "localization/core/likelihood/camera_calibration.h"
#include "localization/ice/localization_ice.h"
#include "localization/ice/map_ice.h"

namespace vismem {
namespace {

void reportOdometry(const OdometryBias& bias, StatusBoard& status) {
  const auto report = [&](const char* name, int i, double scale, const char* unit) {
    status.gauge({name, scale * bias.errors[i], scale * std::sqrt(bias.P(i, i)), unit});
  };
  report("odometry yaw bias", 0, radToDeg(1.0), "deg/m");
  report("odometry yaw scale error", 1, 100.0, "%");
  report("odometry distance scale error", 2, 100.0, "%");
}

void reportCamera(const CameraErrors& camera, StatusBoard& status) {
  for (std::size_t i = 0; i < kCameraErrorTexts.size(); ++i) {
    const auto row = static_cast<int>(i);
    const CameraErrorText& is = kCameraErrorTexts[i];
    status.gauge({is.name, is.scale * camera.errors[row], is.scale * camera.sigmas[row], is.unit});
  }
}

class LocalizationComponent final : public Component, public PoseCommands {
 public:
  LocalizationComponent(const LocalizationConfig& config, LoadedMap map)
      : config_(config),
        map_(std::move(map)),
        localizer_(config_.params, map_.edges, config_.seed),
        gaze_params_(config_.gaze),
        watch_({config_.map, config_.palette}),
        labels_(map_.edges) {
    if (!config_.start) return;
    if (const std::string problem = localizer_.problemOf(*config_.start); !problem.empty())
      throw ConfigError({"Localization.Start.Position_m: " + problem});
    localizer_.setPose(*config_.start);
  }

  void start(ComponentHost& host) override {
    for (const std::string& warning : map_.warnings) host.log().warning(warning);
    const auto proxy = host.communicator()->stringToProxy(config_.visual_memory_proxy);
    memory_ =
        std::make_unique<VisualMemoryClient>(Ice::uncheckedCast<avm::VisualMemoryPrx>(proxy),
                                             reportTo("VisualMemory", proxy, host.status(), host.log()));
    loop_ = std::make_unique<LocalizationLoop>(std::move(localizer_), *memory_);
    if (!config_.gaze_proxy.empty()) {
      gaze_ = std::make_unique<GazeSender>(host.communicator()->stringToProxy(config_.gaze_proxy),
                                           host.status(), host.log());
      loop_->seekGaze(makePlanner(map_.edges), [this, &host](const GazePlan& plan, double plan_s) {
        host.status().latency("gaze plan", plan_s);
        gaze_->send(plan);
      });
    } else {
      host.status().note("requests no gaze: Localization.Gaze.Proxy is not set");
    }
    health_maps_ = std::make_unique<HealthMapWorker>(healthMapParams(config_.params), map_.edges,
                                                     [this] { return loop_->newest(); });
    servant_ = std::make_shared<LocalizationServant>(*this, estimates_, *health_maps_,
                                                     toIce(map_.rows, mapName()), config_.pose3d_scale);
    host.serve("Localization", servant_);
    if (gaze_) listGazeParameters(host.parameters());
    loop_->start(
        [this, &host](const PoseEstimate& estimate, double step_s) {
          host.status().count("estimates");
          host.status().latency("step", step_s);
          if (estimate.odometry) reportOdometry(*estimate.odometry, host.status());
          if (estimate.camera) {
            reportCamera(*estimate.camera, host.status());
            if (const std::string text = camera_alarm_.update(*estimate.camera); !text.empty())
              host.status().note(text);
          }
          estimates_.publish(std::make_shared<const PoseEstimate>(estimate),
                             static_cast<std::int64_t>(estimate.revision));
        },
        [this, &host](SourceState state, const std::string& why) {
          if (state == SourceState::kRunning) {
            host.status().healthy("visual memory");
            return;  // the next estimate reports it to the clients
          }
          estimates_.setState(state, "no visual memory: " + why);
          if (state == SourceState::kFinished) {
            host.status().healthy("visual memory");
          } else {
            host.status().fault("visual memory", "no update (" + why + ")");
          }
        },
        [&host](std::exception_ptr failure) { host.fail(std::move(failure)); },
        [this, &host] {
          host.status().alive("localization");
          if (gaze_) gaze_->keepInTouch();
          checkLabels(host.status());
          if (watch_.hasChanged(MapWatch::Clock::now())) reloadMap(host);
        });
  }

  void stop() override {
    if (health_maps_) health_maps_->stop();
    if (loop_) loop_->stop();
    if (gaze_) gaze_->close();
    estimates_.stop();
  }

  PortReply setPose(const Pose2& T_world_robot) override { return loop_->setPose(T_world_robot); }
  PortReply relocalize() override { return loop_->relocalize(); }

 private:
  GazePlanner makePlanner(const SegmentMap& map_edges) const {
    return GazePlanner(gaze_params_, config_.params.robust.likelihood, config_.params.map, map_edges);
  }

  std::string mapName() const { return config_.map.filename().string(); }

  /// In the loop's thread.
  void checkLabels(StatusBoard& status) {
    const auto memory = loop_->newest().snapshot;
    if (!memory) return;
    const std::string why = labels_.update(*memory);
    why.empty() ? status.healthy("labels") : status.fault("labels", why);
  }

  /// In the loop's thread. A map that cannot be used changes nothing.
  void reloadMap(ComponentHost& host) {
    try {
      const LoadedMap loaded = loadMapEdges(config_.map, config_.palette);
      for (const std::string& warning : loaded.warnings) host.log().warning(warning);
      loop_->replaceMap(Localizer(config_.params, loaded.edges, config_.seed),
                        gaze_ ? std::optional<GazePlanner>(makePlanner(loaded.edges)) : std::nullopt);
      health_maps_->setMap(loaded.edges);
      labels_ = LabelWatch(loaded.edges);
      servant_->setMap(toIce(loaded.rows, mapName()));
      host.status().healthy("map");
      host.log().info("the map " + mapName() + " has changed: localizing with it");
    } catch (const ConfigError& error) {
      host.status().fault("map",
                          mapName() + " has changed and cannot be used, the last one stays: " + error.what());
    }
  }

  void listGazeParameters(ParameterTable& table) {
    const auto add = [&](RuntimeParameter parameter, void (GazePlanner::*change)(double),
                         double GazePlannerParams::*field) {
      table.add(std::move(parameter), [this, change, field](double value) {
        return loop_
            ->changePlanner([this, change, field, value](GazePlanner& planner) {
              (planner.*change)(value);
              gaze_params_.*field = value;  // for the planner of the next map
            })
            .message;
      });
    };
    add({"Gaze.UncertaintyAbove", "", 0.0, 1.0, false, config_.gaze.uncertainty_above,
         "Gaze is requested while the support of the pose is below 1 minus this"},
        &GazePlanner::setUncertaintyAbove, &GazePlannerParams::uncertainty_above);
    add({"Gaze.Confirm_s", "s", 0.0, 60.0, false, config_.gaze.confirm_s,
         "Gaze is requested for so long after the pose became reliable"},
        &GazePlanner::setConfirmation, &GazePlannerParams::confirm_s);
  }

  const LocalizationConfig config_;
  const LoadedMap map_;            ///< at the start
  Localizer localizer_;            ///< until start(), then the loop's
  GazePlannerParams gaze_params_;  ///< as changed at run time; the loop's thread after start()
  MapWatch watch_;                 ///< the loop's thread after start()
  LabelWatch labels_;              ///< the loop's thread after start()
  CameraAlarm camera_alarm_;       ///< the loop's thread after start()
  LatestEstimate estimates_{"no estimate yet"};
  std::unique_ptr<VisualMemoryClient> memory_;
  std::unique_ptr<GazeSender> gaze_;        ///< null: no gaze requests
  std::unique_ptr<LocalizationLoop> loop_;  ///< its thread uses all of the above
  std::shared_ptr<LocalizationServant> servant_;
  std::unique_ptr<HealthMapWorker> health_maps_;  ///< last member: its thread uses the loop
};

}  // namespace

ComponentSpec localizationSpec() {
  ComponentSpec spec;
  spec.name = "localization";
  spec.prefix = "Localization";
  spec.summary = "Estimates the robot's pose in the map from its visual memory.";
  spec.default_endpoints = "tcp -h 127.0.0.1 -p 9971";
  spec.default_web_endpoints = "ws -h 127.0.0.1 -p 11005";
  spec.configure = [](ConfigReader& root) -> std::unique_ptr<Component> {
    ConfigReader reader = root.group("Localization");
    const LocalizationConfig config = readLocalizationConfig(reader);
    if (!reader.good()) return nullptr;
    return std::make_unique<LocalizationComponent>(config, loadMapEdges(config.map, config.palette));
  };
  return spec;
}

}  // namespace vismem
