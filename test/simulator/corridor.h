/// @file The shipped corridor for tests of the simulator.
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <string_view>

#include "common/kinematics/random_stream.h"
#include "simulator/core/simulation.h"
#include "support/build_paths.h"

namespace vismem::test {

inline const World& corridor() {
  static const World world = loadWorld(VISMEM_SOURCE_DIR "/cfg/worlds/corridor.world").world;
  return world;
}

/// A robot in it with a camera of 10 Hz.
inline SimulationConfig inCorridor() {
  SimulationConfig config;
  config.world = corridor();
  config.start = {-3.0, 2.25, 0.0};
  config.cameras.front().rate_hz = 10.0;
  return config;
}

/// Drives for a while.
inline void drive(Simulation& simulation, double seconds, double v_mps, double w_radps) {
  for (const StampUs until = simulation.now() + toStampUs(seconds); simulation.now() < until;) {
    simulation.base().setVelocity(v_mps, w_radps);
    simulation.step();
  }
}

inline std::uint64_t hashOf(const cv::Mat& image) {
  return fnv1a({reinterpret_cast<const char*>(image.data), image.total() * image.elemSize()});
}

}  // namespace vismem::test
