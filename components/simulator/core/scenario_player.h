/// @file A scenario as it happens. Pure.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/routes/route_follower.h"
#include "simulator/core/scenario.h"

namespace vismem {

class Simulation;

/// Makes the events of a scenario happen. *Single-threaded* (owner: the simulation).
class ScenarioPlayer {
 public:
  ScenarioPlayer(Scenario scenario, StampUs begin_us) : scenario_(std::move(scenario)), begin_us_(begin_us) {}

  /// Everything that is due by now. @return what could not be done: FILE:LINE and why.
  std::vector<std::string> play(Simulation& simulation);
  /// The robot was put elsewhere: its way is found again.
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
