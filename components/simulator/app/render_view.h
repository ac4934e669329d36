/// @file Single pictures of a world for people: a camera's view and a view from above.
#pragma once

#include <opencv2/core/mat.hpp>

#include "common/geometry/pose.h"
#include "simulator/core/world.h"

namespace vismem {

class Renderer;

/// What the simulated robot's camera would see without noise (320x240, 60 degrees, 0.45 m above the robot).
cv::Mat renderRobotView(Renderer& renderer, const Pose2& T_world_robot, double pan_rad, double tilt_rad);

/// The whole world from far above, x to the right and y up. Bodies wider than 50 m do not count for its size.
/// @param width of the image [px]; the height follows.
cv::Mat renderTopView(Renderer& renderer, const World& world, int width = 1000);

/// `simulator --render ...`. @return the exit code.
int runRenderCommand(int argc, char** argv);

}  // namespace vismem
