#include "status/app/setup_search.h"

#include <algorithm>
#include <fstream>
#include <map>
#include <sstream>
#include <system_error>

#include "common/config/config_error.h"
#include "common/process/ready_line.h"
#include "common/process/robot_identity.h"
#include "common/process/setup.h"

namespace vismem {
namespace {

namespace fs = std::filesystem;

fs::path processListOf(const fs::path& root, const std::string& setup) {
  return root / "out" / setup / "pids";
}

bool hasProcesses(const fs::path& list) {
  std::error_code error;
  const auto size = fs::file_size(list, error);
  return !error && size > 0;
}

/// From the ready line in NAME.out; empty while there is none.
std::string endpointsSaid(const fs::path& folder, const std::string& name) {
  std::ifstream out(folder / (name + ".out"));
  std::string endpoints;
  // The last one is valid: a restarted component writes another.
  for (std::string line; std::getline(out, line);) {
    if (line.starts_with(name + " ready: ")) endpoints = readyEndpoints(line).value_or("");
  }
  return endpoints;
}

/// The names of the robot by component, from the configurations that scripts/start has read.
std::map<std::string, std::string> robotsOf(const fs::path& folder) {
  std::map<std::string, std::string> robots;
  if (!fs::is_directory(folder)) return robots;
  for (const auto& component : componentsOfSetup(folder)) robots[component.name] = component.robot;
  return robots;
}

std::vector<ComponentRow> rowsOfStarted(const fs::path& list, const std::string& setup,
                                        const fs::path& folder) {
  const auto robots = robotsOf(folder);
  std::ifstream lines(list);
  std::vector<ComponentRow> rows;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream fields(line);
    long process = 0;
    ComponentRow row;
    if (!(fields >> process >> row.name)) continue;
    row.setup = setup;
    if (const auto robot = robots.find(row.name); robot != robots.end()) row.robot = robot->second;
    row.endpoints = endpointsSaid(list.parent_path(), row.name);
    if (row.endpoints.empty()) row.failure = "it has not become ready";
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace

std::vector<std::string> startedSetups(const fs::path& root) {
  std::vector<std::string> setups;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(root / "out", error)) {
    const std::string name = entry.path().filename().string();
    if (hasProcesses(processListOf(root, name))) setups.push_back(name);
  }
  std::sort(setups.begin(), setups.end());
  return setups;
}

std::vector<ComponentRow> rowsOfSetup(const fs::path& root, const fs::path& configurations,
                                      const std::string& setup, int port_offset) {
  const fs::path list = processListOf(root, setup);
  // scripts/start --port-offset 5 calls a run of sim "sim+5".
  const fs::path folder = configurations / setup.substr(0, setup.find('+'));
  if (port_offset == 0 && hasProcesses(list)) return rowsOfStarted(list, setup, folder);
  if (!fs::is_directory(folder)) {
    throw ConfigError({"setup " + setup + " (must be a folder of " + configurations.string() +
                       "/, or one that scripts/start has started)"});
  }
  std::vector<ComponentRow> rows;
  for (const auto& component : componentsOfSetup(folder)) {
    ComponentRow row;
    row.setup = setup;
    row.name = component.name;
    row.robot = component.robot;
    row.endpoints = shiftPorts(component.endpoints, port_offset);
    row.may_be_left_out = mayBeLeftOut(component.name);
    if (row.endpoints.empty()) row.failure = component.file.string() + " names no endpoints";
    rows.push_back(std::move(row));
  }
  if (rows.empty()) throw ConfigError({folder.string() + " has no component's configuration"});
  return rows;
}

std::string statusProxyOf(const ComponentRow& row) {
  RobotKeys robot;
  robot.name = row.robot;
  const auto end = row.endpoints.find(':');
  return ownIdentity(robot, row.name + "/component") + ":" + row.endpoints.substr(0, end);
}

}  // namespace vismem
