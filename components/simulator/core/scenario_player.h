/// @file Execution of a scenario. Pure.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/routes/route_follower.h"
#include "simulator/core/scenario.h"

namespace vismem {

class Simulation;

/// Executes the events of a scenario. *Single-threaded* (owner: the simulation).
class ScenarioPlayer {
 public:
  ScenarioPlayer(Scenario scenario, StampUs begin_us) : scenario_(std::move(scenario)), begin_us_(begin_us) {}

  /// Executes all due events.
  /// @return one line for each event that failed: FILE:LINE and the reason.
  std::vector<std::string> play(Simulation& simulation);
  /// To be called after a kidnapping: the driver continues at the nearest place of its path.
  void lost();
  const std::string& name() const { return scenario_.name; }

 private:
  PortReply happen(const ScenarioEvent& event, Simulation& simulation);

  Scenario scenario_;
  StampUs begin_us_;
  std::size_t next_ = 0;
  std::optional<SimulatedOperator> driver_;
  StampUs driven_us_ = 0;
};

}  // namespace vismem
