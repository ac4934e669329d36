#include "simulator/core/world.h"

namespace vismem {
std::optional<int> World::modelNamed(std::string_view wanted) const {
  for (std::size_t i = 0; i < models.size(); ++i) {
    if (models[i].name == wanted) return static_cast<int>(i);
  }
  return std::nullopt;
}

int World::bodyCount() const {
  std::size_t count = 0;
  for (const auto& model : models) count += model.bodies.size();
  return static_cast<int>(count);
}

std::vector<WorldObstacle> obstaclesAt(const WorldModel& model, const Pose3& T_world_model) {
  std::vector<WorldObstacle> result;
  const Pose2 T_world_plan = toPose2(T_world_model);
  const double z = T_world_model.translation().z();
  for (const auto& obstacle : model.outlines) {
    if (z + obstacle.low_m > kRobotBodyTop_m || z + obstacle.high_m < kRobotBodyBottom_m) continue;
    WorldObstacle placed{model.name + "/" + obstacle.name, {}};
    for (const auto& p : obstacle.outline) placed.outline.push_back(transform(T_world_plan, p));
    result.push_back(std::move(placed));
  }
  return result;
}

std::vector<WorldObstacle> obstaclesOf(const World& world) {
  std::vector<WorldObstacle> result;
  for (const auto& model : world.models) {
    for (auto& obstacle : obstaclesAt(model, model.pose)) result.push_back(std::move(obstacle));
  }
  return result;
}

std::string LoadedWorld::summary() const {
  return std::to_string(visuals_shown) + " of " + std::to_string(visuals) + " visuals";
}

}  // namespace vismem
