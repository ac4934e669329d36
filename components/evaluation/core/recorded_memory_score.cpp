#include "evaluation/core/recorded_memory_score.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/geometry/angles.h"
#include "common/geometry/plane.h"

namespace vismem {
namespace {

using Params = RecordedMemoryParams;

/// The nearest edge whose direction agrees; -1: none.
int nearestEdge(const Eigen::Vector2d& p, double direction_rad, const std::vector<Segment2>& map,
                const std::vector<double>& directions, double angle_rad, double& distance_m) {
  int nearest = -1;
  distance_m = std::numeric_limits<double>::max();
  for (std::size_t i = 0; i < map.size(); ++i) {
    const double d = distanceToSegment(p, map[i]);
    if (d >= distance_m || lineAngleDifference(directions[i], direction_rad) > angle_rad) continue;
    distance_m = d;
    nearest = static_cast<int>(i);
  }
  return nearest;
}

std::vector<double> directionsOf(const std::vector<Segment2>& map) {
  std::vector<double> directions;
  for (const Segment2& edge : map) directions.push_back(edge.direction());
  return directions;
}

/// Points in even steps, both ends among them.
template <typename Visit>
void alongEdge(const Segment2& edge, double step_m, Visit visit) {
  const int steps = std::max(1, static_cast<int>(std::ceil(edge.length() / step_m)));
  for (int i = 0; i <= steps; ++i) visit(Eigen::Vector2d(edge.a + (edge.b - edge.a) * (i / double(steps))));
}

/// The parts of remembered edges near the robot, in odom.
std::vector<Segment2> nearby(const MemorySnapshot& memory, bool unconfirmed, const Params& params) {
  std::vector<Segment2> edges;
  const Eigen::Vector2d reach = Eigen::Vector2d::Constant(params.range_m);
  const Eigen::Vector2d robot = memory.T_odom_robot.position();
  for (const MemorySegment& s : memory.segments) {
    if (!s.confirmed && !unconfirmed) continue;
    // Clipped to a square around the robot; then the middle decides.
    const auto part = clipToBox(s.odom.floor(), robot - reach, robot + reach);
    if (part && part->length() > 0.0 && (part->middle() - robot).norm() <= params.range_m) {
      edges.push_back(*part);
    }
  }
  return edges;
}

double medianOf(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

std::optional<double> medianIfAny(const std::vector<double>& values) {
  if (values.empty()) return std::nullopt;
  return medianOf(values);
}

RecordedMemoryScore::Spread spreadOf(const std::vector<double>& values) {
  if (values.empty()) return {};
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  return {medianOf(values), *least, *most};
}

/// Of the moments [first, last): where localization, when it was there last, put odom.
std::optional<Pose2> guessOf(const std::vector<RecordedMoment>& moments, std::size_t first,
                             std::size_t last) {
  for (std::size_t i = last; i-- > first;) {
    const RecordedMoment& m = moments[i];
    if (m.T_world_robot) return *m.T_world_robot * inverse(m.memory->T_odom_robot);
  }
  return std::nullopt;
}

/// Elements per edge that has any, whatever their ends.
double elementsPerEdge(std::vector<RememberedEdge> memory, bool unconfirmed,
                       const std::vector<TrueEdge>& edges, const MemoryScoreParams& loose) {
  if (unconfirmed) {
    for (RememberedEdge& e : memory) e.confirmed = true;
  }
  return scoreMemory(memory, edges, loose).duplicates();
}

/// Values over the moments.
struct Gathered {
  std::vector<double> distances;
  std::vector<double> distances_all;
  std::vector<double> radii;
  std::vector<double> shape_radii;
  std::vector<double> per_edge;
  std::vector<double> per_edge_all;
  std::vector<double> confirmed;
};

/// The shape that lived longest, of those of the radius of a field's.
std::optional<double> radiusOfShape(const MemorySnapshot& memory, const Params& params) {
  const Primitive* best = nullptr;
  for (const Primitive& p : memory.primitives) {
    if (p.kind != PrimitiveKind::kCircle) continue;
    if (p.radius_m < params.min_radius_m || p.radius_m > params.max_radius_m) continue;
    if (!best || p.life > best->life) best = &p;
  }
  return best ? std::optional(best->radius_m) : std::nullopt;
}

/// Where the map has a round line: the middle of its closed curves.
std::optional<Eigen::Vector2d> middleOfCurves(const std::vector<TrueEdge>& edges) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  int samples = 0;
  for (const TrueEdge& edge : edges) {
    if (!edge.curve || !edge.closed) continue;
    for (const auto& sample : edge.samples) sum += sample.p;
    samples += static_cast<int>(edge.samples.size());
  }
  if (samples == 0) return std::nullopt;
  return sum / samples;
}

/// The circle through the points (least squares of x^2 + y^2 + ax + by + c).
double fittedRadius(const std::vector<Eigen::Vector2d>& points, const Eigen::Vector2d& around) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (const Eigen::Vector2d& p : points) {
    const Eigen::Vector2d q = p - around;
    const Eigen::Vector3d row(q.x(), q.y(), 1.0);
    normal += row * row.transpose();
    right += q.squaredNorm() * row;
  }
  const Eigen::Vector3d x = normal.ldlt().solve(right);
  return std::sqrt(std::max(0.0, x.z() + 0.25 * x.head<2>().squaredNorm()));
}

/// From the elements that lie on the round line, whichever of its sides: of each side for itself, the mean of
/// both.
std::optional<double> radiusOfElements(const std::vector<RememberedEdge>& memory,
                                       const std::vector<TrueEdge>& edges, const Params& params) {
  const auto middle = middleOfCurves(edges);
  if (!middle) return std::nullopt;
  constexpr int kSectors = 36;
  std::vector<double> radii;
  for (const bool bright_inside : {true, false}) {
    std::vector<Eigen::Vector2d> points;
    std::vector<bool> covered(kSectors, false);
    for (const RememberedEdge& e : memory) {
      const Eigen::Vector2d out = e.world.middle() - *middle;
      const Eigen::Vector2d along = e.world.b - e.world.a;
      // Looked at along a -> b, the left is the brighter side.
      if ((cross2(along, out) < 0.0) != bright_inside) continue;
      const bool on_curve = std::any_of(edges.begin(), edges.end(), [&](const TrueEdge& edge) {
        if (!edge.curve || !edge.closed) return false;
        double nearest = std::numeric_limits<double>::max();
        double direction = 0.0;
        for (const Segment2& piece : edge.pieces) {
          const double d = distanceToSegment(e.world.middle(), piece);
          if (d < nearest) nearest = d, direction = piece.direction();
        }
        return nearest <= params.on_edge_m &&
               lineAngleDifference(e.world.direction(), direction) <= params.angle_rad;
      });
      if (!on_curve) continue;
      alongEdge(e.world, params.step_m, [&](const Eigen::Vector2d& p) {
        points.push_back(p);
        const double angle = std::atan2(p.y() - middle->y(), p.x() - middle->x()) + std::numbers::pi;
        covered[std::min(kSectors - 1, static_cast<int>(angle / (2.0 * std::numbers::pi) * kSectors))] = true;
      });
    }
    const auto sectors = std::count(covered.begin(), covered.end(), true);
    if (static_cast<double>(sectors) >= params.least_cover * kSectors) {
      radii.push_back(fittedRadius(points, *middle));
    }
  }
  if (radii.size() != 2) return std::nullopt;
  return 0.5 * (radii[0] + radii[1]);
}

}  // namespace

