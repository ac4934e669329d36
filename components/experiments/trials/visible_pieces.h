/// @file The parts of a map's edges that an image shows, by rays in the world. Pure. See L3, E5, E6, E7, E8.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <vector>

#include "common/geometry/camera.h"
#include "common/geometry/pose.h"
#include "common/geometry/segment.h"
#include "common/segment_map/segment_map.h"

namespace vismem {

/// The first surface on a ray.
struct SeenSurface {
  double distance_m = 0.0;
  double brightness = 0.0;  ///< 0..1
};
/// @param direction of unit length.
/// @return empty when there is no surface on the ray.
using CastRay = std::function<std::optional<SeenSurface>(const Eigen::Vector3d& origin,
                                                         const Eigen::Vector3d& direction)>;

/// A connected visible part of one edge of the map.
struct VisiblePiece {
  int edge = 0;          ///< index into the map's segments
  Segment2 px;           ///< ideal pixels; the brighter side lies to the left of a -> b (see ImageSegment)
  double range_m = 0.0;  ///< of its middle from the camera
  /// The edge continues beyond that end behind a nearer surface (an outline: in front of another one).
  bool hidden_a = false;
  bool hidden_b = false;
  /// The piece is the upright outline of a wall above the edge's end (visibleOutlines).
  bool is_outline = false;
};

struct VisiblePiecesParams {
  double step_px = 4.0;      ///< between the rays along an edge
  double least_px = 4.0;     ///< shorter pieces are left out
  double farthest_m = 12.0;  ///< farther edges are left out
};

/// @return whether the image's border cuts a piece at this end.
bool isAtBorder(const CameraIntrinsics& intrinsics, const Eigen::Vector2d& px);

/// @param edges stripes expanded.
/// @param T_world_camera the true one.
std::vector<VisiblePiece> visiblePieces(const SegmentMap& edges, const CameraIntrinsics& intrinsics,
                                        const Pose3& T_world_camera, const CastRay& cast,
                                        const VisiblePiecesParams& params = {});

/// Upright outlines of walls above the ends of floor edges, where floor is visible behind them. Their colours
/// are those of the edge, so a detector gives them its label although no such line lies on the floor. Ends
/// below an upright edge of the map are left out.
std::vector<VisiblePiece> visibleOutlines(const SegmentMap& edges, const CameraIntrinsics& intrinsics,
                                          const Pose3& T_world_camera, const CastRay& cast,
                                          const VisiblePiecesParams& params = {});

}  // namespace vismem
