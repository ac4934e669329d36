#include "evaluation/core/map_score.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "common/geometry/angles.h"
#include "common/geometry/plane.h"

namespace vismem {
namespace {

constexpr double kKernel_m = 0.03;

/// The part of a true edge that an edge of the map lies on.
struct Support {
  Segment2 piece;
  double distance_m = 0.0;
};

std::optional<Support> supportOf(const Segment2& edge, const Label& label, const std::vector<TrueEdge>& truth,
                                 double reach_m) {
  constexpr double kAngle_rad = 0.15;
  std::optional<Support> best;
  for (const TrueEdge& candidate : truth) {
    if (candidate.label != label) continue;
    for (const Segment2& piece : candidate.pieces) {
      if (lineAngleDifference(piece.direction(), edge.direction()) > kAngle_rad) continue;
      const double off = std::max(distanceToSegment(edge.middle(), piece),
                                  0.5 * (distanceToLine(edge.a, piece) + distanceToLine(edge.b, piece)));
      if (off > reach_m || (best && off >= best->distance_m)) continue;
      best = Support{piece, off};
    }
  }
  return best;
}

/// Normal equations of a small rigid motion about a pivot.
struct Normal {
  Eigen::Matrix3d A = Eigen::Matrix3d::Identity() * 1e-9;
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  Eigen::Vector2d pivot = Eigen::Vector2d::Zero();

  /// @param off  from the true place, along n.
  void add(const Eigen::Vector2d& p, const Eigen::Vector2d& n, double off) {
    const double weight = 1.0 / (1.0 + off * off / (kKernel_m * kKernel_m));
    const Eigen::Vector3d J(n.x(), n.y(), n.dot(turned90(p - pivot)));
    A += weight * J * J.transpose();
    b -= weight * off * J;
  }
  Pose2 applied(const Pose2& T) const {
    const Eigen::Vector3d x = A.ldlt().solve(b);
    const Pose2 T_moved{pivot.x() + x[0], pivot.y() + x[1], x[2]};
    return T_moved * (Pose2{-pivot.x(), -pivot.y(), 0.0} * T);
  }
};

std::optional<Eigen::Vector2d> endNear(const Eigen::Vector2d& p, const Segment2& piece, double reach_m) {
  const Eigen::Vector2d& nearer = (p - piece.a).norm() < (p - piece.b).norm() ? piece.a : piece.b;
  if ((p - nearer).norm() > reach_m) return std::nullopt;
  return nearer;
}

/// Closed ends of the map (in its own frame) and their true ends.
struct EndPairs {
  std::vector<Eigen::Vector2d> map;
  std::vector<Eigen::Vector2d> truth;

  double rms(const Pose2& T, double* worst = nullptr) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < map.size(); ++i) {
      const double off = (transform(T, map[i]) - truth[i]).norm();
      sum += off * off;
      if (worst) *worst = std::max(*worst, off);
    }
    return map.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(map.size()));
  }
};

double scaleOf(const EndPairs& ends) {
  Eigen::Vector2d a = Eigen::Vector2d::Zero();
  Eigen::Vector2d b = Eigen::Vector2d::Zero();
  const auto n = static_cast<double>(ends.map.size());
  for (std::size_t i = 0; i < ends.map.size(); ++i) a += ends.map[i] / n, b += ends.truth[i] / n;
  double of_map = 0.0;
  double of_truth = 0.0;
  for (std::size_t i = 0; i < ends.map.size(); ++i) {
    of_map += (ends.map[i] - a).squaredNorm();
    of_truth += (ends.truth[i] - b).squaredNorm();
  }
  return of_truth > 0.0 ? std::sqrt(of_map / of_truth) : 1.0;
}

/// Worst RMS of the closed ends within one cell of a grid, each about the alignment of all.
double worstPiece(const EndPairs& ends, const Pose2& T, const MapScoreParams& params) {
  std::map<std::pair<int, int>, EndPairs> cells;
  for (std::size_t i = 0; i < ends.map.size(); ++i) {
    const Eigen::Vector2d& p = ends.truth[i];
    EndPairs& cell = cells[{static_cast<int>(std::floor(p.x() / params.piece_m)),
                            static_cast<int>(std::floor(p.y() / params.piece_m))}];
    cell.map.push_back(ends.map[i]);
    cell.truth.push_back(p);
  }
  double worst = 0.0;
  for (const auto& [place, cell] : cells) {
    if (static_cast<int>(cell.map.size()) >= params.least_edges) worst = std::max(worst, cell.rms(T));
  }
  return worst;
}

}  // namespace

