#include "simulator/app/component.h"

#include <cstdlib>
#include <sstream>

#include "common/config/config_error.h"
#include "common/process/log.h"
#include "common/process/status.h"
#include "common/robot_ice/base_ice.h"
#include "common/robot_ice/camera_ice.h"
#include "common/robot_ice/pantilt_ice.h"
#include "common/robot_ice/simulation_ice.h"
#include "simulator/app/real_time_simulation.h"
#include "simulator/app/simulator_config.h"

namespace vismem {
namespace {

/// The variables with which Gazebo's users name their folders of models.
void addModelPaths(std::vector<std::filesystem::path>& paths) {
  for (const char* variable : {"GAZEBO_MODEL_PATH", "GZ_SIM_RESOURCE_PATH"}) {
    const char* value = std::getenv(variable);
    std::istringstream folders(value == nullptr ? "" : value);
    for (std::string folder; std::getline(folders, folder, ':');) {
      if (!folder.empty()) paths.emplace_back(folder);
    }
  }
}

class SimulatorComponent : public Component {
 public:
  SimulatorComponent(SimulationConfig config, double speed, bool paused, std::vector<std::string> warnings)
      : warnings_(std::move(warnings)),
        paused_(paused),
        simulation_(std::move(config), speed,
                    {[this] { host_->status().count("frames"); },
                     [this](std::exception_ptr failure) { host_->fail(failure); }}) {}

  void start(ComponentHost& host) override {
    host_ = &host;
    for (const auto& warning : warnings_) host.log().warning(warning);
    host.serve("cameraA", std::make_shared<CameraServant>(frames_, "cameraA"));
    host.serve("PanTilt", pan_tilt_);
    host.serve("Motors", std::make_shared<BaseServant>(simulation_.base()));
    host.serve("Encoders", odometry_);
    host.serve("Simulation", truth_);
    simulation_.start();
    if (paused_) simulation_.pause();
    frames_.start(simulation_.camera());
    pan_tilt_->start();
    odometry_->start();
    truth_->start();
  }

  void stop() override {
    simulation_.stop();
    frames_.stop();
    pan_tilt_->stop();
    odometry_->stop();
    truth_->stop();
  }

 private:
  std::vector<std::string> warnings_;
  bool paused_;
  ComponentHost* host_ = nullptr;
  RealTimeSimulation simulation_;
  FrameBroadcaster frames_;
  std::shared_ptr<PanTiltServant> pan_tilt_ = std::make_shared<PanTiltServant>(simulation_.panTilt());
  std::shared_ptr<OdometryServant> odometry_ = std::make_shared<OdometryServant>(simulation_.base());
  std::shared_ptr<SimulationServant> truth_ = std::make_shared<SimulationServant>(simulation_);
};

std::unique_ptr<Component> configure(ConfigReader& reader) {
  SimulatorConfig config = readSimulatorConfig(reader);
  if (!reader.good()) return nullptr;
  addModelPaths(config.model_paths);
  LoadedWorld loaded = loadWorld(config.world_file, config.model_paths);
  config.simulation.world = std::move(loaded.world);
  try {
    return std::make_unique<SimulatorComponent>(std::move(config.simulation), config.speed, config.paused,
                                                std::move(loaded.warnings));
  } catch (const std::invalid_argument& error) {
    throw ConfigError({error.what()});
  }
}

}  // namespace

ComponentSpec simulatorSpec() {
  ComponentSpec spec;
  spec.name = "simulator";
  spec.prefix = "Simulator";
  spec.summary =
      "Simulates a robot with a camera on a pan-tilt unit in a world of SDF. Also: simulator --render WORLD "
      "[--pose x,y,theta] [--pan DEG] [--tilt DEG] [--top] -o FILE.png.";
  // Every object is found at every port; each has the port of a hardware server's own.
  for (const int port : {9999, 9990, 9997, 9977, 9972}) {
    spec.default_endpoints +=
        (spec.default_endpoints.empty() ? "" : ":") + ("tcp -h 127.0.0.1 -p " + std::to_string(port));
  }
  for (const int port : {11000, 11001, 11002, 11003, 11006}) {
    spec.default_endpoints += ":ws -h 127.0.0.1 -p " + std::to_string(port);
  }
  spec.configure = configure;
  return spec;
}

}  // namespace vismem
