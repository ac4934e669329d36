#include "experiments/trials/visible_pieces.h"

#include <algorithm>
#include <cmath>

#include "common/geometry/projection.h"

namespace vismem {
namespace {

/// A ray that ends this little before an edge met what the edge belongs to.
constexpr double kTolerance_m = 0.03;
/// Brightness is compared this far from the edge.
constexpr double kBeside_px = 3.0;
constexpr int kMostRays = 120;
/// The outermost pixels reach 0.5 px beyond their centres; rays come in steps.
constexpr double kBorder_px = 0.5;

/// The point of a segment of space that a pixel on its image shows. Both in camera coordinates.
Eigen::Vector3d pointShown(const CameraIntrinsics& intrinsics, const Eigen::Vector3d& a,
                           const Eigen::Vector3d& b, const Eigen::Vector2d& px) {
  const Eigen::Vector3d ray = idealPixelRay(intrinsics, px);
  const Eigen::Vector3d d = b - a;
  // (a + t d) is parallel to the ray: one equation for each of x and y; the better conditioned one counts.
  const double by_x = d.x() - ray.x() * d.z();
  const double by_y = d.y() - ray.y() * d.z();
  const double t = std::abs(by_x) > std::abs(by_y) ? (ray.x() * a.z() - a.x()) / by_x
                   : by_y != 0.0                   ? (ray.y() * a.z() - a.y()) / by_y
                                                   : 0.5;
  return a + std::clamp(t, 0.0, 1.0) * d;
}

bool brighterOnTheLeft(const CameraIntrinsics& intrinsics, const Pose3& T_world_camera, const CastRay& cast,
                       const Segment2& px) {
  const Eigen::Vector2d d = (px.b - px.a).normalized();
  const Eigen::Vector2d left = px.middle() + kBeside_px * Eigen::Vector2d(d.y(), -d.x());
  const Eigen::Vector2d right = px.middle() - kBeside_px * Eigen::Vector2d(d.y(), -d.x());
  const auto brightness = [&](const Eigen::Vector2d& at) {
    const Eigen::Vector3d direction = T_world_camera.linear() * idealPixelRay(intrinsics, at).normalized();
    const auto seen = cast(T_world_camera.translation(), direction);
    return seen ? seen->brightness : 0.0;
  };
  return brightness(left) >= brightness(right);
}

}  // namespace

bool isAtBorder(const CameraIntrinsics& intrinsics, const Eigen::Vector2d& px) {
  return px.x() < kBorder_px || px.y() < kBorder_px || px.x() > intrinsics.width - 1.0 - kBorder_px ||
         px.y() > intrinsics.height - 1.0 - kBorder_px;
}

std::vector<VisiblePiece> visiblePieces(const SegmentMap& edges, const CameraIntrinsics& intrinsics,
                                        const Pose3& T_world_camera, const CastRay& cast,
                                        const VisiblePiecesParams& params) {
  std::vector<VisiblePiece> pieces;
  const Pose3 T_camera_world = T_world_camera.inverse();
  const Eigen::Vector3d eye = T_world_camera.translation();
  for (std::size_t i = 0; i < edges.segments.size(); ++i) {
    const Segment3& edge = edges.segments[i].world;
    if (distanceToSegment(eye, edge) > params.farthest_m) continue;
    const auto px = projectSegment(intrinsics, T_world_camera, edge);
    if (!px || px->length() < params.least_px) continue;
    const Eigen::Vector3d a = T_camera_world * edge.a;
    const Eigen::Vector3d b = T_camera_world * edge.b;
    const int rays = std::clamp(static_cast<int>(px->length() / params.step_px), 1, kMostRays);
    std::optional<int> begin;
    for (int k = 0; k <= rays; ++k) {
      bool visible = false;
      if (k < rays) {
        const Eigen::Vector2d at = px->a + (k + 0.5) / rays * (px->b - px->a);
        const Eigen::Vector3d p = T_world_camera * pointShown(intrinsics, a, b, at);
        const double range = (p - eye).norm();
        const auto seen = cast(eye, (p - eye) / range);
        visible = !seen || seen->distance_m >= range - kTolerance_m;
      }
      if (visible && !begin) begin = k;
      if (visible || !begin) continue;
      VisiblePiece piece;
      piece.edge = static_cast<int>(i);
      piece.px.a = px->a + static_cast<double>(*begin) / rays * (px->b - px->a);
      piece.px.b = px->a + static_cast<double>(k) / rays * (px->b - px->a);
      begin.reset();
      if (piece.px.length() < params.least_px) continue;
      piece.range_m = pointShown(intrinsics, a, b, piece.px.middle()).norm();
      if (!brighterOnTheLeft(intrinsics, T_world_camera, cast, piece.px)) std::swap(piece.px.a, piece.px.b);
      pieces.push_back(piece);
    }
  }
  return pieces;
}

}  // namespace vismem