Pose2 alignToMap(const std::vector<Segment2>& odom, const std::vector<Segment2>& map,
                 const Pose2& T_world_odom, const RecordedMemoryParams& params) {
  const std::vector<double> directions = directionsOf(map);
  constexpr int kIterations = 30;
  Pose2 pose = T_world_odom;
  for (int round = 0; round < kIterations; ++round) {
    // Wider at first: the guess may be off by more than the memory is.
    const double kernel = params.kernel_m * std::max(1.0, 3.0 - 0.25 * round);
    Eigen::Matrix3d normal = 1e-6 * Eigen::Matrix3d::Identity();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (const Segment2& edge : odom) {
      const Segment2 world = transform(pose, edge);
      const double direction = world.direction();
      alongEdge(world, params.step_m, [&](const Eigen::Vector2d& p) {
        double distance = 0.0;
        const int i = nearestEdge(p, direction, map, directions, params.angle_rad, distance);
        if (i < 0 || distance > 5.0 * kernel) return;
        const Eigen::Vector2d along = (map[i].b - map[i].a).normalized();
        const Eigen::Vector2d across = turned90(along);
        const double residual = across.dot(map[i].a - p);
        const Eigen::Vector2d arm = p - pose.position();
        const Eigen::Vector3d row(across.x(), across.y(), across.dot(turned90(arm)));
        const double weight = 1.0 / (1.0 + distance * distance / (kernel * kernel));
        normal += weight * row * row.transpose();
        right += weight * residual * row;
      });
    }
    const Eigen::Vector3d step = normal.ldlt().solve(right);
    pose = {pose.x + step.x(), pose.y + step.y(), wrapAngle(pose.theta + step.z())};
    if (round > 8 && step.norm() < 1e-6) break;
  }
  return pose;
}

