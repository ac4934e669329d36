#include "common/segment_map/symmetry.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "common/geometry/angles.h"

namespace vismem {
namespace {

struct LabelledPoint {
  Eigen::Vector2d p;
  double direction_rad = 0.0;
  const Label* label = nullptr;
  double length_m = 0.0;  ///< of the segment that it stands for
};

/// Of a turn about a point: transform(turnAbout(c, angle), c) is c.
Pose2 turnAbout(const Eigen::Vector2d& centre, double angle_rad) {
  const Eigen::Vector2d turned = transform(Pose2{0.0, 0.0, angle_rad}, centre);
  return {centre.x() - turned.x(), centre.y() - turned.y(), wrapAngle(angle_rad)};
}

Eigen::Vector2d centroidOf(const SegmentMap& map) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double length = 0.0;
  for (const MapSegment& segment : map.segments) {
    const Segment2 floor = segment.world.floor();
    sum += floor.length() * floor.middle();
    length += floor.length();
  }
  // Upright segments have no length in plan view: a map of these alone has the mean of its places.
  if (length > 0.0) return sum / length;
  for (const MapSegment& segment : map.segments) sum += segment.world.floor().a;
  return sum / static_cast<double>(map.segments.size());
}

/// Farthest from the centre first: wrong motions fail there at once.
std::vector<LabelledPoint> pointsOf(const SegmentMap& map, const Eigen::Vector2d& centre, double step_m) {
  std::vector<LabelledPoint> points;
  for (const MapSegment& segment : map.segments) {
    const Segment2 floor = segment.world.floor();
    const int steps = std::max(1, static_cast<int>(std::ceil(floor.length() / step_m)));
    for (int i = 0; i <= steps; ++i) {
      points.push_back({floor.a + (floor.b - floor.a) * (double(i) / steps), floor.direction(),
                        &segment.label, std::max(floor.length(), step_m) / (steps + 1)});
    }
  }
  std::sort(points.begin(), points.end(), [&](const LabelledPoint& a, const LabelledPoint& b) {
    return (a.p - centre).squaredNorm() > (b.p - centre).squaredNorm();
  });
  return points;
}

bool falls(const LabelledPoint& point, const Pose2& motion, const SegmentMap& map,
           const SymmetryParams& params) {
  const Eigen::Vector2d p = transform(motion, point.p);
  return std::any_of(map.segments.begin(), map.segments.end(), [&](const MapSegment& segment) {
    if (segment.label != *point.label) return false;
    const Segment2 floor = segment.world.floor();
    if (distanceToSegment(p, floor) > params.tolerance_m) return false;
    const double turn = point.direction_rad + motion.theta - floor.direction();
    const bool has_direction = floor.length() > params.tolerance_m;
    // An edge may be written from either end.
    return !has_direction || std::abs(std::sin(turn)) <= std::sin(params.angle_rad);
  });
}

/// Whether enough of the map falls on its counterpart; wrong motions end early.
bool mapsOntoItself(const std::vector<LabelledPoint>& points, const Pose2& motion, const SegmentMap& map,
                    const SymmetryParams& params) {
  double total_m = 0.0;
  for (const LabelledPoint& point : points) total_m += point.length_m;
  double missed_m = 0.0;
  for (const LabelledPoint& point : points) {
    if (!falls(point, motion, map, params)) missed_m += point.length_m;
    if (missed_m > (1.0 - params.share) * total_m) return false;
  }
  return true;
}

/// Turns that bring the rarest kind of segment onto one of its own kind.
std::vector<double> candidateTurns(const SegmentMap& map, const Eigen::Vector2d& centre) {
  std::map<Label, std::vector<const MapSegment*>> by_label;
  for (const MapSegment& segment : map.segments) by_label[segment.label].push_back(&segment);
  const auto rarest = std::min_element(by_label.begin(), by_label.end(), [](const auto& a, const auto& b) {
    return a.second.size() < b.second.size();
  });
  const auto fartherOff = [&](const MapSegment* a, const MapSegment* b) {
    const auto distance = [&](const MapSegment* s) { return (s->world.floor().middle() - centre).norm(); };
    return distance(a) < distance(b);
  };
  const auto& kind = rarest->second;
  const Segment2 reference = (*std::max_element(kind.begin(), kind.end(), fartherOff))->world.floor();
  const auto bearing = [&](const Eigen::Vector2d& p) {
    return std::atan2(p.y() - centre.y(), p.x() - centre.x());
  };
  std::vector<double> turns;
  if ((reference.middle() - centre).norm() < 1e-6) {
    // One segment through the centre: only a half turn keeps it.
    turns.push_back(std::numbers::pi);
    return turns;
  }
  for (const MapSegment* segment : kind) {
    const double turn = bearing(segment->world.floor().middle()) - bearing(reference.middle());
    turns.push_back(turn < 0.0 ? turn + 2.0 * std::numbers::pi : turn);
  }
  return turns;
}

}  // namespace

std::vector<Pose2> symmetriesOf(const SegmentMap& map, const SymmetryParams& params) {
  if (map.segments.empty()) return {};
  const Eigen::Vector2d centre = centroidOf(map);
  const std::vector<LabelledPoint> points = pointsOf(map, centre, params.point_step_m);
  std::vector<double> turns = candidateTurns(map, centre);
  std::sort(turns.begin(), turns.end());
  std::vector<Pose2> found;
  double last = 0.0;
  for (const double turn : turns) {
    if (turn < last + params.least_turn_rad || turn > 2.0 * std::numbers::pi - params.least_turn_rad)
      continue;
    const Pose2 motion = turnAbout(centre, turn);
    if (!mapsOntoItself(points, motion, map, params)) continue;
    found.push_back(motion);
    last = turn;
  }
  return found;
}

}  // namespace vismem
