/// @file Simple models that scenarios and callers put into a world. Pure.
#pragma once

#include <Eigen/Core>
#include <string>

#include "common/robot/control_ports.h"
#include "simulator/core/world.h"

namespace vismem {

/// Builds a model that stands on its origin. kRobot: a round base with a pillar up to its height, which fills
/// much of another robot's view. @return what is wrong with the shape; empty if nothing is.
std::string checkProp(const PropShape& shape);
WorldModel makeProp(const std::string& name, const PropShape& shape, const Pose3& T_world_model);

}  // namespace vismem
