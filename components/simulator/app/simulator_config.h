/// @file The configuration of the process `simulator`. Keys: cfg/sim/simulator.cfg explains each.
#pragma once

#include <filesystem>
#include <vector>

#include "common/config/config_reader.h"
#include "simulator/core/simulation.h"

namespace vismem {

struct SimulatorConfig {
  std::filesystem::path world_file;
  std::vector<std::filesystem::path> model_paths;
  SimulationConfig simulation;  ///< without the world, which is loaded later
  double speed = 1.0;           ///< simulated seconds per second
  bool paused = false;          ///< starts paused
  int lock_step = 0;            ///< number of image consumers that simulated time waits for; 0: real time
  int render_threads = 1;
  std::filesystem::path scenario;  ///< empty: none
};

/// Reads the group `Simulator`; problems stay in the reader.
SimulatorConfig readSimulatorConfig(ConfigReader& config);

}  // namespace vismem
