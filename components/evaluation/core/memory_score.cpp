#include "evaluation/core/memory_score.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/geometry/angles.h"
#include "common/geometry/plane.h"

namespace vismem {
namespace {

/// A stretch of an edge between two places where it was last visible, as indices of samples.
struct Run {
  std::size_t first = 0;
  std::size_t last = 0;
};

std::vector<Run> seenRuns(const TrueEdge& edge, double gap_m) {
  std::vector<Run> runs;
  for (std::size_t i = 0; i < edge.samples.size(); ++i) {
    if (!edge.samples[i].seen) continue;
    if (!runs.empty() &&
        edge.samples[i].along_m - edge.samples[runs.back().last].along_m <= std::max(gap_m, 0.021)) {
      runs.back().last = i;
    } else {
      runs.push_back({i, i});
    }
  }
  return runs;
}

/// The error of an end over its tolerance.
double endError(const Eigen::Vector2d& p, const TrueEdge::Sample& truth, const MemoryScoreParams& params) {
  const double footprint = floorFootprint(truth, params.focal_px);
  const Eigen::Vector2d ray = (truth.p - truth.camera).normalized();
  const Eigen::Vector2d off = p - truth.p;
  const double along = std::abs(ray.dot(off)) / (params.end_m + footprint);
  const double across = std::abs(cross2(ray, off)) / params.end_m;
  return std::max(along, across);
}

/// The better of both orders.
double runError(const Segment2& s, const TrueEdge& edge, std::size_t first, std::size_t last,
                const MemoryScoreParams& params) {
  const auto error = [&](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return std::max(endError(a, edge.samples[first], params), endError(b, edge.samples[last], params));
  };
  return std::min(error(s.a, s.b), error(s.b, s.a));
}

double nearestSample(const Eigen::Vector2d& p, const TrueEdge& edge, std::size_t& index) {
  double best = std::numeric_limits<double>::max();
  for (std::size_t i = 0; i < edge.samples.size(); ++i) {
    const double d = (edge.samples[i].p - p).squaredNorm();
    if (d < best) best = d, index = i;
  }
  return std::sqrt(best);
}

/// The edge's direction around a sample.
double directionAt(const TrueEdge& edge, std::size_t i) {
  const std::size_t n = edge.samples.size();
  const std::size_t before = i > 0 ? i - 1 : (edge.closed ? n - 2 : 0);
  const std::size_t after = i + 1 < n ? i + 1 : (edge.closed ? 1 : n - 1);
  const Eigen::Vector2d d = edge.samples[after].p - edge.samples[before].p;
  return std::atan2(d.y(), d.x());
}

struct Fit {
  bool on_edge = false;
  bool right = false;
  double error = std::numeric_limits<double>::max();  ///< to choose between edges; smaller is better
};

Fit fitStraight(const Segment2& s, const TrueEdge& edge, const MemoryScoreParams& params) {
  Fit fit;
  const Segment2& line = edge.pieces.front();
  if (lineAngleDifference(s.direction(), line.direction()) > params.angle_rad) return fit;
  // On the edge: most of it lies beside the true edge, within the tolerance of where that was seen.
  std::size_t index = 0;
  int beside = 0;
  double off = 0.0;
  constexpr int kPlaces = 9;
  for (int i = 0; i < kPlaces; ++i) {
    const Eigen::Vector2d p = s.a + (s.b - s.a) * (i / double(kPlaces - 1));
    nearestSample(p, edge, index);
    const double error = edge.samples[index].seen ? endError(p, edge.samples[index], params) : 2.0;
    if (error <= 1.0) ++beside;
    off += std::min(error, 2.0) / kPlaces;
  }
  fit.on_edge = 2 * beside > kPlaces;
  fit.error = 10.0 + off;
  const auto runs = seenRuns(edge, params.gap_m);
  for (std::size_t i = 0; i < runs.size(); ++i) {
    for (std::size_t j = i; j < runs.size(); ++j) {
      const double error = runError(s, edge, runs[i].first, runs[j].last, params);
      if (error > 1.0) continue;
      fit.right = fit.on_edge = true;
      fit.error = std::min(fit.error, error);
    }
  }
  return fit;
}

Fit fitCurve(const Segment2& s, const TrueEdge& edge, const MemoryScoreParams& params) {
  Fit fit;
  double worst = 0.0;
  std::size_t index = 0;
  for (const Eigen::Vector2d& p : {s.a, s.middle(), s.b}) {
    nearestSample(p, edge, index);
    worst = std::max(worst, endError(p, edge.samples[index], params));
  }
  nearestSample(s.middle(), edge, index);
  // A short chord's direction is known within the tolerance of its ends.
  const double angle = std::max(params.angle_rad, std::atan2(params.end_m, s.length()));
  if (worst > 1.0 || lineAngleDifference(s.direction(), directionAt(edge, index)) > angle) return fit;
  return {true, true, worst};
}

/// Coverage of a curve: the remembered share of its seen part, and the mean number of elements on it.
struct Coverage {
  double share = 0.0;
  double times = 0.0;
};

Coverage coverage(const std::vector<Segment2>& elements, const TrueEdge& edge) {
  const std::size_t n = edge.samples.size();
  std::vector<int> count(n, 0);
  for (const Segment2& s : elements) {
    std::size_t a = 0;
    std::size_t m = 0;
    std::size_t b = 0;
    nearestSample(s.a, edge, a);
    nearestSample(s.middle(), edge, m);
    nearestSample(s.b, edge, b);
    if (a > b) std::swap(a, b);
    const bool around = edge.closed && (m < a || m > b);
    for (std::size_t i = 0; i < n; ++i) {
      // A sample stands for the stretch up to the next one, so that touching chords do not overlap there.
      const bool inside = around ? (i < a || i >= b) : (i >= a && i < b);
      count[i] += inside;
    }
  }
  int seen = 0;
  int covered = 0;
  int total = 0;
  for (std::size_t i = 0; i < n; ++i) {
    if (!edge.samples[i].seen) continue;
    ++seen;
    covered += count[i] > 0;
    total += count[i];
  }
  return {seen > 0 ? double(covered) / seen : 0.0, covered > 0 ? double(total) / covered : 0.0};
}

}  // namespace

MemoryScore scoreMemory(const std::vector<RememberedEdge>& memory, const std::vector<TrueEdge>& truth,
                        const MemoryScoreParams& params) {
  struct Pair {
    double error;
    std::size_t element;
    std::size_t edge;
    bool right;
  };
  MemoryScore score;
  std::vector<Pair> pairs;
  for (const RememberedEdge& remembered : memory) {
    bool on_any = false;
    for (std::size_t e = 0; e < truth.size(); ++e) {
      const TrueEdge& edge = truth[e];
      const Fit fit =
          edge.curve ? fitCurve(remembered.world, edge, params) : fitStraight(remembered.world, edge, params);
      if (!fit.on_edge) continue;
      on_any = true;
      if (remembered.confirmed) pairs.push_back({fit.error, score.judged.size(), e, fit.right});
    }
    if (remembered.confirmed) {
      score.judged.push_back({remembered, MemoryScore::Verdict::kFalse, -1});
    } else {
      ++score.unconfirmed;
      score.unconfirmed_on_edges += on_any;
    }
  }
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const Pair& a, const Pair& b) { return a.error < b.error; });
  std::vector<int> elements_on(truth.size(), 0);
  std::vector<bool> found(truth.size(), false);
  std::vector<std::vector<Segment2>> on_curve(truth.size());
  // First one element for each edge, then the rest as duplicates.
  for (const bool first : {true, false}) {
    for (const Pair& pair : pairs) {
      auto& judgement = score.judged[pair.element];
      if (judgement.true_edge >= 0) continue;
      const TrueEdge& edge = truth[pair.edge];
      if (first && !edge.curve && (elements_on[pair.edge] > 0 || !pair.right)) continue;
      judgement.true_edge = static_cast<int>(pair.edge);
      judgement.verdict = pair.right ? MemoryScore::Verdict::kRight : MemoryScore::Verdict::kPartial;
      ++elements_on[pair.edge];
      if (edge.curve) on_curve[pair.edge].push_back(judgement.edge.world);
      if (pair.right && !edge.curve) found[pair.edge] = true;
    }
  }
  for (const auto& judgement : score.judged) {
    score.right += judgement.verdict == MemoryScore::Verdict::kRight;
    score.partial += judgement.verdict == MemoryScore::Verdict::kPartial;
    score.wrong += judgement.verdict == MemoryScore::Verdict::kFalse;
    if (judgement.verdict == MemoryScore::Verdict::kRight) score.right_m += judgement.edge.world.length();
  }
  for (std::size_t e = 0; e < truth.size(); ++e) {
    const TrueEdge& edge = truth[e];
    if (edge.curve && elements_on[e] > 0) {
      const Coverage covered = coverage(on_curve[e], edge);
      found[e] = covered.share >= params.found_share;
      score.on_edges += std::max(1.0, covered.times);
    } else {
      score.on_edges += elements_on[e];
    }
    score.edges_remembered += elements_on[e] > 0;
    if (!edge.shown_in_full) continue;
    const bool resolved = edge.longest_view_px >= params.resolved_px;
    ++score.shown;
    score.shown_resolved += resolved;
    score.found += found[e];
    score.found_resolved += found[e] && resolved;
    if (!found[e]) score.missed.push_back(static_cast<int>(e));
  }
  return score;
}

std::vector<RememberedEdge> rememberedIn(const MemorySnapshot& memory, const Pose2& T_world_robot) {
  const Pose2 T_world_odom = T_world_robot * inverse(memory.T_odom_robot);
  std::vector<RememberedEdge> remembered;
  remembered.reserve(memory.segments.size());
  for (const MemorySegment& s : memory.segments) {
    remembered.push_back({s.id, transform(T_world_odom, s.odom.floor()), s.label, s.confirmed});
  }
  return remembered;
}

}  // namespace vismem
