#include "evaluation/core/segment_accuracy.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "common/geometry/angles.h"
#include "common/geometry/plane.h"

namespace vismem {
namespace {

constexpr double kMaximumAngle_rad = degToRad(10.0);
constexpr double kMinimumAnnotated_px = 10.0;
constexpr double kFragmentTolerance_px = 2.0;
constexpr double kFragmentLine_px = 30.0;
constexpr double kFragmentPart_px = 3.0;
constexpr double kStructural_px = 5.0;

/// Restricts [t.begin, t.end] to where low <= c0 + c1 t <= high.
bool restrictTo(double c0, double c1, double low, double high, SegmentSpan& t) {
  if (std::abs(c1) < 1e-12) return c0 >= low && c0 <= high;
  double first = (low - c0) / c1;
  double second = (high - c0) / c1;
  if (first > second) std::swap(first, second);
  t.begin = std::max(t.begin, first);
  t.end = std::min(t.end, second);
  return t.begin < t.end;
}

/// How much of a segment others match: fractions of its length.
struct Cover {
  double united = 0.0;
  double summed = 0.0;
};

Cover coverOf(const Segment2& segment, const std::vector<Segment2>& others, double tolerance_px) {
  std::vector<SegmentSpan> parts;
  for (const auto& other : others) {
    if (const auto part = matchedPart(segment, other, tolerance_px)) parts.push_back(*part);
  }
  std::sort(parts.begin(), parts.end(), [](const auto& x, const auto& y) { return x.begin < y.begin; });
  Cover cover;
  double reached = 0.0;
  for (const auto& part : parts) {
    cover.united += std::max(0.0, part.end - std::max(part.begin, reached));
    cover.summed += part.end - part.begin;
    reached = std::max(reached, part.end);
  }
  return cover;
}

double coveredShare(const std::vector<Segment2>& segments, const std::vector<Segment2>& others,
                    double tolerance_px) {
  double matched_px = 0.0;
  double total_px = 0.0;
  for (const auto& segment : segments) {
    matched_px += segment.length() * coverOf(segment, others, tolerance_px).united;
    total_px += segment.length();
  }
  return total_px > 0.0 ? matched_px / total_px : 0.0;
}

std::vector<Segment2> longEnough(const std::vector<Segment2>& segments, double minimum_px) {
  std::vector<Segment2> out;
  std::copy_if(segments.begin(), segments.end(), std::back_inserter(out),
               [&](const Segment2& segment) { return segment.length() >= minimum_px; });
  return out;
}

PrecisionRecall structuralMatch(const std::vector<Segment2>& detected, const std::vector<Segment2>& lines) {
  std::vector<std::tuple<double, std::size_t, std::size_t>> pairs;
  for (std::size_t i = 0; i < detected.size(); ++i) {
    for (std::size_t j = 0; j < lines.size(); ++j) {
      if ((detected[i].middle() - lines[j].middle()).lpNorm<Eigen::Infinity>() > kStructural_px) continue;
      const double straight = (detected[i].a - lines[j].a).norm() + (detected[i].b - lines[j].b).norm();
      const double crossed = (detected[i].a - lines[j].b).norm() + (detected[i].b - lines[j].a).norm();
      const double mean = 0.5 * std::min(straight, crossed);
      if (mean <= kStructural_px) pairs.emplace_back(mean, i, j);
    }
  }
  std::sort(pairs.begin(), pairs.end());
  std::vector<bool> used_detected(detected.size(), false);
  std::vector<bool> used_line(lines.size(), false);
  int matched = 0;
  for (const auto& [mean, i, j] : pairs) {
    if (used_detected[i] || used_line[j]) continue;
    used_detected[i] = used_line[j] = true;
    ++matched;
  }
  const auto share = [&](std::size_t of) {
    return of == 0 ? 0.0 : static_cast<double>(matched) / static_cast<double>(of);
  };
  return {share(detected.size()), share(lines.size())};
}

}  // namespace

std::optional<SegmentSpan> matchedPart(const Segment2& d, const Segment2& g, double tolerance_px) {
  const Eigen::Vector2d ab = d.b - d.a;
  const Eigen::Vector2d along = g.b - g.a;
  // Most pairs are far apart or of other directions: those go without a root or an arc tangent.
  static const double kMaximumTangent = std::tan(kMaximumAngle_rad);
  const double dot = along.dot(ab);
  const double cross = cross2(along, ab);
  if (dot == 0.0 || std::abs(cross) > kMaximumTangent * std::abs(dot)) return std::nullopt;
  const double reach = 0.5 * (ab.lpNorm<1>() + along.lpNorm<1>()) + tolerance_px;
  if ((d.middle() - g.middle()).squaredNorm() > reach * reach) return std::nullopt;
  const double length = g.length();
  const Eigen::Vector2d u = along / length;
  const Eigen::Vector2d n = turned90(u);
  const Eigen::Vector2d a = d.a - g.a;
  SegmentSpan t{0.0, 1.0};
  if (!restrictTo(a.dot(n), ab.dot(n), -tolerance_px, tolerance_px, t)) return std::nullopt;
  if (!restrictTo(a.dot(u), ab.dot(u), 0.0, length, t)) return std::nullopt;
  return t;
}

PrecisionRecall lengthMatch(const std::vector<Segment2>& detected, const std::vector<Segment2>& annotated,
                            double tolerance_px) {
  return {coveredShare(detected, annotated, tolerance_px),
          coveredShare(longEnough(annotated, kMinimumAnnotated_px), detected, tolerance_px)};
}

ImageScore scoreImage(const std::vector<Segment2>& detected, const std::vector<Segment2>& annotated) {
  ImageScore score;
  score.segments = static_cast<long>(detected.size());
  for (std::size_t i = 0; i < kTolerances_px.size(); ++i) {
    score.at[i] = lengthMatch(detected, annotated, kTolerances_px[i]);
  }
  const auto lines = longEnough(annotated, kMinimumAnnotated_px);
  score.structural = structuralMatch(detected, lines);
  for (const auto& line : lines) {
    const Cover cover = coverOf(line, detected, kFragmentTolerance_px);
    score.recalled_px += cover.united * line.length();
    score.covering_px += cover.summed * line.length();
    if (line.length() < kFragmentLine_px || cover.united < 0.5) continue;
    ++score.lines;
    for (const auto& segment : detected) {
      const auto part = matchedPart(segment, line, kFragmentTolerance_px);
      if (part && (part->end - part->begin) * segment.length() >= kFragmentPart_px) ++score.fragments;
    }
  }
  return score;
}

AccuracySummary summarize(const std::vector<ImageScore>& images) {
  AccuracySummary sum;
  if (images.empty()) return sum;
  const auto n = static_cast<double>(images.size());
  long lines = 0;
  long fragments = 0;
  double recalled_px = 0.0;
  double covering_px = 0.0;
  for (const ImageScore& image : images) {
    for (std::size_t i = 0; i < kTolerances_px.size(); ++i) {
      sum.at[i].precision += image.at[i].precision / n;
      sum.at[i].recall += image.at[i].recall / n;
    }
    sum.structural.precision += image.structural.precision / n;
    sum.structural.recall += image.structural.recall / n;
    lines += image.lines;
    fragments += image.fragments;
    recalled_px += image.recalled_px;
    covering_px += image.covering_px;
    sum.segments += static_cast<double>(image.segments) / n;
  }
  sum.fragments = lines > 0 ? static_cast<double>(fragments) / static_cast<double>(lines) : 0.0;
  sum.redundancy = recalled_px > 0.0 ? covering_px / recalled_px : 0.0;
  return sum;
}

}  // namespace vismem
