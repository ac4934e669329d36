/// @file Which part of the floor can be near to a pixel in the image. Pure. SPEC L4.
#pragma once

#include <Eigen/Core>
#include <span>

#include "common/geometry/camera.h"
#include "common/geometry/pose.h"

namespace vismem {

/// The floor that a pixel shows, and how distances to it on the floor bound distances in the image. A pixel
/// over the horizon shows none and bounds nothing.
class PixelFootprint {
 public:
  /// @param T_robot_camera its floor is z = 0 of the robot's frame [m]. @param px ideal pixel.
  PixelFootprint(const CameraIntrinsics& intrinsics, const Pose3& T_robot_camera, const Eigen::Vector2d& px);

  bool isOnFloor() const { return is_on_floor_; }
  /// The point of the floor that the pixel shows [m].
  const Eigen::Vector2d& p_robot() const { return p_robot_; }
  /// Floor before the camera that is nearer in the image than `px` lies within this of p_robot [m]; infinite
  /// where the horizon is that near.
  double radius(double px) const;
  /// Floor before the camera that is further than this from p_robot is further in the image than [px] ..
  double reach(double radius_m) const;

 private:
  bool is_on_floor_ = false;
  Eigen::Vector2d p_robot_ = Eigen::Vector2d::Zero();
  double sink_ = 0.0;         // of the pixel's ray, per metre along the camera's axis
  double sink_per_px_ = 0.0;  // its change towards the horizon
  double spread_ = 0.0;       // of the floor per pixel, times sink_
};

/// A disc of the floor.
struct FloorDisc {
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  double radius_m = 0.0;
};

/// A disc with all floor that is nearer than `px` to any of some pixels; pixels whose own part is wider than
/// `most_radius_m` are left out. No radius if nothing is left.
FloorDisc floorWithin(std::span<const PixelFootprint> pixels, double px, double most_radius_m);

}  // namespace vismem
