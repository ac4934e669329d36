/// @file Single images of a world for people: a camera's view and a view from above.
#pragma once

#include <opencv2/core/mat.hpp>

#include "common/geometry/camera.h"
#include "common/geometry/pose.h"
#include "simulator/core/world.h"

namespace vismem {

class Renderer;
struct TruthImages;

struct View {
  CameraIntrinsics intrinsics;
  Pose3 T_world_camera = Pose3::Identity();
};

/// The view of the simulated robot's camera (320x240, 60 degrees, 0.45 m above the robot).
View robotView(const Pose2& T_world_robot, double pan_rad, double tilt_rad);

cv::Mat renderRobotView(Renderer& renderer, const Pose2& T_world_robot, double pan_rad, double tilt_rad);

/// View of the whole world from far above, x to the right and y up. Bodies wider than 50 m are ignored for
/// its size.
/// @param width of the image [px]; the height follows.
View topView(const World& world, int width = 1000);

/// CV_16U: depth [mm], 0 without a surface or beyond 65.5 m.
cv::Mat pictureOfDepth(const TruthImages& truth);
/// CV_16U: the model's index + 1, 0 without a surface.
cv::Mat pictureOfModels(const TruthImages& truth);

/// `simulator --render ...`.
/// @return the exit code.
int runRenderCommand(int argc, char** argv);

}  // namespace vismem
