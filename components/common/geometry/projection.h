/// @file Projection of segments into the image and back-projection onto the floor. Pure. Implements G2.
/// All pixels here are ideal (undistorted); see camera.h.
#pragma once

#include <optional>

#include "common/geometry/camera.h"
#include "common/geometry/pose.h"
#include "common/geometry/segment.h"

namespace vismem {

/// Segments are cut where they come nearer to the camera's plane than this [m].
constexpr double kNearPlane_m = 0.05;

/// Projects a segment of space into the image, clipped at the near plane and at the image's border
/// (half a pixel outside the outermost centres). Order of the ends is kept.
/// @param T_world_camera pose of the camera in the segment's frame [m].
/// @return the visible part [ideal px]; empty if none.
std::optional<Segment2> projectSegment(const CameraIntrinsics& intrinsics, const Pose3& T_world_camera,
                                       const Segment3& segment_world);

/// As projectSegment, without the clipping at the image's border: L4 measures distances to whole lines.
std::optional<Segment2> projectSegmentUnbounded(const CameraIntrinsics& intrinsics,
                                                const Pose3& T_world_camera, const Segment3& segment_world);

/// The same for many segments seen by one camera. *Pure* after construction.
class SegmentProjector {
 public:
  SegmentProjector(const CameraIntrinsics& intrinsics, const Pose3& T_world_camera)
      : intrinsics_(intrinsics), T_camera_world_(T_world_camera.inverse(Eigen::Isometry)) {}

  /// As projectSegmentUnbounded.
  std::optional<Segment2> unbounded(const Segment3& segment_world) const;
  /// The part of an unbounded projection that lies in the image; empty if none.
  std::optional<Segment2> inImage(const Segment2& unbounded) const;
  /// True if there is such a part.
  bool isInImage(const Segment2& unbounded) const;

 private:
  Eigen::Vector3d toCamera(const Eigen::Vector3d& p_world) const;

  CameraIntrinsics intrinsics_;
  Pose3 T_camera_world_;
};

/// Intersection of the viewing ray of a pixel with the ground plane z = 0 of the world frame.
/// @param max_range_m of the floor point from the point below the camera.
/// @return the floor point [m], z = 0; empty if the ray does not go down, or lands beyond max_range_m.
std::optional<Eigen::Vector3d> backProjectToGround(const CameraIntrinsics& intrinsics,
                                                   const Pose3& T_world_camera,
                                                   const Eigen::Vector2d& px_ideal, double max_range_m);

/// The image of the ground plane's points at infinity: `normal . px + offset` is positive for pixels whose
/// rays go down (floor side) and proportional to the distance from the line [px].
struct HorizonLine {
  Eigen::Vector2d normal = Eigen::Vector2d::UnitY();
  double offset = 0.0;

  double signedDistance(const Eigen::Vector2d& px_ideal) const { return normal.dot(px_ideal) + offset; }
};

/// @return the horizon, its normal of unit length (a zero normal and offset +-1 when the camera looks
/// exactly along the vertical: then all pixels are on one side).
HorizonLine horizonLine(const CameraIntrinsics& intrinsics, const Pose3& T_world_camera);

}  // namespace vismem