void appendDistances(const Segment2& world, const std::vector<Segment2>& map,
                     const RecordedMemoryParams& params, std::vector<double>& distances_m) {
  const std::vector<double> directions = directionsOf(map);
  alongEdge(world, params.step_m, [&](const Eigen::Vector2d& p) {
    double distance = 0.0;
    nearestEdge(p, world.direction(), map, directions, params.angle_rad, distance);
    distances_m.push_back(std::min(distance, params.lost_m));
  });
}

RecordedMemoryScore scoreRecordedMemory(const std::vector<RecordedMoment>& moments, const SegmentMap& edges,
                                        const RecordedMemoryParams& params) {
  RecordedMemoryScore score;
  score.moments = static_cast<int>(moments.size());
  std::vector<Segment2> map;
  for (const MapSegment& segment : edges.segments) map.push_back(segment.world.floor());
  FloorTruthParams truth_params;
  truth_params.curve_piece_m = params.curve_piece_m;
  truth_params.touching_m = params.curve_gap_m;
  FloorTruth truth(edges, truth_params);
  const SeesFloor nothing_in_the_way = [](const Eigen::Vector3d&, const Eigen::Vector3d&) { return true; };
  MemoryScoreParams loose;
  loose.end_m = params.on_edge_m;
  loose.angle_rad = params.angle_rad;

  Gathered all;
  for (std::size_t first = 0; first < moments.size();) {
    std::size_t last = first;
    const StampUs from_us = moments[first].memory->stamp_us;
    while (last < moments.size() && moments[last].memory->stamp_us < from_us + params.window_us) ++last;
    const auto guess = guessOf(moments, first, last);
    if (!guess) {
      score.moments_without_pose += static_cast<int>(last - first);
      first = last;
      continue;
    }
    std::vector<Segment2> together;
    for (std::size_t i = first; i < last; ++i) {
      const auto part = nearby(*moments[i].memory, true, params);
      together.insert(together.end(), part.begin(), part.end());
    }
    RecordedMemoryScore::Window window{from_us, alignToMap(together, map, *guess, params), std::nullopt};
    std::vector<double> distances;
    for (std::size_t i = first; i < last; ++i) {
      const RecordedMoment& moment = moments[i];
      const Pose2 T_world_robot = window.T_world_odom * moment.memory->T_odom_robot;
      for (const Segment2& edge : nearby(*moment.memory, false, params)) {
        appendDistances(transform(window.T_world_odom, edge), map, params, distances);
      }
      for (const Segment2& edge : nearby(*moment.memory, true, params)) {
        appendDistances(transform(window.T_world_odom, edge), map, params, all.distances_all);
      }
      if (const auto radius = radiusOfShape(*moment.memory, params)) all.shape_radii.push_back(*radius);
      truth.addView(moment.intrinsics, toPose3(T_world_robot) * moment.T_robot_camera, nothing_in_the_way,
                    1.0);
      loose.focal_px = moment.intrinsics.fx;
      score.last_memory = rememberedIn(*moment.memory, T_world_robot);
      if (const auto radius = radiusOfElements(score.last_memory, truth.edges(), params)) {
        all.radii.push_back(*radius);
      }
      score.last = scoreMemory(score.last_memory, truth.edges(), loose);
      all.confirmed.push_back(static_cast<double>(score.last->judged.size()));
      if (score.last->edges_remembered > 0) all.per_edge.push_back(score.last->duplicates());
      const double with_unconfirmed = elementsPerEdge(score.last_memory, true, truth.edges(), loose);
      if (with_unconfirmed > 0.0) all.per_edge_all.push_back(with_unconfirmed);
    }
    window.distance_m = medianIfAny(distances);
    all.distances.insert(all.distances.end(), distances.begin(), distances.end());
    score.windows.push_back(window);
    first = last;
  }
  score.distance_m = medianIfAny(all.distances);
  score.distance_with_unconfirmed_m = medianIfAny(all.distances_all);
  if (!all.radii.empty()) score.circle_radius_m = spreadOf(all.radii);
  score.moments_with_circle = static_cast<int>(all.radii.size());
  if (!all.shape_radii.empty()) score.circle_shape_radius_m = spreadOf(all.shape_radii);
  score.moments_with_circle_shape = static_cast<int>(all.shape_radii.size());
  score.elements_per_edge = spreadOf(all.per_edge);
  score.elements_per_edge_all = spreadOf(all.per_edge_all);
  score.confirmed = spreadOf(all.confirmed);
  score.edges = truth.edges();
  return score;
}

}  // namespace vismem
