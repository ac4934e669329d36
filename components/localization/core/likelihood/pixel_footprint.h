/// @file The part of the floor that projects near a pixel. Pure. See L4.
#pragma once

#include <Eigen/Core>
#include <span>

#include "common/geometry/camera.h"
#include "common/geometry/pose.h"

namespace vismem {

/// The floor point of a pixel, with bounds between distances on the floor and distances in the image. A pixel
/// above the horizon has no floor point and no bounds.
class PixelFootprint {
 public:
  /// @param T_robot_camera [m]; the floor is z = 0 of the robot's frame.
  /// @param px ideal pixel.
  PixelFootprint(const CameraIntrinsics& intrinsics, const Pose3& T_robot_camera, const Eigen::Vector2d& px);

  bool isOnFloor() const { return is_on_floor_; }
  /// Floor point of the pixel [m].
  const Eigen::Vector2d& p_robot() const { return p_robot_; }
  /// Radius about p_robot that contains all floor in front of the camera within `px` in the image [m];
  /// infinite if the horizon is within `px`.
  double radius(double px) const;
  /// Lower bound of the image distance of floor further than `radius_m` from p_robot [px].
  double reach(double radius_m) const;

 private:
  bool is_on_floor_ = false;
  Eigen::Vector2d p_robot_ = Eigen::Vector2d::Zero();
  double sink_ = 0.0;         // descent of the pixel's ray per metre along the camera's axis
  double sink_per_px_ = 0.0;  // its change towards the horizon
  double spread_ = 0.0;       // of the floor per pixel, times sink_
};

/// A disc of the floor.
struct FloorDisc {
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  double radius_m = 0.0;
};

/// A disc that contains all floor within `px` of any of the pixels. Pixels whose own radius exceeds
/// `most_radius_m` are left out; the radius is 0 if none remains.
FloorDisc floorWithin(std::span<const PixelFootprint> pixels, double px, double most_radius_m);

}  // namespace vismem
