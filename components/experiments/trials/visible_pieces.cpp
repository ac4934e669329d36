#include "experiments/trials/visible_pieces.h"

#include <algorithm>
#include <cmath>

#include "common/geometry/projection.h"

namespace vismem {
namespace {

/// Tolerance of a ray's length up to a visible edge.
constexpr double kTolerance_m = 0.03;
/// Brightness is compared this far from the edge.
constexpr double kBeside_px = 3.0;
constexpr int kMostRays = 120;
/// The outermost pixels reach 0.5 px beyond their centres; rays come in steps.
constexpr double kBorder_px = 0.5;
/// Largest distance between ends of edges at one corner.
constexpr double kSameEnd_m = 0.02;
constexpr double kOnFloor_m = 0.02;
constexpr double kHighest_m = 2.5;  ///< outlines are looked for up to there
/// Largest difference in range between a wall and its outline.
constexpr double kWallWithin_m = 0.3;
/// Surfaces at an outline are sampled this far from it; lower points than this are floor.
constexpr double kBesideOutline_px = 1.0;
constexpr double kFloorSeen_m = 0.003;
/// Accuracy of the ends of visible parts.
constexpr double kHiddenTo_px = 0.2;

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

/// Of a line, as fractions of its length.
struct Part {
  double begin = 0.0;
  double end = 1.0;
};

/// The parts of a line of this length in the image that are visible.
template <typename IsVisible>
std::vector<Part> visibleParts(double length_px, double step_px, const IsVisible& isVisible) {
  const auto between = [&](double shown, double hidden) {
    while (std::abs(hidden - shown) * length_px > kHiddenTo_px) {
      const double middle = 0.5 * (shown + hidden);
      (isVisible(middle) ? shown : hidden) = middle;
    }
    return 0.5 * (shown + hidden);
  };
  const int rays = std::clamp(static_cast<int>(length_px / step_px), 1, kMostRays);
  const auto rayAt = [rays](int k) { return (k + 0.5) / rays; };
  std::vector<Part> parts;
  bool was_visible = false;
  for (int k = 0; k < rays; ++k) {
    const bool is_visible = isVisible(rayAt(k));
    if (is_visible && !was_visible) parts.push_back({k == 0 ? 0.0 : between(rayAt(k), rayAt(k - 1)), 1.0});
    if (was_visible && !is_visible) parts.back().end = between(rayAt(k - 1), rayAt(k));
    was_visible = is_visible;
  }
  return parts;
}

/// A part of a line in the image; its edge, range and brighter side are set later.
VisiblePiece pieceOf(const Segment2& px, const Part& part) {
  VisiblePiece piece;
  piece.px.a = px.a + part.begin * (px.b - px.a);
  piece.px.b = px.a + part.end * (px.b - px.a);
  piece.hidden_a = part.begin > 0.0;
  piece.hidden_b = part.end < 1.0;
  return piece;
}

void turnRound(VisiblePiece& piece) {
  std::swap(piece.px.a, piece.px.b);
  std::swap(piece.hidden_a, piece.hidden_b);
}

bool standsAbove(const MapSegment& edge, const Eigen::Vector3d& foot) {
  return std::abs(edge.world.a.z() - edge.world.b.z()) > kSameEnd_m &&
         std::min((edge.world.a - foot).norm(), (edge.world.b - foot).norm()) <= kSameEnd_m;
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
    const auto isVisible = [&](double fraction) {
      const Eigen::Vector2d at = px->a + fraction * (px->b - px->a);
      const Eigen::Vector3d p = T_world_camera * pointShown(intrinsics, a, b, at);
      const double range = (p - eye).norm();
      const auto seen = cast(eye, (p - eye) / range);
      return !seen || seen->distance_m >= range - kTolerance_m;
    };
    for (const Part& part : visibleParts(px->length(), params.step_px, isVisible)) {
      VisiblePiece piece = pieceOf(*px, part);
      piece.edge = static_cast<int>(i);
      if (piece.px.length() < params.least_px) continue;
      piece.range_m = pointShown(intrinsics, a, b, piece.px.middle()).norm();
      if (!brighterOnTheLeft(intrinsics, T_world_camera, cast, piece.px)) turnRound(piece);
      pieces.push_back(piece);
    }
  }
  return pieces;
}

std::vector<VisiblePiece> visibleOutlines(const SegmentMap& edges, const CameraIntrinsics& intrinsics,
                                          const Pose3& T_world_camera, const CastRay& cast,
                                          const VisiblePiecesParams& params) {
  const Eigen::Vector3d eye = T_world_camera.translation();
  const Pose3 T_camera_world = T_world_camera.inverse();
  std::vector<Eigen::Vector3d> corners;
  std::vector<VisiblePiece> outlines;
  for (std::size_t i = 0; i < edges.segments.size(); ++i) {
    const Segment3& edge = edges.segments[i].world;
    if (std::max(std::abs(edge.a.z()), std::abs(edge.b.z())) > kOnFloor_m) continue;
    for (const Eigen::Vector3d& foot : {edge.a, edge.b}) {
      if ((foot - eye).norm() > params.farthest_m) continue;
      const auto isHere = [&](const Eigen::Vector3d& other) { return (other - foot).norm() <= kSameEnd_m; };
      if (std::any_of(corners.begin(), corners.end(), isHere)) continue;
      corners.push_back(foot);
      if (std::any_of(edges.segments.begin(), edges.segments.end(),
                      [&](const MapSegment& other) { return standsAbove(other, foot); })) {
        continue;
      }
      const Segment3 upright{foot, foot + kHighest_m * Eigen::Vector3d::UnitZ()};
      const auto px = projectSegment(intrinsics, T_world_camera, upright);
      if (!px || px->length() < params.least_px) continue;
      const Eigen::Vector3d a = T_camera_world * upright.a;
      const Eigen::Vector3d b = T_camera_world * upright.b;
      const Eigen::Vector2d along = (px->b - px->a).normalized();
      const Eigen::Vector2d beside = kBesideOutline_px * Eigen::Vector2d(along.y(), -along.x());
      enum class Seen { kFloor, kWall, kOther };
      const auto seenAt = [&](const Eigen::Vector2d& at, double range) {
        const Eigen::Vector3d direction =
            T_world_camera.linear() * idealPixelRay(intrinsics, at).normalized();
        const auto seen = cast(eye, direction);
        if (!seen) return Seen::kOther;
        if (eye.z() + seen->distance_m * direction.z() <= kFloorSeen_m) return Seen::kFloor;
        return std::abs(seen->distance_m - range) <= kWallWithin_m ? Seen::kWall : Seen::kOther;
      };
      const auto isOutline = [&](double fraction) {
        const Eigen::Vector2d at = px->a + fraction * (px->b - px->a);
        const double range = pointShown(intrinsics, a, b, at).norm();
        const Seen left = seenAt(at + beside, range);
        const Seen right = seenAt(at - beside, range);
        return (left == Seen::kFloor && right == Seen::kWall) ||
               (left == Seen::kWall && right == Seen::kFloor);
      };
      for (const Part& part : visibleParts(px->length(), params.step_px, isOutline)) {
        VisiblePiece piece = pieceOf(*px, part);
        piece.edge = static_cast<int>(i);
        piece.is_outline = true;
        if (piece.px.length() < params.least_px) continue;
        piece.range_m = pointShown(intrinsics, a, b, piece.px.middle()).norm();
        if (!brighterOnTheLeft(intrinsics, T_world_camera, cast, piece.px)) turnRound(piece);
        outlines.push_back(piece);
      }
    }
  }
  return outlines;
}

}  // namespace vismem
