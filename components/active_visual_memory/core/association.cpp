#include "active_visual_memory/core/association.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "common/geometry/angles.h"

namespace vismem {

bool labelsCompatible(const Label& a, const Label& b) {
  return a == b || a == kUnknownLabel || b == kUnknownLabel;
}

std::optional<double> associationCost(const ImageSegment& observed, const Expectation& expected,
                                      const AssociationParams& params) {
  if (!labelsCompatible(observed.label, expected.predicted.label)) return std::nullopt;
  const Segment2& o = observed.px;
  const Segment2& p = expected.predicted.px;
  const double angle = lineAngleDifference(o.direction(), p.direction());
  if (angle > params.max_angle_rad) return std::nullopt;
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

  // Distance of both lines in the middle of the overlap: outside it they may well diverge.
  const Eigen::Vector2d on_p = p.a + 0.5 * (low + high) / length * (p.b - p.a);
  const double normal = distanceToLine(on_p, o);
  if (normal > params.max_normal_px) return std::nullopt;
  return normal / params.max_normal_px + angle / params.max_angle_rad + (1.0 - std::min(1.0, overlap));
}

AssociationResult associate(const std::vector<ImageSegment>& observed,
                            const std::vector<Expectation>& expected, const AssociationParams& params) {
  std::vector<std::tuple<double, int, int>> candidates;
  for (int o = 0; o < static_cast<int>(observed.size()); ++o) {
    for (int p = 0; p < static_cast<int>(expected.size()); ++p) {
      if (const auto cost = associationCost(observed[o], expected[p], params)) {
        candidates.emplace_back(*cost, o, p);
      }
    }
  }
  std::sort(candidates.begin(), candidates.end());

  AssociationResult result;
  std::vector<bool> observed_taken(observed.size(), false);
  std::vector<bool> expected_taken(expected.size(), false);
  for (const auto& [cost, o, p] : candidates) {
    if (observed_taken[o] || expected_taken[p]) continue;
    observed_taken[o] = expected_taken[p] = true;
    result.matches.push_back({o, p});
  }
  // What is left over and still fits a prediction is a fragment of the same line.
  for (const auto& [cost, o, p] : candidates) {
    if (observed_taken[o]) continue;
    observed_taken[o] = true;
    result.supports.push_back({o, p});
  }
  for (int p = 0; p < static_cast<int>(expected.size()); ++p) {
    if (!expected_taken[p]) result.unobserved.push_back(p);
  }
  for (int o = 0; o < static_cast<int>(observed.size()); ++o) {
    if (!observed_taken[o]) result.unpredicted.push_back(o);
  }
  return result;
}

}  // namespace vismem
