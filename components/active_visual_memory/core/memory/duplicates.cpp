#include "active_visual_memory/core/memory/duplicates.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/geometry/plane.h"
#include "common/visual_memory/labels.h"

namespace vismem {
namespace {

constexpr double kKnownPolarity = 6.0;  // grey levels; as AssociationParams::min_polarity_strength

}  // namespace

bool samePolarity(const Segment2& a, double strength_a, const Segment2& b, double strength_b) {
  if (strength_a < kKnownPolarity || strength_b < kKnownPolarity) return true;
  return (a.b - a.a).dot(b.b - b.a) > 0.0;
}

Neighbourhood neighbourhood(const Segment2& base, const Segment2& other) {
  const double length = base.length();
  const auto [low, high] =
      std::minmax({projectionFraction(other.a, base) * length, projectionFraction(other.b, base) * length});
  Neighbourhood near;
  near.from_m = std::max(0.0, low);
  near.gap_m = near.from_m - std::min(length, high);
  const Eigen::Vector2d along = (base.b - base.a) / length;
  const Eigen::Vector2d between = base.a + near.middle_m() * along;
  near.distance_m = distanceToLine(between, other);
  near.left_m = std::copysign(near.distance_m, cross2(other.b - other.a, between - other.a));
  return near;
}

std::optional<Neighbourhood> antiparallel(const Segment2& one, const Segment2& other, double max_angle_rad) {
  const double cosine = (one.b - one.a).dot(other.b - other.a) / (one.length() * other.length());
  if (!(cosine <= -std::cos(max_angle_rad))) return std::nullopt;
  const Neighbourhood near = neighbourhood(one, other);
  return near.gap_m < 0.0 ? std::optional(near) : std::nullopt;
}

Eigen::AlignedBox2d boxAround(const Segment2& segment, double margin_m) {
  constexpr double kOblique = 1.1;  // the lines are compared square to one of them
  const Eigen::Vector2d margin = Eigen::Vector2d::Constant(kOblique * margin_m);
  return {segment.a.cwiseMin(segment.b) - margin, segment.a.cwiseMax(segment.b) + margin};
}

std::pmr::vector<FloorSegment> cleanDuplicates(std::span<const FloorSegment> segments, double max_angle_rad,
                                               double max_distance_m, double max_gap_m,
                                               std::pmr::memory_resource* scratch) {
  std::pmr::vector<FloorSegment> clean(scratch);
  for (const FloorSegment& segment : segments) {
    bool joined = false;
    for (FloorSegment& kept : clean) {
      if (!labelsCompatible(kept.label, segment.label)) continue;
      if (!samePolarity(kept.odom(), kept.strength, segment.odom(), segment.strength)) continue;
      const Neighbourhood n = neighbourhood(kept.odom(), segment.odom());
      if (n.distance_m > max_distance_m || n.gap_m > max_gap_m ||
          lineAngle(kept.odom(), segment.odom()) > max_angle_rad) {
        continue;
      }
      // The line of the longer one, the extent of both.
      const bool longer = segment.odom().length() > kept.odom().length();
      FloorSegment line = longer ? segment : kept;
      const FloorSegment& other = longer ? kept : segment;
      const Eigen::Vector2d origin = line.a.p;
      const double length = line.odom().length();
      const Eigen::Vector2d along = (line.b.p - origin).normalized();
      FloorSegment o = runningAlong(along, other);
      const double ta = along.dot(o.a.p - origin);
      const double tb = along.dot(o.b.p - origin);
      o.a.p = origin + ta * along;
      o.b.p = origin + tb * along;
      if (ta < 0.0) line.a = o.a;
      if (tb > length) line.b = o.b;
      if (line.label == kUnknownLabel) line.label = other.label;
      kept = line;
      joined = true;
      break;
    }
    if (!joined) clean.push_back(segment);
  }
  return clean;
}

}  // namespace vismem
