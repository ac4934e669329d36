#include "simulator/core/scenario_player.h"

#include <utility>

#include "simulator/core/simulation.h"

namespace vismem {
namespace {

/// Period of the simulated operator's commands [us].
constexpr StampUs kDriving_us = 50'000;

}  // namespace

void ScenarioPlayer::lost() {
  if (driver_) driver_->lost();
}

std::vector<std::string> ScenarioPlayer::play(Simulation& simulation) {
  std::vector<std::string> problems;
  const double now_s = toSeconds(simulation.now() - begin_us_);
  for (; next_ < scenario_.events.size() && scenario_.events[next_].at_s <= now_s; ++next_) {
    const ScenarioEvent& event = scenario_.events[next_];
    const PortReply reply = happen(event, simulation);
    if (!reply.ok())
      problems.push_back(scenario_.name + ":" + std::to_string(event.line) + ": " + reply.message);
  }
  if (driver_ && simulation.now() - driven_us_ >= kDriving_us) {
    driven_us_ = simulation.now();
    const DriveCommand command = driver_->drive(simulation.truth().T_world_robot);
    simulation.driveByScenario(command.v_mps, command.w_radps);
  }
  return problems;
}

PortReply ScenarioPlayer::happen(const ScenarioEvent& event, Simulation& simulation) {
  using Kind = ScenarioEvent::Kind;
  MovingWorld& scene = simulation.scene();
  const auto shape = scenario_.objects.find(event.model);
  const bool to_add = shape != scenario_.objects.end() && !scene.find(event.model);
  switch (event.kind) {
    case Kind::kPlace:
      return to_add ? scene.add(event.model, shape->second, event.T_world_model)
                    : scene.place(event.model, event.T_world_model);
    case Kind::kRemove:
      return scene.remove(event.model);
    case Kind::kWalk: {
      if (to_add) {
        const Eigen::Vector2d& first = event.way.points.front();
        const PortReply reply =
            scene.add(event.model, shape->second, toPose3(Pose2{first.x(), first.y(), 0.0}));
        if (!reply.ok()) return reply;
      }
      return scene.walk(event.model, event.way);
    }
    case Kind::kStand:
      return scene.stand(event.model);
    case Kind::kKidnap:
      return simulation.kidnap(event.T_world_robot);
    case Kind::kSlip:
      return simulation.slip(event.slip);
    case Kind::kDrive: {
      RouteFollowerParams params;
      params.speed_mps = event.way.speed_mps;
      driver_.emplace(Route{event.way.points, event.way.closed}, params);
      return PortReply::accepted();
    }
    case Kind::kHalt:
      driver_.reset();
      simulation.driveByScenario(0.0, 0.0);
      return PortReply::accepted();
  }
  return PortReply::accepted();
}

}  // namespace vismem
