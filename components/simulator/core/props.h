/// @file Simple models that scenarios and callers put into a world. Pure.
#pragma once

#include <Eigen/Core>
#include <string>

#include "common/robot/control_ports.h"
#include "simulator/core/world.h"

namespace vismem {

/// Builds a model whose origin lies at its bottom. kRobot: a round base with a pillar up to its height, which
/// fills much of another robot's view.
/// @return the problem of the shape; empty if it is valid.
std::string checkProp(const PropShape& shape);
WorldModel makeProp(const std::string& name, const PropShape& shape, const Pose3& T_world_model);

}  // namespace vismem
