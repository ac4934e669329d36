#include "common/geometry/segment.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/geometry/plane.h"

namespace vismem {
namespace {

/// Fraction of a -> b nearest to p, clamped to the segment, in any dimension.
template <typename Vector>
double nearestFraction(const Vector& p, const Vector& a, const Vector& b) {
  const Vector ab = b - a;
  const double squared = ab.squaredNorm();
  return squared > 0.0 ? std::clamp((p - a).dot(ab) / squared, 0.0, 1.0) : 0.0;
}

}  // namespace

double Segment2::direction() const {
  return std::atan2(b.y() - a.y(), b.x() - a.x());
}

Segment2 transform(const Pose2& T_a_b, const Segment2& segment_b) {
  return {transform(T_a_b, segment_b.a), transform(T_a_b, segment_b.b)};
}

Segment3 transform(const Pose2& T_a_b, const Segment3& segment_b) {
  return {transform(T_a_b, segment_b.a), transform(T_a_b, segment_b.b)};
}

double projectionFraction(const Eigen::Vector2d& p, const Segment2& segment) {
  const Eigen::Vector2d ab = segment.b - segment.a;
  const double squared = ab.squaredNorm();
  return squared > 0.0 ? (p - segment.a).dot(ab) / squared : 0.0;
}

double distanceToSegment(const Eigen::Vector2d& p, const Segment2& segment) {
  const double t = nearestFraction(p, segment.a, segment.b);
  return (p - (segment.a + t * (segment.b - segment.a))).norm();
}

double distanceToSegment(const Eigen::Vector3d& p, const Segment3& segment) {
  const double t = nearestFraction(p, segment.a, segment.b);
  return (p - (segment.a + t * (segment.b - segment.a))).norm();
}

double distanceToLine(const Eigen::Vector2d& p, const Segment2& segment) {
  const Eigen::Vector2d ab = segment.b - segment.a;
  const double length = ab.norm();
  if (length == 0.0) return (p - segment.a).norm();
  const Eigen::Vector2d ap = p - segment.a;
  return std::abs(cross2(ab, ap)) / length;
}

std::optional<std::pair<double, double>> clipToDisc(const Segment2& segment, const Eigen::Vector2d& centre,
                                                    double radius) {
  const Eigen::Vector2d d = segment.b - segment.a;
  const Eigen::Vector2d from = segment.a - centre;
  const double a = d.squaredNorm();
  const double b = 2.0 * from.dot(d);
  const double c = from.squaredNorm() - radius * radius;
  if (a < 1e-12) return c <= 0.0 ? std::optional(std::pair{0.0, 1.0}) : std::nullopt;
  const double discriminant = b * b - 4.0 * a * c;
  if (discriminant <= 0.0) return std::nullopt;
  const double low = std::max(0.0, (-b - std::sqrt(discriminant)) / (2.0 * a));
  const double high = std::min(1.0, (-b + std::sqrt(discriminant)) / (2.0 * a));
  if (low >= high) return std::nullopt;
  return std::pair{low, high};
}

std::optional<Segment2> clipToBox(const Segment2& segment, const Eigen::Vector2d& low,
                                  const Eigen::Vector2d& high) {
  // Liang-Barsky: shrink the parameter interval [t0, t1] by each side of the box.
  double t0 = 0.0;
  double t1 = 1.0;
  const Eigen::Vector2d d = segment.b - segment.a;
  for (int axis = 0; axis < 2; ++axis) {
    if (d[axis] == 0.0) {
      if (segment.a[axis] < low[axis] || segment.a[axis] > high[axis]) return std::nullopt;
      continue;
    }
    double enter = (low[axis] - segment.a[axis]) / d[axis];
    double leave = (high[axis] - segment.a[axis]) / d[axis];
    if (enter > leave) std::swap(enter, leave);
    t0 = std::max(t0, enter);
    t1 = std::min(t1, leave);
    if (t0 > t1) return std::nullopt;
  }
  return Segment2{segment.a + t0 * d, segment.a + t1 * d};
}

}  // namespace vismem
