#include "application/app/launcher.h"

#include <algorithm>
#include <deque>
#include <iomanip>
#include <sstream>

#include "application/app/run_inputs.h"
#include "application/app/session_setup.h"
#include "common/config/properties.h"
#include "common/geometry/angles.h"
#include "common/process/ready_line.h"
#include "common/process/setup.h"
#include "common/recording/bag_advice.h"
#include "common/robot_ice/lease_ice.h"
#include "common/routes/route.h"
#include "gui/server/http_endpoint.h"

namespace vismem {
namespace {

constexpr std::size_t kShownLines = 12;

std::filesystem::path configOf(const RunOptions& options, const std::string& name) {
  return options.root / "cfg" / options.folder / (name + ".cfg");
}

ComponentCommand commandOf(const RunOptions& options, const std::string& name) {
  const std::filesystem::path file = configOf(options, name);
  if (!options.session.empty() && std::filesystem::exists(options.session / "cfg" / (name + ".cfg")) &&
      (name == "active_visual_memory" || name == "localization")) {
    return {name, sessionArguments(options.session, name, file, options.port_offset)};
  }
  ComponentCommand command{name, {"--Ice.Config=" + file.string()}};
  const auto ports = portArguments(file, options.port_offset);
  command.arguments.insert(command.arguments.end(), ports.begin(), ports.end());
  return command;
}

bool hasPage(const RunOptions& options) {
  return options.gui && std::filesystem::exists(configOf(options, "gui_server"));
}

/// Adds where the page reaches the recorder; the configuration of its server leaves out what runs on request.
void addRecorderOfPage(const RunOptions& options, ComponentCommand& page) {
  const Properties properties = Properties::load(configOf(options, "recorder"));
  properties.throwIfBad();
  const auto* entry = properties.find("Recorder.WebEndpoints");
  if (entry == nullptr) return;
  const std::string endpoints = ":" + shiftPorts(entry->value, options.port_offset);
  page.arguments.push_back("--GuiServer.Recorder.Proxy=Recorder" + endpoints);
  page.arguments.push_back("--GuiServer.Components.recorder.Proxy=recorder/component" + endpoints);
}

/// Adds the server of the page, and the token without which components answer no page.
void addPage(const RunOptions& options, std::vector<ComponentCommand>& commands) {
  if (!hasPage(options)) return;
  commands.push_back(commandOf(options, "gui_server"));
  if (options.record) addRecorderOfPage(options, commands.back());
  const std::string token = makeSecret();
  for (auto& command : commands) command.arguments.push_back("--Robot.Token=" + token);
}

}  // namespace

std::string pageAddressOf(const RunOptions& options) {
  if (!hasPage(options)) return "";
  const Properties properties = Properties::load(configOf(options, "gui_server"));
  properties.throwIfBad();
  const auto* entry = properties.find("GuiServer.Http.Endpoints");
  const auto endpoint = parseHttpEndpoint(
      shiftPorts(entry == nullptr ? std::string(kDefaultHttpEndpoint) : entry->value, options.port_offset));
  return endpoint ? pageAddress(*endpoint, endpoint->port) : "";
}

std::filesystem::path paletteOf(const RunOptions& options) {
  if (!options.palette.empty()) return options.palette;
  return fileOfSetup(options, "active_visual_memory", "ActiveVisualMemory.Palette");
}

// The source starts paused, so that no component misses the beginning of a recording or of a simulated run.
std::vector<ComponentCommand> commandsOf(const RunOptions& options) {
  std::vector<ComponentCommand> commands;
  const auto add = [&](const std::string& name) -> std::vector<std::string>& {
    commands.push_back(commandOf(options, name));
    return commands.back().arguments;
  };
  const std::string seed = std::to_string(options.seed);
  if (options.setup == Setup::kSimulation) {
    const Pose2 start = startOnRoute(loadRoute(options.route), options.seed).T_world_robot;
    std::ostringstream position, heading_deg;
    position << std::setprecision(12) << start.x << ' ' << start.y;
    heading_deg << std::setprecision(12) << radToDeg(start.theta);
    auto& arguments = add("simulator");
    arguments.push_back("--Simulator.World=" + options.world.string());
    arguments.push_back("--Simulator.Seed=" + seed);
    arguments.push_back("--Simulator.Start.Position_m=" + position.str());
    arguments.push_back("--Simulator.Start.Heading_deg=" + heading_deg.str());
    arguments.push_back("--Simulator.Paused=yes");
    if (!options.scenario.empty()) arguments.push_back("--Simulator.Scenario=" + options.scenario.string());
  } else {
    auto& arguments = add("replay_server");
    arguments.push_back("--ReplayServer.File=" + options.bag.string());
    arguments.push_back("--ReplayServer.Start=paused");
    RobotLogOptions topics;
    applyTopics(options.topics, topics);
    for (const std::string& argument : replayArguments(topics)) arguments.push_back(argument);
  }
  auto& memory = add("active_visual_memory");
  if (!options.palette.empty()) memory.push_back("--ActiveVisualMemory.Palette=" + options.palette.string());
  auto& localization = add("localization");
  localization.push_back("--Localization.Map=" + options.map.string());
  localization.push_back("--Localization.Seed=" + seed);
  if (const auto palette = paletteOf(options); !palette.empty()) {
    localization.push_back("--Localization.Palette=" + palette.string());
  }
  if (options.record) {
    auto& recorder = add("recorder");
    recorder.push_back("--Recorder.Folder=" + options.out.string());
    recorder.push_back("--Recorder.Name=recording");
    recorder.push_back("--Recorder.Map=" + options.map.string());
  }
  addPage(options, commands);
  return commands;
}

Launcher::Launcher(const RunOptions& options, const std::vector<ComponentCommand>& commands) {
  for (const ComponentCommand& command : commands) {
    std::vector<std::string> line{(options.bin / command.name).string()};
    line.insert(line.end(), command.arguments.begin(), command.arguments.end());
    ChildProcess::Options child_options;
    child_options.working_directory = options.root;
    child_options.kept_lines = 200;
    try {
      children_.push_back(
          {command.name, std::make_unique<ChildProcess>(std::move(line), std::move(child_options))});
    } catch (const std::exception& error) {
      throw ComponentFailure(error.what());
    }
  }
}

std::string lastWords(const std::string& log) {
  std::istringstream text(log);
  std::deque<std::string> last;
  bool is_info = false;  // an entry of the log goes on with indented lines
  for (std::string line; std::getline(text, line);) {
    if (!line.starts_with(' ')) is_info = line.find(" INFO ") != std::string::npos;
    if (is_info) continue;
    last.push_back(line);
    if (last.size() > kShownLines) last.pop_front();
  }
  std::string words;
  for (const std::string& line : last) words += "\n  " + line;
  if (words.find("in use") != std::string::npos) {
    words += "\n  Another run may have this port: --port-offset 100 adds 100 to every port.";
  }
  return words;
}

void Launcher::fail(const Child& child, const std::string& what) {
  throw ComponentFailure(child.name + " " + what + lastWords(child.process->error()));
}

void Launcher::checkAlive() const {
  for (const Child& child : children_) {
    if (const auto code = child.process->exitCode()) fail(child, describeExit(*code));
  }
}

bool Launcher::waitUntilReady(std::chrono::seconds timeout, const std::function<bool()>& interrupted) {
  const auto deadline = std::chrono::steady_clock::now() + timeout;
  for (const Child& child : children_) {
    while (!child.process->waitForLine(child.name + " ready: ", std::chrono::milliseconds(100))) {
      if (interrupted()) return false;
      checkAlive();
      if (std::chrono::steady_clock::now() > deadline) {
        fail(child, "was not ready within " + std::to_string(timeout.count()) + " s");
      }
    }
  }
  return true;
}

std::string Launcher::proxy(const std::string& component, const std::string& identity) const {
  for (const Child& child : children_) {
    if (child.name != component) continue;
    const auto line = child.process->waitForLine(component + " ready: ", std::chrono::milliseconds(0));
    const auto endpoints = line ? readyEndpoints(*line) : std::nullopt;
    if (!endpoints) fail(child, "is not ready");
    return identity + ":" + *endpoints;
  }
  throw std::logic_error("no component " + component + " in this setup");
}

void Launcher::stopAll() {
  // Sinks before sources, so that none logs a lost peer.
  while (!children_.empty()) {
    children_.back().process->stop(std::chrono::seconds(5));
    children_.pop_back();
  }
}

}  // namespace vismem
