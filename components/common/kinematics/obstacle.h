/// @file An obstacle of a robot on the floor. Pure value.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace vismem {

/// Outline of a collision shape at the robot's height, convex, counter-clockwise, world plan view [m].
struct WorldObstacle {
  std::string name;
  std::vector<Eigen::Vector2d> outline;
};

}  // namespace vismem
