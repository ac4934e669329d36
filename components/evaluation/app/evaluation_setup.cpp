#include "evaluation/app/evaluation_setup.h"

#include <algorithm>
#include <iostream>
#include <string>
#include <utility>
#include <vector>

#include "active_visual_memory/app/config.h"
#include "common/config/config_error.h"
#include "common/config/config_reader.h"
#include "common/config/project_file.h"
#include "common/config/properties.h"
#include "common/config/text_file.h"
#include "common/process/process_keys.h"
#include "common/routes/route_follower.h"
#include "localization/app/config.h"
#include "simulator/app/simulator_config.h"

namespace vismem {
namespace {

namespace fs = std::filesystem;

/// A component's file in the setup. @throws ConfigError for a setup without it.
fs::path setupFile(const EvaluationOptions& options, const std::string& component) {
  const std::string usual = options.bag.empty() ? "sim" : "replay";
  const std::string& setup = options.setup.empty() ? usual : options.setup;
  const fs::path file = projectFile("cfg/" + setup + "/" + component + ".cfg");
  if (!fs::exists(file)) {
    throw ConfigError({"--setup " + setup + ": no file cfg/" + setup + "/" + component +
                       ".cfg (must be a folder of cfg/, such as " + usual + ")"});
  }
  return file;
}

/// The configuration of a component: options.config, else its file in the setup.
fs::path configFile(const EvaluationOptions& options, const std::string& component) {
  if (!options.config.empty()) return options.config;
  // A session has its own.
  const fs::path own = options.bag / "cfg" / (component + ".cfg");
  if (!options.bag.empty() && fs::exists(own)) return own;
  return setupFile(options, component);
}

/// Prints the warnings about renamed keys.
/// @throws ConfigError with every problem.
void finish(const ConfigReader& config) {
  config.finish();
  for (const auto& renamed : config.renamedKeys()) std::cerr << renamed.text() << "\n";
}

/// The palette of the options, else the one beside the map; empty: neither.
fs::path paletteOf(const EvaluationOptions& options) {
  if (!options.palette.empty() || options.map.empty()) return options.palette;
  fs::path beside = options.map;
  beside.replace_extension(".palette");
  return fs::exists(beside) ? beside : fs::path();
}

/// Reads the keys of the memory and its palette: of the options, else beside the map, else the
/// configuration's.
void readMemory(const EvaluationOptions& options, bool has_pan_tilt, EvaluationParams& params) {
  Properties properties = Properties::load(configFile(options, "active_visual_memory"));
  // The component's peers are in this process; all its other keys apply.
  properties.set("ActiveVisualMemory.Camera.Proxy", "here");
  properties.set("ActiveVisualMemory.Odometry.Proxy", "here");
  properties.set("ActiveVisualMemory.PanTilt.Proxy", has_pan_tilt ? "here" : "");
  if (!options.mode.empty()) properties.set("ActiveVisualMemory.Mode", options.mode);
  params.palette_file = paletteOf(options);
  // The configuration of a recording names files of the machine that made it.
  if (!params.palette_file.empty()) properties.set("ActiveVisualMemory.Palette", "");
  ConfigReader config(properties);
  config.known("Localization.*");
  ConfigReader reader = config.group("ActiveVisualMemory");
  knowProcessKeys(config, "ActiveVisualMemory");
  const ActiveVisualMemoryConfig component = readActiveVisualMemoryConfig(reader);
  finish(config);
  params.pipeline = component.pipeline;
  params.pipeline.memory.attention.seed = options.seed;
  params.assembler = component.assembler;
  params.joints = component.joints;
  params.wheels = component.wheels;
  if (params.palette_file.empty()) params.palette_file = component.palette;
  if (params.palette_file.empty()) {
    throw ConfigError(
        {(options.map.empty() ? "" : options.map.string() + ": ") +
         "no palette: expected --palette, a file beside the map, or ActiveVisualMemory.Palette in " +
         configFile(options, "active_visual_memory").string()});
  }
  params.palette =
      config.loading([&] { return std::make_shared<const Palette>(loadPalette(params.palette_file)); });
}

void readLocalization(const EvaluationOptions& options, EvaluationParams& params) {
  Properties properties = Properties::load(configFile(options, "localization"));
  if (!options.mode.empty()) properties.set("Localization.Mode", options.mode);
  ConfigReader config(properties);
  config.known("ActiveVisualMemory.*");
  knowProcessKeys(config, "Localization");
  ConfigReader reader = config.group("Localization");
  // The evaluation sets map, palette, seed and start; experiments decide about gaze requests.
  for (const char* key :
       {"VisualMemory.Proxy", "Map", "Palette", "Seed", "Start.*", "Pose3D.*", "Gaze.Proxy"}) {
    reader.known(key);
  }
  params.localizer = readLocalizerParams(reader);
  params.gaze = readGazePlannerParams(reader);
  finish(config);
}

}  // namespace

EvaluationOptions inProjectWorld(const std::string& world, const std::string& setup, std::uint64_t seed,
                                 double camera_rate_hz) {
  EvaluationOptions evaluation;
  evaluation.world = projectFile("cfg/worlds/" + world + ".world");
  evaluation.map = projectFile("cfg/maps/" + world + ".csv");
  evaluation.setup = setup;
  evaluation.seed = seed;
  evaluation.camera_rate_hz = camera_rate_hz;
  return evaluation;
}

void copyConfiguration(const EvaluationOptions& options) {
  std::error_code error;
  fs::create_directories(options.record / "cfg", error);
  for (const char* component : {"active_visual_memory", "localization"}) {
    const fs::path file = configFile(options, component);
    fs::copy_file(file, options.record / "cfg" / (std::string(component) + ".cfg"), error);
    if (error)
      throw ConfigError(
          {file.string() + ": cannot be copied to " + options.record.string() + ": " + error.message()});
  }
}

EvaluationParams loadParams(const EvaluationOptions& options, bool has_pan_tilt) {
  EvaluationParams params;
  readMemory(options, has_pan_tilt, params);
  readLocalization(options, params);
  if (options.map.empty()) return params;
  LoadedMap map = loadMapEdges(options.map, params.palette_file);
  for (const std::string& warning : map.warnings) std::cerr << "warning: " << warning << "\n";
  params.map = std::move(map.rows);
  params.map_edges = std::move(map.edges);
  return params;
}

SimulationConfig simulationConfig(const EvaluationOptions& options) {
  Properties properties = Properties::load(setupFile(options, "simulator"));
  properties.set("Simulator.World", options.world.string());
  ConfigReader config(properties);
  knowProcessKeys(config, "Simulator");
  SimulatorConfig robot = readSimulatorConfig(config);
  finish(config);
  SimulationConfig& simulated = robot.simulation;
  simulated.world = loadWorld(options.world, robot.model_paths).world;
  simulated.seed = options.seed;
  simulated.cameras.front().rate_hz = options.camera_rate_hz;
  return std::move(robot.simulation);
}

std::unique_ptr<Simulation> makeSimulation(const EvaluationOptions& options,
                                           const std::optional<Route>& route,
                                           const std::optional<Pose2>& start) {
  SimulationConfig simulated = simulationConfig(options);
  if (start) simulated.start = *start;
  auto simulation = std::make_unique<Simulation>(std::move(simulated));

  Scenario scenario;
  if (!options.scenario.empty()) {
    scenario = parseScenario(readTextFile(options.scenario, "a scenario"), options.scenario.string());
  }
  const bool drives =
      std::any_of(scenario.events.begin(), scenario.events.end(),
                  [](const ScenarioEvent& event) { return event.kind == ScenarioEvent::Kind::kDrive; });
  if (route && !drives) {
    ScenarioEvent drive;
    drive.kind = ScenarioEvent::Kind::kDrive;
    drive.way = {route->points, route->closed, WayEnd::kBack, RouteFollowerParams{}.speed_mps};
    scenario.events.insert(scenario.events.begin(), std::move(drive));
  }
  const PortReply reply = simulation->play(std::move(scenario));
  if (!reply.ok()) throw ConfigError({reply.message});
  return simulation;
}

}  // namespace vismem
