/// @file Where in an image narrow bodies may lie between the pixels' centres. Private to Renderer.
#pragma once

#include <vector>

#include "common/geometry/camera.h"
#include "common/geometry/segment.h"
#include "simulator/core/renderer_scene.h"
#include "simulator/core/world.h"

namespace vismem {

/// The creases of bodies that a ray through a pixel's centre easily misses: painted lines, legs, poles,
/// whatever lies flat on the floor. Far away they would come out dashed; the pixels along their creases get
/// more rays. *Single-threaded.*
class NarrowBodies {
 public:
  /// Of models in the order of their indices. Bodies of many triangles are left out: they would cost more
  /// than they show.
  void add(const WorldModel& model);

  /// Marks the pixels that creases pass. @param low, high the image's corners in ideal pixels.
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
