#include "active_visual_memory/core/memory/data_association.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "common/geometry/angles.h"
#include "common/visual_memory/labels.h"

namespace vismem {

namespace {

/// Association cost, lower is better. @return empty if a gate fails.
/// @param angle  between both.
std::optional<double> costAt(double angle, const ImageSegment& observed, const Expectation& expected,
                             const AssociationParams& params) {
  if (!labelsCompatible(observed.label, expected.predicted.label)) return std::nullopt;
  const Segment2& o = observed.px;
  const Segment2& p = expected.predicted.px;
  const bool polarity_known =
      observed.strength >= params.min_polarity_strength && expected.strength >= params.min_polarity_strength;
  if (params.use_polarity && polarity_known && (o.b - o.a).dot(p.b - p.a) < 0.0) return std::nullopt;

  // Overlap along the prediction, in pixels.
  const double length = p.length();
  const double shorter = std::min(length, o.length());
  if (!(shorter > 0.0)) return std::nullopt;
  const double ta = projectionFraction(o.a, p) * length;
  const double tb = projectionFraction(o.b, p) * length;
  const double low = std::max(0.0, std::min(ta, tb));
  const double high = std::min(length, std::max(ta, tb));
  const double overlap = (high - low) / shorter;
  if (overlap < params.min_overlap) return std::nullopt;

  // Distance of both lines at the middle of the overlap; outside it they may diverge.
  const Eigen::Vector2d on_p = p.a + 0.5 * (low + high) / length * (p.b - p.a);
  const double normal = distanceToLine(on_p, o);
  if (normal > params.max_normal_px) return std::nullopt;
  return normal / params.max_normal_px + angle / params.max_angle_rad + (1.0 - std::min(1.0, overlap));
}

/// Whether both lie on one straight line, as fragments of an edge do.
bool inLine(const Segment2& fragment, const Segment2& match, const AssociationParams& params) {
  const double length = match.length();
  const auto fits = [&](const Eigen::Vector2d& end) {
    const double t = projectionFraction(end, match) * length;
    const double beyond = std::max({0.0, -t, t - length});
    return distanceToLine(end, match) <= params.fragment_px + params.fragment_rad * beyond;
  };
  return fits(fragment.a) && fits(fragment.b);
}

}  // namespace

AssociationResult associate(std::span<const ImageSegment> observed, std::span<const Expectation> expected,
                            const AssociationParams& params, std::pmr::memory_resource* scratch) {
  std::pmr::vector<std::tuple<double, int, int>> candidates(scratch);
  std::pmr::vector<double> directions(scratch);
  for (const Expectation& e : expected) directions.push_back(e.predicted.px.direction());
  for (int o = 0; o < static_cast<int>(observed.size()); ++o) {
    const double direction = observed[o].px.direction();
    for (int p = 0; p < static_cast<int>(expected.size()); ++p) {
      const double angle = lineAngleDifference(direction, directions[p]);
      if (angle > params.max_angle_rad) continue;
      if (const auto cost = costAt(angle, observed[o], expected[p], params)) {
        candidates.emplace_back(*cost, o, p);
      }
    }
  }
  std::sort(candidates.begin(), candidates.end());

  AssociationResult result(scratch);
  std::pmr::vector<bool> observed_taken(observed.size(), false, scratch);
  std::pmr::vector<int> match_of(expected.size(), -1, scratch);
  for (const auto& [cost, o, p] : candidates) {
    if (observed_taken[o] || match_of[p] >= 0) continue;
    observed_taken[o] = true;
    match_of[p] = o;
    result.matches.push_back({o, p});
  }
  // A remaining candidate in line with the match is a fragment of the same line.
  for (const auto& [cost, o, p] : candidates) {
    // Every prediction with a remaining candidate has a match.
    if (observed_taken[o] || !inLine(observed[o].px, observed[match_of[p]].px, params)) continue;
    observed_taken[o] = true;
    result.supports.push_back({o, p});
  }
  for (int p = 0; p < static_cast<int>(expected.size()); ++p) {
    if (match_of[p] < 0) result.unobserved.push_back(p);
  }
  for (int o = 0; o < static_cast<int>(observed.size()); ++o) {
    if (!observed_taken[o]) result.unpredicted.push_back(o);
  }
  return result;
}

}  // namespace vismem
