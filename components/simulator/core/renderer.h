/// @file Ray-traced camera images of a world. DESIGN 6.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>

#include "common/geometry/camera.h"
#include "common/geometry/pose.h"
#include "simulator/core/world.h"

namespace vismem {

/// What a ray meets.
struct RayHit {
  double distance_m = 0.0;                            ///< along the ray, for a direction of unit length
  int body = 0;                                       ///< index into World::bodies
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< of unit length, towards where the ray came from
  Eigen::Vector3f color = Eigen::Vector3f::Zero();    ///< as the camera sees it, R G B, 0..1
  bool from_inside = false;                           ///< the ray began inside the body
};

/// Renders a fixed world. *Single-threaded* (owner: the simulation). The same world, camera and pose give the
/// same bytes on one machine.
class Renderer {
 public:
  explicit Renderer(const World& world);
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  /// A CV_8UC3 image in the order R, G, B. One ray a pixel through its centre, bent exactly as the lens does;
  /// pixels beside another body or a step of brightness get four rays.
  cv::Mat render(const CameraIntrinsics& intrinsics, const Pose3& T_world_camera);

  /// The first surface from `origin` [m] along `direction`; empty if none.
  std::optional<RayHit> cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace vismem
