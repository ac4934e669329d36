/// @file Pixels in which narrow bodies may lie between the pixels' centres. Private to Renderer.
#pragma once

#include <vector>

#include "common/geometry/camera.h"
#include "common/geometry/segment.h"
#include "simulator/core/renderer_scene.h"
#include "simulator/core/world.h"

namespace vismem {

/// The creases of bodies that rays through pixel centres easily miss: painted lines, legs, poles, flat bodies
/// on the floor. Without more rays along their creases they would be rendered dashed in the distance.
/// *Single-threaded.*
class NarrowBodies {
 public:
  /// Adds models in the order of their indices. Bodies of many triangles are left out, because their cost
  /// exceeds their effect.
  void add(const WorldModel& model);

  /// Marks the pixels on creases.
  /// @param low, high the image's corners in ideal pixels.
  /// @param marks width * height; not zero: marked. Empty if no body is narrow.
  void mark(const CameraIntrinsics& k, const Pose3& T_world_camera, const Eigen::Vector2d& low,
            const Eigen::Vector2d& high, const RenderScene& scene, std::vector<char>& marks) const;

 private:
  struct Crease {
    Segment3 line;       ///< in its model [m]
    double far_m = 0.0;  ///< times the focal length: nearer it is wider than some pixels
  };
  struct Model {
    std::vector<Crease> creases;
  };
  std::vector<Model> models_;
};

}  // namespace vismem
