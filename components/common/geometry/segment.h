/// @file Straight segments in the image, on the floor and in space. Pure.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <optional>
#include <utility>

#include "common/geometry/pose.h"

namespace vismem {

/// A segment in a plane: the image [px] or the floor [m].
struct Segment2 {
  Eigen::Vector2d a = Eigen::Vector2d::Zero();
  Eigen::Vector2d b = Eigen::Vector2d::Zero();

  double length() const { return (b - a).norm(); }
  Eigen::Vector2d middle() const { return 0.5 * (a + b); }
  /// Direction from a to b [rad].
  double direction() const;
};

/// A segment in space [m].
struct Segment3 {
  Eigen::Vector3d a = Eigen::Vector3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();

  double length() const { return (b - a).norm(); }
  Eigen::Vector3d middle() const { return 0.5 * (a + b); }
  /// The plan view: x and y of both ends.
  Segment2 floor() const { return {a.head<2>(), b.head<2>()}; }
};

/// A segment of the floor in space, at z = 0.
inline Segment3 onFloor(const Segment2& floor) {
  return {{floor.a.x(), floor.a.y(), 0.0}, {floor.b.x(), floor.b.y(), 0.0}};
}

Segment2 transform(const Pose2& T_a_b, const Segment2& segment_b);
Segment3 transform(const Pose2& T_a_b, const Segment3& segment_b);

/// Foot of the perpendicular from `p` on the segment's line, as a fraction of a -> b (0 at a, 1 at b; outside
/// [0, 1] beyond the ends). 0 for a segment without length.
double projectionFraction(const Eigen::Vector2d& p, const Segment2& segment);
/// Distance to the nearest point of the segment.
double distanceToSegment(const Eigen::Vector2d& p, const Segment2& segment);
double distanceToSegment(const Eigen::Vector3d& p, const Segment3& segment);
/// Distance to the infinite line; to the point a for a segment without length.
double distanceToLine(const Eigen::Vector2d& p, const Segment2& segment);

/// A line fitted to a shallow arc cuts it at this share of its half length from its middle.
inline const double kArcCut = 1.0 / std::sqrt(3.0);

/// The two points where the line of a chord cuts the arc that it was fitted to.
inline Segment2 arcPoints(const Segment2& chord) {
  const Eigen::Vector2d half = 0.5 * kArcCut * (chord.b - chord.a);
  return {chord.middle() - half, chord.middle() + half};
}

/// The part of the segment inside a disc, as fractions of a -> b.
/// @return empty if they do not meet; a segment without length is inside or not as a whole.
std::optional<std::pair<double, double>> clipToDisc(const Segment2& segment, const Eigen::Vector2d& centre,
                                                    double radius);

/// The part of the segment inside an axis-aligned box, ends in the same order.
/// @return empty if no part lies inside.
std::optional<Segment2> clipToBox(const Segment2& segment, const Eigen::Vector2d& low,
                                  const Eigen::Vector2d& high);

}  // namespace vismem
