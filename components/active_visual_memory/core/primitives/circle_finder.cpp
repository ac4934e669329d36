#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "active_visual_memory/core/primitives/finders.h"
#include "common/geometry/angles.h"
#include "common/geometry/plane.h"
#include "common/visual_memory/labels.h"

namespace vismem {
namespace {

struct Circle {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  double radius = 0.0;
};

/// The circle whose chords (or tangents) two edges are: through the middles, across the edges' directions.
std::optional<Circle> circleOfTwo(const FloorEdge& a, const FloorEdge& b) {
  const Eigen::Vector2d na = turned90(a.along);
  const Eigen::Vector2d nb = turned90(b.along);
  const double turn = cross2(na, nb);
  if (std::abs(turn) < 0.05) return std::nullopt;
  Circle circle;
  circle.centre = a.line.middle() + na * (cross2(b.line.middle() - a.line.middle(), nb) / turn);
  const double ra = (circle.centre - a.line.middle()).norm();
  const double rb = (circle.centre - b.line.middle()).norm();
  circle.radius = 0.5 * (ra + rb);
  if (std::abs(ra - rb) > 0.25 * circle.radius) return std::nullopt;
  return circle;
}

/// Least squares over the chords' points, weighted by the chords' lengths (algebraic distance).
std::optional<Circle> fitCircle(std::span<const FloorEdge> edges, std::span<const int> members) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (const int i : members) {
    const Segment2 cut = arcPoints(edges[i].line);
    for (const Eigen::Vector2d& p : {cut.a, cut.b}) {
      const Eigen::Vector3d row(p.x(), p.y(), 1.0);
      normal += edges[i].length * row * row.transpose();
      right += edges[i].length * p.squaredNorm() * row;
    }
  }
  const Eigen::LDLT<Eigen::Matrix3d> solver(normal);
  if (solver.info() != Eigen::Success || solver.rcond() < 1e-9) return std::nullopt;
  const Eigen::Vector3d x = solver.solve(right);
  Circle circle;
  circle.centre = 0.5 * x.head<2>();
  const double squared = x.z() + circle.centre.squaredNorm();
  if (!(squared > 0.0)) return std::nullopt;
  circle.radius = std::sqrt(squared);
  return circle;
}

/// +1: the brighter side is towards the centre, -1: away from it, 0: the edge is no chord of this circle.
int sideOf(const FloorEdge& edge, const Circle& circle, const CircleParams& params) {
  // The brighter side lies left of a -> b.
  const double offset = cross2(edge.along, circle.centre - edge.line.middle());
  const Segment2 cut = arcPoints(edge.line);
  const double off_p = std::abs((cut.a - circle.centre).norm() - circle.radius);
  const double off_q = std::abs((cut.b - circle.centre).norm() - circle.radius);
  if (std::max(off_p, off_q) > params.tolerance_m) return 0;
  // A long edge that touches the circle is not a chord.
  if (edge.length > circle.radius) return 0;
  return offset > 0.0 ? 1 : -1;
}

struct Found {
  Circle circle;
  int side = 0;
  double coverage = 0.0;   ///< share of the circumference
  double deviation = 0.0;  ///< mean [m]
  std::pmr::vector<int> members;
};

/// A mark for each edge.
using Marks = std::pmr::vector<bool>;

/// @param members  replaced.
void findMembers(std::span<const FloorEdge> edges, const Marks& taken, const Circle& circle, int side,
                 std::string_view label, const CircleParams& params, std::pmr::vector<int>& members) {
  members.clear();
  for (std::size_t i = 0; i < edges.size(); ++i) {
    if (taken[i] || !labelsCompatible(edges[i].label, label)) continue;
    if (sideOf(edges[i], circle, params) == side) members.push_back(static_cast<int>(i));
  }
}

/// Share of the circumference that the members cover, in steps of 5 degrees.
double coverageOf(std::span<const FloorEdge> edges, const Found& found) {
  constexpr int kSteps = 72;
  std::array<bool, kSteps> hit{};
  for (const int i : found.members) {
    const Eigen::Vector2d a = edges[i].line.a - found.circle.centre;
    const Eigen::Vector2d b = edges[i].line.b - found.circle.centre;
    const double from = std::atan2(a.y(), a.x());
    const double sweep = angleDifference(std::atan2(b.y(), b.x()), from);
    const int steps = std::max(1, static_cast<int>(std::ceil(std::abs(sweep) / (std::numbers::pi / kSteps))));
    for (int s = 0; s <= steps; ++s) {
      const double angle = wrapAngle(from + sweep * s / steps) + std::numbers::pi;
      hit[std::min(kSteps - 1, static_cast<int>(angle / (2.0 * std::numbers::pi) * kSteps))] = true;
    }
  }
  return static_cast<double>(std::count(hit.begin(), hit.end(), true)) / kSteps;
}

/// Grows a first guess into the circle that most of its surroundings agree on.
/// @param found  its circle is the guess; replaced. @return false if there is no such circle.
bool grow(std::span<const FloorEdge> edges, const Marks& taken, std::string_view label,
          const CircleParams& params, Found& found) {
  Circle& circle = found.circle;
  for (int round = 0; round < 3; ++round) {
    // The guess from two short chords is rough: the first rounds take chords from further off.
    CircleParams loose = params;
    loose.tolerance_m *= 3.0 - round;
    findMembers(edges, taken, circle, found.side, label, loose, found.members);
    if (static_cast<int>(found.members.size()) < params.min_chords) return false;
    const auto fitted = fitCircle(edges, found.members);
    if (!fitted || fitted->radius < params.min_radius_m || fitted->radius > params.max_radius_m) return false;
    circle = *fitted;
  }
  findMembers(edges, taken, circle, found.side, label, params, found.members);
  if (static_cast<int>(found.members.size()) < params.min_chords) return false;
  found.coverage = coverageOf(edges, found);
  if (found.coverage < params.min_coverage) return false;
  double sum = 0.0;
  for (const int i : found.members) {
    const Segment2 cut = arcPoints(edges[i].line);
    for (const Eigen::Vector2d& p : {cut.a, cut.b})
      sum += std::abs((p - circle.centre).norm() - circle.radius);
  }
  found.deviation = sum / (2.0 * static_cast<double>(found.members.size()));
  return true;
}

/// The best circle among the edges that are left; without members if there is none.
Found bestCircle(std::span<const FloorEdge> edges, const Marks& taken, const CircleParams& params) {
  const auto scratch = taken.get_allocator();
  Found best{{}, 0, 0.0, 0.0, std::pmr::vector<int>(scratch)};
  Found found{{}, 0, 0.0, 0.0, std::pmr::vector<int>(scratch)};
  Marks explained(edges.size(), false, scratch);  // two chords of a known circle propose it again
  for (std::size_t i = 0; i < edges.size(); ++i) {
    if (taken[i] || explained[i]) continue;
    for (std::size_t j = i + 1; j < edges.size(); ++j) {
      if (taken[j]) continue;
      // Neighbours on one arc follow each other: the end of one near the beginning of the other.
      const double gap =
          std::min((edges[i].line.b - edges[j].line.a).norm(), (edges[j].line.b - edges[i].line.a).norm());
      if (gap > params.max_chord_gap_m || !labelsCompatible(edges[i].label, edges[j].label)) continue;
      const double turn = std::acos(std::clamp(edges[i].along.dot(edges[j].along), -1.0, 1.0));
      if (turn > params.max_turn_rad) continue;
      const auto guess = circleOfTwo(edges[i], edges[j]);
      if (!guess || guess->radius < params.min_radius_m || guess->radius > params.max_radius_m) continue;
      found.circle = *guess;
      found.side = cross2(edges[i].along, guess->centre - edges[i].line.middle()) > 0.0 ? 1 : -1;
      if (!grow(edges, taken, edges[i].label, params, found)) continue;
      for (const int member : found.members) explained[member] = true;
      if (found.coverage > best.coverage) best = found;
      if (explained[i]) break;
    }
  }
  return best;
}

}  // namespace

