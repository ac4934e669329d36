// Scenarios of any bytes; every accepted one must be playable.
#include <cstdint>
#include <stdexcept>
#include <string_view>

#include "common/config/config_error.h"
#include "simulator/core/props.h"
#include "simulator/core/scenario.h"
#include "simulator/core/scene.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace vismem;
  try {
    const Scenario scenario = parseScenario({reinterpret_cast<const char*>(data), size}, "fuzz.scenario");
    for (const auto& [name, shape] : scenario.objects) {
      if (!checkProp(shape).empty()) throw std::logic_error("a shape that cannot be");
      makeProp(name, shape, Pose3::Identity());
    }
    for (const auto& event : scenario.events) {
      const bool moves =
          event.kind == ScenarioEvent::Kind::kWalk || event.kind == ScenarioEvent::Kind::kDrive;
      if (moves && !checkWay(event.way).empty()) throw std::logic_error("a way that cannot be");
      if (!isFinite(event.T_world_robot) || !event.T_world_model.matrix().allFinite() ||
          !(event.at_s >= 0.0)) {
        throw std::logic_error("a place or time that is none");
      }
    }
    unknownModels(scenario, {"floor"});
  } catch (const ConfigError& error) {
    if (error.problems().empty()) throw std::logic_error("an error without a problem");
  }
  return 0;
}
