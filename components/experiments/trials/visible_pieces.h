/// @file Which parts of a map's edges an image shows, by rays in the world itself. Pure. SPEC L3, E5-E8.
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

/// What a ray meets first.
struct SeenSurface {
  double distance_m = 0.0;
  double brightness = 0.0;  ///< 0..1
};
/// @param direction of unit length. @return empty when the ray meets nothing.
using CastRay = std::function<std::optional<SeenSurface>(const Eigen::Vector3d& origin,
                                                         const Eigen::Vector3d& direction)>;

/// A connected visible part of one edge of the map.
struct VisiblePiece {
  int edge = 0;          ///< index into the map's segments
  Segment2 px;           ///< ideal pixels; the brighter side lies to the left of a -> b (see ImageSegment)
  double range_m = 0.0;  ///< of its middle from the camera
  /// The edge goes on beyond that end, behind something nearer; an outline, before something else.
  bool hidden_a = false;
  bool hidden_b = false;
  /// Not the edge, but the upright outline of a wall above its end (visibleOutlines).
  bool is_outline = false;
};

struct VisiblePiecesParams {
  double step_px = 4.0;      ///< between the rays along an edge
  double least_px = 4.0;     ///< shorter pieces are left out
  double farthest_m = 12.0;  ///< edges that are nowhere nearer are left out
};

/// True for an end of a piece where the image's border cuts it.
bool isAtBorder(const CameraIntrinsics& intrinsics, const Eigen::Vector2d& px);

/// @param edges stripes expanded. @param T_world_camera the true one.
std::vector<VisiblePiece> visiblePieces(const SegmentMap& edges, const CameraIntrinsics& intrinsics,
                                        const Pose3& T_world_camera, const CastRay& cast,
                                        const VisiblePiecesParams& params = {});

/// Upright outlines of walls above the ends of floor edges, as far as floor is seen behind them: the same
/// colours meet there as at the edge, so a detector gives them its label, though no such line lies on the
/// floor. Ends above which the map has an upright edge of its own are left out.
std::vector<VisiblePiece> visibleOutlines(const SegmentMap& edges, const CameraIntrinsics& intrinsics,
                                          const Pose3& T_world_camera, const CastRay& cast,
                                          const VisiblePiecesParams& params = {});

}  // namespace vismem