Shapes findCircles(std::span<const FloorEdge> edges, const CircleParams& params,
                   std::pmr::memory_resource* scratch) {
  Marks taken(edges.size(), false, scratch);
  std::pmr::vector<Found> circles(scratch);
  for (Found found = bestCircle(edges, taken, params); !found.members.empty();
       found = bestCircle(edges, taken, params)) {
    for (const int i : found.members) taken[i] = true;
    circles.push_back(std::move(found));
  }

  Shapes primitives(scratch);
  Marks used(circles.size(), false, scratch);
  for (std::size_t n = 0; n < circles.size(); ++n) {
    if (used[n]) continue;
    const Found& first = circles[n];
    Primitive& primitive = primitives.emplace_back();
    primitive.kind = PrimitiveKind::kCircle;
    primitive.centre = first.circle.centre;
    primitive.radius_m = first.circle.radius;
    const Found* line = nullptr;  // its other edge
    double coverage = first.coverage;
    for (std::size_t m = n + 1; m < circles.size(); ++m) {
      const Found& other = circles[m];
      const double width = std::abs(other.circle.radius - first.circle.radius);
      const bool concentric = (other.circle.centre - first.circle.centre).norm() <= 2.0 * params.tolerance_m;
      if (used[m] || !concentric || other.side == first.side || width > params.max_line_width_m) continue;
      used[m] = true;
      const double total = first.coverage + other.coverage;
      primitive.centre =
          (first.coverage * first.circle.centre + other.coverage * other.circle.centre) / total;
      primitive.radius_m = 0.5 * (first.circle.radius + other.circle.radius);
      primitive.width_m = width;
      line = &other;
      coverage = std::max(coverage, other.coverage);
      break;
    }
    SegmentIds ids;
    for (const Found* one : {&first, line}) {
      if (!one) continue;
      for (const int i : one->members) ids = joinedIds(ids, edges[i].segments, scratch);
    }
    primitive.segments.assign(ids.begin(), ids.end());
    primitive.quality = coverage * (1.0 - std::min(1.0, first.deviation / params.tolerance_m));
  }
  return primitives;
}

}  // namespace vismem
