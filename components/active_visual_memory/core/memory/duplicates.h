/// @file Relations of two segments on the floor, and copies of one line among those of one image.
/// Pure. Implements M2. See M3.
#pragma once

#include <Eigen/Geometry>
#include <memory_resource>
#include <optional>
#include <span>
#include <vector>

#include "active_visual_memory/core/ground/floor_segment.h"
#include "common/geometry/angles.h"
#include "common/geometry/segment.h"

namespace vismem {

/// @return false if both edges have a known polarity (contrast of at least 6 grey levels) and opposite
/// directions.
bool samePolarity(const Segment2& a, double strength_a, const Segment2& b, double strength_b);

/// Relation of two segments.
struct Neighbourhood {
  double distance_m = 0.0;  ///< of the second line, in the middle of the overlap
  double gap_m = 0.0;       ///< between their extents along the first one; negative: they overlap
  double from_m = 0.0;      ///< beginning of the overlap, along the first one from its end a
  double left_m = 0.0;      ///< signed distance: > 0 if the first one lies to the left of the second

  double overlap_m() const { return -gap_m; }
  double middle_m() const { return from_m - 0.5 * gap_m; }
};

/// Angle between the lines of two segments [rad]. It costs more than their neighbourhood.
inline double lineAngle(const Segment2& one, const Segment2& other) {
  return lineAngleDifference(one.direction(), other.direction());
}

/// @param base  of length > 0.
Neighbourhood neighbourhood(const Segment2& base, const Segment2& other);

/// Largest angle between the two edges of a line marking.
inline constexpr double kMarkingAngle_rad = 0.10;

/// The relation of two antiparallel segments side by side: the edges of a line marking. Each lies to the left
/// of the other, or each to the right (`left_m` < 0).
/// @return empty if they are not antiparallel within the angle, or do not overlap.
std::optional<Neighbourhood> antiparallel(const Segment2& one, const Segment2& other,
                                          double max_angle_rad = kMarkingAngle_rad);

/// Box around a segment. Segments with a neighbourhood of at most 0.12 rad, `d` [m] and a gap of `g` [m] have
/// boxes that meet when one of them has the margin `d + g`: a fast test before the exact one.
Eigen::AlignedBox2d boxAround(const Segment2& segment, double margin_m = 0.0);

/// The gates of `Memory.Near.*` are multiplied by this within one image. Copies of a line in one image share
/// the errors of camera pose and odometry, so they agree better with each other than an image agrees with the
/// memory.
inline constexpr double kDuplicateGateShare = 0.5;

/// Joins floor segments of one image that are copies or pieces of one line: the longer one's line, the extent
/// of both. Order is kept.
std::pmr::vector<FloorSegment> cleanDuplicates(
    std::span<const FloorSegment> segments, double max_angle_rad, double max_distance_m, double max_gap_m,
    std::pmr::memory_resource* scratch = std::pmr::get_default_resource());

}  // namespace vismem
