#include "synthetic_drive.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <random>

#include "common/geometry/angles.h"
#include "common/geometry/camera.h"
#include "common/geometry/projection.h"

namespace vismem {
namespace {

constexpr double kStep_m = 0.25;
constexpr double kTurn_rad = 15.0 * 3.14159265358979323846 / 180.0;
constexpr double kHeight_m = 0.45;
constexpr double kTilt_rad = -0.35;
constexpr double kLeast_px = 12.0;

/// A straight wall cut by doors: pieces of skirting and door feet.
void addWall(std::vector<TrueFloorEdge>& edges, const Eigen::Vector2d& from, const Eigen::Vector2d& to,
             const std::vector<std::pair<double, double>>& doors) {
  const Eigen::Vector2d u = (to - from).normalized();
  double at = 0.0;
  const auto piece = [&](double a, double b, const char* label) {
    edges.push_back({{from + a * u, from + b * u}, label});
  };
  for (const auto& [begin, end] : doors) {
    piece(at, begin, "skirting");
    piece(begin, end, "door_foot");
    at = end;
  }
  piece(at, (to - from).norm(), "skirting");
}

struct View {
  CameraIntrinsics intrinsics;
  Pose3 T_world_camera;
};

/// The visible part of an edge; censored where range or the image's border cut it.
std::optional<LineSighting> see(const TrueFloorEdge& edge, const View& view, double range_m) {
  Segment2 floor = edge.world;
  const Eigen::Vector2d below = view.T_world_camera.translation().head<2>();
  bool cut_a = false;
  bool cut_b = false;
  const auto shorten = [&](Eigen::Vector2d& p, const Eigen::Vector2d& other, bool& cut) {
    constexpr int kSteps = 400;
    for (int i = 0; i < kSteps && (p - below).norm() > range_m; ++i, cut = true) p += (other - p) / kSteps;
  };
  const Segment2 whole = floor;
  shorten(floor.a, whole.b, cut_a);
  shorten(floor.b, whole.a, cut_b);
  const Segment3 world{{floor.a.x(), floor.a.y(), 0.0}, {floor.b.x(), floor.b.y(), 0.0}};
  const auto unbounded = projectSegmentUnbounded(view.intrinsics, view.T_world_camera, world);
  const auto px = projectSegment(view.intrinsics, view.T_world_camera, world);
  if (!px || !unbounded || px->length() < kLeast_px) return std::nullopt;
  LineSighting sighting;
  sighting.px = *px;
  sighting.censored_a = cut_a || (px->a - unbounded->a).norm() > 0.01;
  sighting.censored_b = cut_b || (px->b - unbounded->b).norm() > 0.01;
  return sighting;
}

}  // namespace

Keyframe lookDown() {
  CameraMount mount;
  mount.T_robot_pantilt.translation().z() = 0.5;
  Keyframe keyframe;
  keyframe.intrinsics = intrinsicsFromFieldOfView(320, 240, 1.0);
  keyframe.T_robot_camera = cameraPose(mount, 0.0, degToRad(-25.0));
  return keyframe;
}

std::vector<TrueFloorEdge> ringOfCorridors() {
  std::vector<TrueFloorEdge> edges;
  addWall(edges, {-5.2, 3.7}, {5.2, 3.7}, {{0.9, 1.8}, {3.1, 3.9}, {6.0, 7.0}, {8.7, 9.4}});
  addWall(edges, {5.2, 3.7}, {5.2, -3.7}, {{1.1, 1.7}, {3.5, 4.5}, {6.0, 6.7}});
  addWall(edges, {5.2, -3.7}, {-5.2, -3.7}, {{0.6, 1.4}, {2.9, 3.8}, {7.2, 7.8}});
  addWall(edges, {-5.2, -3.7}, {-5.2, 3.7}, {{2.1, 3.1}, {4.9, 5.5}});
  addWall(edges, {3.8, 2.3}, {-3.8, 2.3}, {{0.8, 1.7}, {4.0, 4.6}});
  addWall(edges, {-3.8, 2.3}, {-3.8, -2.3}, {{1.3, 2.2}});
  addWall(edges, {-3.8, -2.3}, {3.8, -2.3}, {{2.5, 3.3}, {5.1, 6.2}});
  addWall(edges, {3.8, -2.3}, {3.8, 2.3}, {{0.7, 1.3}, {2.9, 3.7}});
  return edges;
}

std::vector<TrueFloorEdge> straightCorridor() {
  std::vector<TrueFloorEdge> edges;
  addWall(edges, {-10.0, 0.8}, {10.0, 0.8},
          {{2.9, 3.8}, {6.1, 6.9}, {9.0, 10.0}, {12.7, 13.4}, {16.0, 16.9}});
  addWall(edges, {10.0, -0.8}, {-10.0, -0.8}, {{3.6, 4.4}, {7.9, 8.8}, {11.2, 12.1}, {15.2, 15.8}});
  return edges;
}

std::vector<TrueFloorEdge> slantedWing() {
  std::vector<TrueFloorEdge> edges;
  addWall(edges, {-6.0, 0.8}, {0.0, 0.8}, {{1.0, 1.9}, {3.6, 4.2}});
  addWall(edges, {0.66, -0.8}, {-6.0, -0.8}, {{1.4, 2.3}, {4.0, 5.0}});
  const double s = std::sqrt(0.5);
  addWall(edges, {0.0, 0.8}, {6.0 * s, 0.8 + 6.0 * s}, {{1.2, 2.0}, {3.9, 4.6}});
  addWall(edges, {0.66 + 6.0 * s, -0.8 + 6.0 * s}, {0.66, -0.8}, {{0.9, 1.8}, {3.0, 3.6}});
  return edges;
}

std::vector<TrueFloorEdge> cornerWithSlantedWing() {
  std::vector<TrueFloorEdge> edges;
  addWall(edges, {0.8, -6.8}, {0.8, -0.66}, {{1.1, 2.0}, {4.0, 4.8}});
  addWall(edges, {-0.8, 0.0}, {-0.8, -6.8}, {{2.3, 3.1}, {5.0, 5.9}});
  addWall(edges, {-6.0, 0.8}, {0.0, 0.8}, {{1.0, 1.9}, {3.6, 4.2}});
  addWall(edges, {-0.8, -0.8}, {-6.0, -0.8}, {{1.4, 2.3}, {3.4, 4.2}});
  const double s = std::sqrt(0.5);
  addWall(edges, {0.0, 0.8}, {3.5 * s, 0.8 + 3.5 * s}, {{1.2, 2.0}});
  addWall(edges, {0.8 + 3.5 * s, -0.66 + 3.5 * s}, {0.8, -0.66}, {{0.9, 1.8}});
  return edges;
}

std::vector<Pose2> wayIntoSlantedWing() {
  const double s = std::sqrt(0.5);
  return wayThrough({{-5.0, 0.0}, {0.0, 0.0}, {0.0, -6.0}, {0.0, 0.0}, {0.2 + 3.0 * s, 3.0 * s}}, 20.0);
}

std::vector<TrueFloorEdge> threeBlocks() {
  constexpr double kHalf_m = 0.8;
  constexpr double kBlock_m = 12.0;
  constexpr int kBlocks = 3;
  const std::vector<std::pair<double, double>> doors{{1.5, 2.4}, {4.1, 4.9}, {6.0, 7.0}, {8.4, 9.0}};
  std::vector<TrueFloorEdge> edges;
  for (int i = 0; i < kBlocks; ++i) {
    const double left = i * kBlock_m + kHalf_m;
    const double right = (i + 1) * kBlock_m - kHalf_m;
    addWall(edges, {right, kHalf_m}, {left, kHalf_m}, doors);
    addWall(edges, {left, kHalf_m}, {left, kBlock_m - kHalf_m}, doors);
    addWall(edges, {left, kBlock_m - kHalf_m}, {right, kBlock_m - kHalf_m}, doors);
    addWall(edges, {right, kBlock_m - kHalf_m}, {right, kHalf_m}, doors);
    // Outer walls along the block.
    addWall(edges, {i * kBlock_m, -kHalf_m}, {(i + 1) * kBlock_m, -kHalf_m}, doors);
    addWall(edges, {(i + 1) * kBlock_m, kBlock_m + kHalf_m}, {i * kBlock_m, kBlock_m + kHalf_m}, doors);
  }
  addWall(edges, {-kHalf_m, kBlock_m}, {-kHalf_m, 0.0}, doors);
  addWall(edges, {kBlocks * kBlock_m + kHalf_m, 0.0}, {kBlocks * kBlock_m + kHalf_m, kBlock_m}, doors);
  return edges;
}

std::vector<Pose2> threeLoops() {
  std::vector<Eigen::Vector2d> points;
  for (const double x : {0.0, 12.0, 24.0}) {
    for (const Eigen::Vector2d& p : {Eigen::Vector2d(x, 0.0), Eigen::Vector2d(x + 12.0, 0.0),
                                     Eigen::Vector2d(x + 12.0, 12.0), Eigen::Vector2d(x, 12.0)}) {
      points.push_back(p);
    }
    points.emplace_back(x, 0.0);
    if (x < 24.0) points.emplace_back(x + 12.0, 0.0);
  }
  for (const Eigen::Vector2d& p : {Eigen::Vector2d(36.0, 0.0), Eigen::Vector2d(36.0, 12.0),
                                   Eigen::Vector2d(0.0, 12.0), Eigen::Vector2d(0.0, 0.0)}) {
    points.push_back(p);
  }
  points.erase(std::unique(points.begin(), points.end()), points.end());
  return wayThrough(points, 245.0);
}

std::vector<Pose2> wayThrough(const std::vector<Eigen::Vector2d>& points, double length_m) {
  std::vector<Pose2> way;
  double driven = 0.0;
  double heading = std::atan2(points[1].y() - points[0].y(), points[1].x() - points[0].x());
  for (std::size_t i = 0; driven < length_m && i + 1 < 100 * points.size(); ++i) {
    const Eigen::Vector2d from = points[i % points.size()];
    const Eigen::Vector2d to = points[(i + 1) % points.size()];
    const double direction = std::atan2(to.y() - from.y(), to.x() - from.x());
    while (std::abs(angleDifference(direction, heading)) > 1e-9) {
      heading += std::clamp(angleDifference(direction, heading), -kTurn_rad, kTurn_rad);
      way.push_back({from.x(), from.y(), wrapAngle(heading)});
    }
    const double length = (to - from).norm();
    for (double s = 0.0; s < length && driven < length_m; s += kStep_m, driven += kStep_m) {
      const Eigen::Vector2d p = from + s / length * (to - from);
      way.push_back({p.x(), p.y(), wrapAngle(heading)});
    }
  }
  return way;
}

std::vector<Pose2> ringWay(double length_m) {
  return wayThrough({{-4.5, -3.0}, {4.5, -3.0}, {4.5, 3.0}, {-4.5, 3.0}}, length_m);
}

SyntheticDrive drive(const std::vector<TrueFloorEdge>& edges, const std::vector<Pose2>& way,
                     const SyntheticDriveParams& params) {
  std::mt19937_64 random(params.seed);
  std::normal_distribution<double> normal;
  SyntheticDrive result;
  result.truth = way;
  const CameraMount mount{poseFromXyzRpy(0.0, 0.0, kHeight_m, 0.0, 0.0, 0.0), Pose3::Identity()};
  const CameraIntrinsics intrinsics = intrinsicsFromFieldOfView(320, 240, degToRad(60.0));
  Pose3 error = Pose3::Identity();
  error.linear() = Eigen::AngleAxisd(params.mount_pitch_rad, Eigen::Vector3d::UnitY()).toRotationMatrix();
  Pose2 odom;
  double way_m = 0.0;
  double turned = 0.0;
  std::map<std::size_t, std::pair<std::uint64_t, double>> ids;  // of an edge: id, way when last seen
  std::uint64_t next_id = 1;
  for (std::size_t k = 0; k < way.size(); ++k) {
    if (k > 0) {
      const Pose2 step = inverse(way[k - 1]) * way[k];
      const double length = step.position().norm();
      odom = odom * Pose2{step.x * (1.0 + params.scale_error), step.y,
                          step.theta * (1.0 + params.turn_per_rad) + length * params.turn_per_m +
                              params.turn_noise_rad * normal(random)};
      way_m += length;
      turned += std::abs(step.theta);
    }
    const double pan = 1.1 * std::sin(0.9 * static_cast<double>(k));
    Keyframe keyframe{static_cast<StampUs>(k) * kSecondUs,
                      odom,
                      cameraPose(mount, pan, kTilt_rad),
                      intrinsics,
                      0.0,
                      way_m,
                      turned,
                      {}};
    Pose3 T_robot_camera = keyframe.T_robot_camera;
    T_robot_camera.linear() = error.linear() * T_robot_camera.linear();
    const View view{intrinsics, toPose3(way[k]) * T_robot_camera};
    for (std::size_t e = 0; e < edges.size() && !params.blind; ++e) {
      auto sighting = see(edges[e], view, params.range_m);
      if (!sighting) continue;
      auto& [id, seen_m] = ids[e];
      if (id == 0 || way_m - seen_m > params.forget_m) id = next_id++;
      seen_m = way_m;
      sighting->element = id;
      for (Eigen::Vector2d* end : {&sighting->px.a, &sighting->px.b}) {
        // In the order of two statements: compilers order the arguments of a call as they like.
        end->x() += params.pixel_sigma * normal(random);
        end->y() += params.pixel_sigma * normal(random);
      }
      ElementSummary& summary = result.record.elements[id];
      if (summary.sightings++ == 0) summary.first_keyframe = static_cast<int>(k);
      // The memory's extent is the union of what it saw: here the whole edge once both ends were visible.
      const bool knew_a = summary.sightings > 1 && !summary.censored_a;
      const bool knew_b = summary.sightings > 1 && !summary.censored_b;
      summary.label = edges[e].label;
      summary.confirmed = true;
      summary.last_keyframe = static_cast<int>(k);
      // The memory's own estimate errs.
      const Pose2 wrong{0.02 * normal(random), 0.02 * normal(random), 0.005 * normal(random)};
      summary.robot = transform(wrong * inverse(way[k]), edges[e].world);
      summary.censored_a = !knew_a && sighting->censored_a;
      summary.censored_b = !knew_b && sighting->censored_b;
      keyframe.sightings.push_back(*sighting);
    }
    result.record.keyframes.push_back(std::move(keyframe));
  }
  return result;
}

}  // namespace vismem
