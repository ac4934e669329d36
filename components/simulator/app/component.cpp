#include "simulator/app/component.h"

#include <string>

#include "common/config/config_error.h"
#include "common/config/text_file.h"
#include "common/process/log.h"
#include "common/process/status.h"
#include "common/robot_ice/base_ice.h"
#include "common/robot_ice/base_parameters.h"
#include "common/robot_ice/camera_ice.h"
#include "common/robot_ice/pantilt_ice.h"
#include "common/robot_ice/simulation_ice.h"
#include "common/tool/progress_line.h"
#include "simulator/app/model_paths.h"
#include "simulator/app/real_time_simulation.h"
#include "simulator/app/render_pool.h"
#include "simulator/app/simulator_config.h"

namespace vismem {
namespace {

class SimulatorComponent : public Component {
 public:
  /// @param summary of the world's loading, for the log.
  SimulatorComponent(SimulatorConfig config, std::string summary, std::vector<std::string> warnings)
      : summary_(std::move(summary)),
        warnings_(std::move(warnings)),
        paused_(config.paused),
        lock_step_(config.lock_step),
        pool_(config.render_threads),
        simulation_(withPool(std::move(config.simulation), config.render_threads), config.speed, hooks()) {
    for (std::size_t i = 0; i < simulation_.outputs(); ++i) {
      frames_.push_back(std::make_unique<FrameBroadcaster>());
    }
    frames_.front()->onConsumers([this] { simulation_.consumersChanged(); });
  }

  /// @throws ConfigError.
  void prepareScenario(Scenario scenario) {
    const PortReply reply = simulation_.prepareScenario(std::move(scenario));
    if (!reply.ok()) throw ConfigError({reply.message});
  }

  void start(ComponentHost& host) override {
    host_ = &host;
    for (const auto& warning : warnings_) host.log().warning(warning);
    host.log().info(summary_);
    for (std::size_t i = 0; i < frames_.size(); ++i) {
      const std::string name = simulation_.outputName(i);
      host.serve(name, std::make_shared<CameraServant>(*frames_[i], name));
    }
    host.serve("PanTilt", pan_tilt_);
    const auto motors = std::make_shared<BaseServant>(simulation_.base());
    host.serve("Motors", motors);
    listBaseParameters(host.parameters(), simulation_.base(), motors);
    host.serve("Encoders", odometry_);
    host.serve("Simulation", truth_);
    simulation_.start();
    if (paused_) simulation_.pause();
    if (lock_step_ > 0) simulation_.setLockStep(lock_step_);
    for (std::size_t i = 0; i < frames_.size(); ++i) frames_[i]->start(simulation_.output(i));
    pan_tilt_->start();
    odometry_->start();
    truth_->start();
  }

  void stop() override {
    simulation_.stop();
    for (auto& frames : frames_) frames->stop();
    pan_tilt_->stop();
    odometry_->stop();
    truth_->stop();
  }

 private:
  SimulationConfig withPool(SimulationConfig config, int threads) {
    if (threads < 2) return config;
    config.rendering.parallel_for = [this](int count, const std::function<void(int)>& task) {
      pool_.run(count, task);
    };
    return config;
  }

  RealTimeSimulation::Hooks hooks() {
    RealTimeSimulation::Hooks hooks;
    hooks.on_round = [this] { host_->status().alive("simulation"); };
    hooks.on_frame = [this] { host_->status().count("frames"); };
    hooks.on_failure = [this](std::exception_ptr failure) { host_->fail(failure); };
    hooks.on_problem = [this](const std::string& problem) { host_->log().warning(problem); };
    hooks.consumers_waiting = [this](std::uint64_t frames) {
      const FrameBroadcaster& first = *frames_.front();
      return first.published() < frames ? 0 : static_cast<int>(first.waiting());
    };
    return hooks;
  }

  std::string summary_;
  std::vector<std::string> warnings_;
  bool paused_;
  int lock_step_;
  ComponentHost* host_ = nullptr;
  RenderPool pool_;
  RealTimeSimulation simulation_;
  std::vector<std::unique_ptr<FrameBroadcaster>> frames_;  ///< by output
  std::shared_ptr<PanTiltServant> pan_tilt_ =
      std::make_shared<PanTiltServant>(simulation_.panTilt(), simulation_.panTiltPosition());
  std::shared_ptr<OdometryServant> odometry_ = std::make_shared<OdometryServant>(simulation_.base());
  std::shared_ptr<SimulationServant> truth_ = std::make_shared<SimulationServant>(simulation_);
};

std::unique_ptr<Component> configure(ConfigReader& reader) {
  SimulatorConfig config = readSimulatorConfig(reader);
  if (!reader.good()) return nullptr;
  ProgressLine progress("models of " + config.world_file.string());
  LoadedWorld loaded = loadWorld(config.world_file, modelPaths(config.model_paths),
                                 [&](std::size_t done, std::size_t all) { progress.show(done, all); });
  const std::string summary = config.world_file.string() + ": " + loaded.summary();
  config.simulation.world = std::move(loaded.world);
  std::optional<Scenario> scenario;
  if (!config.scenario.empty()) {
    scenario = parseScenario(readTextFile(config.scenario, "a scenario"), config.scenario.string());
  }
  try {
    auto component =
        std::make_unique<SimulatorComponent>(std::move(config), summary, std::move(loaded.warnings));
    if (scenario) component->prepareScenario(std::move(*scenario));
    return component;
  } catch (const std::invalid_argument& error) {
    const std::string why = error.what();
    if (!why.starts_with("the start pose")) throw ConfigError({why});
    reader.group("Simulator").problem("Start.Position_m", why);
    return nullptr;
  }
}

}  // namespace

ComponentSpec simulatorSpec() {
  ComponentSpec spec;
  spec.name = "simulator";
  spec.prefix = "Simulator";
  spec.summary =
      "Simulates a robot with a camera on a pan-tilt unit in a world of SDF. Also: simulator --render WORLD "
      "[--pose x,y,theta] [--pan DEG] [--tilt DEG] [--top] [--camera NAME] [--depth FILE] [--ids FILE] -o "
      "FILE.png.";
  // Every object is served at every port; each of these is the port of a hardware server.
  for (const int port : {9999, 9990, 9997, 9977, 9972}) {
    spec.default_endpoints +=
        (spec.default_endpoints.empty() ? "" : ":") + ("tcp -h 127.0.0.1 -p " + std::to_string(port));
  }
  for (const int port : {11000, 11001, 11002, 11003, 11006}) {
    spec.default_web_endpoints +=
        (spec.default_web_endpoints.empty() ? "" : ":") + ("ws -h 127.0.0.1 -p " + std::to_string(port));
  }
  spec.configure = configure;
  return spec;
}

}  // namespace vismem
