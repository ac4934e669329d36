#include "evaluation/core/map_projection.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/geometry/projection.h"
#include "evaluation/core/metrics.h"

namespace vismem {
namespace {

/// Points on a segment, ends included, at most step_px apart.
std::vector<Eigen::Vector2d> samples(const Segment2& px, double step_px) {
  const int pieces = std::max(1, static_cast<int>(std::ceil(px.length() / step_px)));
  std::vector<Eigen::Vector2d> points;
  for (int i = 0; i <= pieces; ++i) points.emplace_back(px.a + (px.b - px.a) * i / pieces);
  return points;
}

double nearest(const Eigen::Vector2d& p, const std::vector<Segment2>& segments) {
  double distance = std::numeric_limits<double>::infinity();
  for (const Segment2& s : segments) distance = std::min(distance, distanceToSegment(p, s));
  return distance;
}

bool isOnMap(const Label& label, const std::vector<MapSegment>& edges) {
  return std::any_of(edges.begin(), edges.end(),
                     [&](const MapSegment& e) { return labelFitsMap(label, e.label); });
}

}  // namespace

std::vector<Segment2> projectMap(const std::vector<MapSegment>& edges, const CameraIntrinsics& intrinsics,
                                 const Pose3& T_world_camera, double max_range_m) {
  std::vector<Segment2> visible;
  for (const MapSegment& edge : edges) {
    const auto near = clipToDisc(edge.world.floor(), T_world_camera.translation().head<2>(), max_range_m);
    if (!near) continue;
    const Eigen::Vector3d along = edge.world.b - edge.world.a;
    const Segment3 inside{edge.world.a + near->first * along, edge.world.a + near->second * along};
    if (const auto px = projectSegment(intrinsics, T_world_camera, inside)) visible.push_back(*px);
  }
  return visible;
}

std::optional<MapProjectionDistance> mapProjectionDistance(const JudgedImage& image,
                                                           const std::vector<MapSegment>& edges,
                                                           const MapProjectionParams& params) {
  // Which detected points lie on the floor within the range does not depend on the judged pose.
  std::vector<Segment2> detected;
  std::vector<Eigen::Vector2d> detected_points;
  for (const ImageSegment& segment : image.observed) {
    if (!isOnMap(segment.label, edges)) continue;
    bool in_range = false;
    for (const Eigen::Vector2d& p : samples(segment.px, params.step_px)) {
      if (!backProjectToGround(image.intrinsics, image.T_robot_camera, p, params.max_range_m)) continue;
      detected_points.push_back(p);
      in_range = true;
    }
    if (in_range) detected.push_back(segment.px);
  }
  if (detected_points.empty()) return std::nullopt;

  const double diagonal = std::hypot(image.intrinsics.width, image.intrinsics.height);
  MapProjectionDistance distance{diagonal, diagonal};
  if (!image.T_world_robot) return distance;
  const Pose3 T_world_camera = toPose3(*image.T_world_robot) * image.T_robot_camera;
  // Further than the range of the samples, so that a point at its border keeps its own line.
  const std::vector<Segment2> projected =
      projectMap(edges, image.intrinsics, T_world_camera, 1.5 * params.max_range_m);
  if (projected.empty()) return distance;

  std::vector<double> distances;
  for (const Eigen::Vector2d& p : detected_points) {
    distances.push_back(std::min(diagonal, nearest(p, projected)));
  }
  distance.detected_to_map_px = *median(std::move(distances));

  std::vector<double> back;
  for (const Segment2& s : projectMap(edges, image.intrinsics, T_world_camera, params.max_range_m)) {
    for (const Eigen::Vector2d& p : samples(s, params.step_px)) back.push_back(nearest(p, detected));
  }
  if (!back.empty()) distance.map_to_detected_px = std::min(diagonal, *median(std::move(back)));
  return distance;
}

MapProjectionScore scoreMapProjection(const std::vector<JudgedImage>& images, const SegmentMap& edges,
                                      const MapProjectionParams& params) {
  MapProjectionScore score;
  std::vector<double> detected_to_map;
  std::vector<double> map_to_detected;
  for (const JudgedImage& image : images) {
    const auto distance = mapProjectionDistance(image, edges.segments, params);
    if (!distance) {
      ++score.images_without_lines;
      continue;
    }
    ++score.images;
    if (!image.T_world_robot) ++score.images_without_pose;
    detected_to_map.push_back(distance->detected_to_map_px);
    map_to_detected.push_back(distance->map_to_detected_px);
  }
  score.detected_to_map_px = median(std::move(detected_to_map));
  score.map_to_detected_px = median(std::move(map_to_detected));
  return score;
}

std::optional<Pose2> carriedPose(const std::vector<PoseEstimate>& estimates, StampUs stamp_us,
                                 const Pose2& T_odom_robot, StampUs max_age_us) {
  const auto after =
      std::upper_bound(estimates.begin(), estimates.end(), stamp_us,
                       [](StampUs stamp, const PoseEstimate& e) { return stamp < e.stamp_us; });
  if (after == estimates.begin()) return std::nullopt;
  const PoseEstimate& estimate = *std::prev(after);
  if (!estimate.T_world_robot || stamp_us - estimate.stamp_us > max_age_us) return std::nullopt;
  return *estimate.T_world_robot * inverse(estimate.T_odom_robot) * T_odom_robot;
}

}  // namespace vismem
