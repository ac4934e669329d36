/// @file A scenario: timed events in a simulated world. Format: docs/scenarios.md. Pure.
#pragma once

#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "common/kinematics/odometry.h"
#include "common/robot/control_ports.h"

namespace vismem {

struct ScenarioEvent {
  enum class Kind { kPlace, kRemove, kWalk, kStand, kKidnap, kSlip, kDrive, kHalt };
  Kind kind = Kind::kPlace;
  int line = 0;                             ///< of the file, from 1
  double at_s = 0.0;                        ///< time after the scenario's beginning
  std::string model;                        ///< kPlace, kRemove, kWalk, kStand
  Pose3 T_world_model = Pose3::Identity();  ///< kPlace
  Pose2 T_world_robot;                      ///< kKidnap
  Way way;                                  ///< kWalk, kDrive
  WheelTravel slip;                         ///< kSlip
};

struct Scenario {
  std::string name;                          ///< for messages: its file
  std::map<std::string, PropShape> objects;  ///< declared here; an event puts them into the world
  std::vector<ScenarioEvent> events;         ///< by time, then by line
};

/// @throws ConfigError with every problem: FILE:LINE, what was found, what was expected.
Scenario parseScenario(std::string_view text, const std::string& file_name);

/// @return one line for each event whose model is neither declared nor one of `models`: FILE:LINE.
std::vector<std::string> unknownModels(const Scenario& scenario, const std::set<std::string>& models);

}  // namespace vismem