Pose2 rigidFit(const std::vector<Eigen::Vector2d>& a, const std::vector<Eigen::Vector2d>& b) {
  if (a.size() < 2 || a.size() != b.size()) return {};
  const auto n = static_cast<double>(a.size());
  Eigen::Vector2d mean_a = Eigen::Vector2d::Zero();
  Eigen::Vector2d mean_b = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < a.size(); ++i) mean_a += a[i] / n, mean_b += b[i] / n;
  double c = 0.0;
  double s = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    c += (a[i] - mean_a).dot(b[i] - mean_b);
    s += cross2(a[i] - mean_a, b[i] - mean_b);
  }
  const double theta = std::atan2(s, c);
  const Eigen::Vector2d shift = mean_b - transform(Pose2{0.0, 0.0, theta}, mean_a);
  return {shift.x(), shift.y(), theta};
}

Pose2 alignToTruth(const std::vector<MappedEdge>& map, const std::vector<TrueEdge>& truth,
                   const Pose2& start) {
  constexpr std::array<double, 6> kReach_m{1.0, 0.6, 0.4, 0.3, 0.2, 0.15};
  Pose2 T = start;
  for (const double reach_m : kReach_m) {
    constexpr int kSteps = 8;
    for (int step = 0; step < kSteps; ++step) {
      Normal normal;
      normal.pivot = T.position();
      for (const MappedEdge& edge : map) {
        const Segment2 world = transform(T, edge.map);
        const auto support = supportOf(world, edge.label, truth, reach_m);
        if (!support) continue;
        const Eigen::Vector2d u = (support->piece.b - support->piece.a).normalized();
        const Eigen::Vector2d n = turned90(u);
        for (const Eigen::Vector2d& p : {world.a, world.b}) normal.add(p, n, n.dot(p - support->piece.a));
        const auto end = [&](const Eigen::Vector2d& p) {
          if (const auto at = endNear(p, support->piece, reach_m)) normal.add(p, u, u.dot(p - *at));
        };
        if (edge.closed_a) end(world.a);
        if (edge.closed_b) end(world.b);
      }
      T = normal.applied(T);
    }
  }
  return T;
}

namespace {

void addEnds(const MappedEdge& edge, const Segment2& world, const Segment2& piece, double end_pair_m,
             EndPairs& ends) {
  const bool turned = (world.b - world.a).dot(piece.b - piece.a) < 0.0;
  const auto pair = [&](bool closed, const Eigen::Vector2d& of_map, const Eigen::Vector2d& p,
                        const Eigen::Vector2d& truth) {
    if (!closed || (p - truth).norm() > end_pair_m) return;
    ends.map.push_back(of_map);
    ends.truth.push_back(truth);
  };
  pair(edge.closed_a, edge.map.a, world.a, turned ? piece.b : piece.a);
  pair(edge.closed_b, edge.map.b, world.b, turned ? piece.a : piece.b);
}

}  // namespace

MapScore scoreMap(const std::vector<MappedEdge>& map, const std::vector<TrueEdge>& truth, const Pose2& start,
                  const MapScoreParams& params) {
  MapScore score;
  score.T_world_map = alignToTruth(map, truth, start);
  std::vector<RememberedEdge> edges;
  for (std::size_t i = 0; i < map.size(); ++i) {
    edges.push_back({i, transform(score.T_world_map, map[i].map), map[i].label, true});
  }
  score.edges = scoreMemory(edges, truth, params.memory);
  EndPairs ends;
  double across = 0.0;
  int lines = 0;
  for (const auto& judged : score.edges.judged) {
    // An edge of no true edge counts as false; where it should have been nobody knows.
    if (judged.true_edge < 0 || truth[static_cast<std::size_t>(judged.true_edge)].curve) continue;
    const Segment2& piece = truth[static_cast<std::size_t>(judged.true_edge)].pieces.front();
    for (const Eigen::Vector2d& p : {judged.edge.world.a, judged.edge.world.b}) {
      across += std::pow(distanceToLine(p, piece), 2);
      ++lines;
    }
    addEnds(map[judged.edge.id], judged.edge.world, piece, params.end_pair_m, ends);
  }
  score.ends = static_cast<int>(ends.map.size());
  score.ends_rms_m = ends.rms(score.T_world_map, &score.ends_worst_m);
  score.scale = scaleOf(ends);
  score.across_rms_m = lines > 0 ? std::sqrt(across / lines) : 0.0;
  score.worst_piece_rms_m = worstPiece(ends, score.T_world_map, params);
  return score;
}

}  // namespace vismem
