#include "localization/corridor_world.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/geometry/angles.h"

namespace vismem::test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kLong_m = 8.0;  // centre line: a rectangle of 8 x 5 m
constexpr double kShort_m = 5.0;
constexpr double kHalfWidth_m = 0.75;
constexpr double kRing_m = 2.0 * (kLong_m + kShort_m);

struct Door {
  double from;
  double width;
};

/// A wall from `a` towards `b`, cut into skirting and door feet.
void addWall(SegmentMap& map, const Eigen::Vector2d& a, const Eigen::Vector2d& b,
             const std::vector<Door>& doors) {
  const Eigen::Vector2d along = (b - a).normalized();
  const auto add = [&](double from, double to, const Label& label) {
    const Eigen::Vector2d p = a + from * along;
    const Eigen::Vector2d q = a + to * along;
    map.segments.push_back({{{p.x(), p.y(), 0.0}, {q.x(), q.y(), 0.0}}, label, 0.0});
  };
  double at = 0.0;
  for (const Door& door : doors) {
    add(at, door.from, "skirting");
    add(door.from, door.from + door.width, "door_foot");
    at = door.from + door.width;
  }
  add(at, (b - a).norm(), "skirting");
}

/// Pose on the centre line; at corners the robot turns on the spot during 0.3 m of path.
Pose2 onRing(double along_m, double direction) {
  double s = std::fmod(along_m, kRing_m);
  if (s < 0.0) s += kRing_m;
  const Eigen::Vector2d corners[] = {{0, 0}, {kLong_m, 0}, {kLong_m, kShort_m}, {0, kShort_m}};
  const double sides[] = {kLong_m, kShort_m, kLong_m, kShort_m};
  int side = 0;
  while (s > sides[side]) s -= sides[side++];
  const Eigen::Vector2d from = corners[side];
  const Eigen::Vector2d to = corners[(side + 1) % 4];
  const Eigen::Vector2d p = from + (to - from).normalized() * s;
  constexpr double kTurn_m = 0.3;
  double heading = side * 0.5 * kPi;
  if (s > sides[side] - kTurn_m) heading += 0.25 * kPi * (s - sides[side] + kTurn_m) / kTurn_m;
  if (s < kTurn_m) heading -= 0.25 * kPi * (kTurn_m - s) / kTurn_m;
  if (direction < 0.0) heading += kPi;
  return {p.x(), p.y(), wrapAngle(heading)};
}

double gaussian(RandomEngine& engine, double sigma) {
  // Sum of twelve uniforms: the same with every standard library.
  double sum = -6.0;
  for (int i = 0; i < 12; ++i) sum += uniform(engine, 0.0, 1.0);
  return sigma * sum;
}

bool cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Segment2& wall) {
  const auto side = [](const Eigen::Vector2d& p, const Eigen::Vector2d& q, const Eigen::Vector2d& r) {
    return (q.x() - p.x()) * (r.y() - p.y()) - (q.y() - p.y()) * (r.x() - p.x());
  };
  return side(a, b, wall.a) * side(a, b, wall.b) < 0.0 &&
         side(wall.a, wall.b, a) * side(wall.a, wall.b, b) < 0.0;
}

}  // namespace

SegmentMap corridorMap() {
  SegmentMap map;
  const double w = kHalfWidth_m;
  // Outer walls, then inner ones.
  addWall(map, {-w, -w}, {kLong_m + w, -w}, {{1.3, 0.9}, {4.1, 0.8}, {6.6, 0.7}});
  addWall(map, {kLong_m + w, -w}, {kLong_m + w, kShort_m + w}, {{2.2, 1.0}});
  addWall(map, {kLong_m + w, kShort_m + w}, {-w, kShort_m + w}, {{0.9, 0.8}, {3.2, 0.6}, {7.4, 0.9}});
  addWall(map, {-w, kShort_m + w}, {-w, -w}, {{3.9, 0.8}});
  addWall(map, {w, w}, {kLong_m - w, w}, {{0.8, 0.8}, {5.0, 0.6}});
  addWall(map, {kLong_m - w, w}, {kLong_m - w, kShort_m - w}, {{1.2, 0.9}});
  addWall(map, {kLong_m - w, kShort_m - w}, {w, kShort_m - w}, {{2.4, 0.7}});
  addWall(map, {w, kShort_m - w}, {w, w}, {{0.6, 0.8}});
  return map;
}

CorridorWorld::CorridorWorld(const CorridorParams& params, std::uint64_t seed)
    : params_(params), engine_(seed), map_(corridorMap()) {
  along_m_ = uniform(engine_, 0.0, kRing_m);
  direction_ = uniform(engine_, 0.0, 1.0) < 0.5 ? -1.0 : 1.0;
  scale_ = 1.0 + gaussian(engine_, params_.odometry_scale_error);
  T_world_robot_ = onRing(along_m_, direction_);
  // Odometry begins anywhere.
  T_odom_robot_.x = uniform(engine_, -3.0, 3.0);
  T_odom_robot_.y = uniform(engine_, -3.0, 3.0);
  T_odom_robot_.theta = uniform(engine_, -kPi, kPi);
}

void CorridorWorld::kidnap() {
  along_m_ += uniform(engine_, 4.0, kRing_m - 4.0);
  T_world_robot_ = onRing(along_m_, direction_);
  memory_.clear();
  false_.clear();
  ++epoch_;
}

void CorridorWorld::drive(double dt_s) {
  const double way = params_.speed_mps * dt_s;
  along_m_ += direction_ * way;
  const Pose2 before = T_world_robot_;
  T_world_robot_ = onRing(along_m_, direction_);
  Pose2 moved = inverse(before) * T_world_robot_;
  moved.x *= scale_;
  moved.y *= scale_;
  moved.theta += gaussian(engine_, params_.odometry_turn_noise * std::sqrt(way));
  T_odom_robot_ = T_odom_robot_ * moved;
  pan_rad_ = 2.2 * std::sin(time_s_ * 2.0 * kPi / 8.0);  // a period of 8 s
}

bool CorridorWorld::isVisible(const Eigen::Vector2d& p_world) const {
  const Eigen::Vector2d p_robot = transform(inverse(T_world_robot_), p_world);
  const double range = p_robot.norm();
  if (range > params_.range_m || range < 0.4) return false;
  const double bearing = std::atan2(p_robot.y(), p_robot.x());
  if (std::abs(angleDifference(bearing, pan_rad_)) > 0.5 * params_.fov_rad) return false;
  // Slightly in front of the point, so that its own wall does not occlude it.
  const Eigen::Vector2d target = T_world_robot_.position() + 0.98 * (p_world - T_world_robot_.position());
  return std::none_of(map_.segments.begin(), map_.segments.end(), [&](const MapSegment& wall) {
    return cross(T_world_robot_.position(), target, wall.world.floor());
  });
}

void CorridorWorld::look() {
  const auto stamp_us = static_cast<StampUs>(std::llround(time_s_ * kSecondUs));
  const Pose2 T_odom_world = T_odom_robot_ * inverse(T_world_robot_);
  for (std::size_t i = 0; i < map_.segments.size(); ++i) {
    const MapSegment& wall = map_.segments[i];
    const Segment2 plan = wall.world.floor();
    const int steps = std::max(2, static_cast<int>(plan.length() / 0.1));
    double low = 2.0;
    double high = -1.0;
    for (int k = 0; k <= steps; ++k) {
      const double fraction = static_cast<double>(k) / steps;
      if (!isVisible(plan.a + fraction * (plan.b - plan.a))) continue;
      low = std::min(low, fraction);
      high = std::max(high, fraction);
    }
    if ((high - low) * plan.length() < 0.2) continue;
    auto [entry, is_new] = memory_.try_emplace(i);
    Remembered& remembered = entry->second;
    if (is_new) {
      remembered.segment.id = next_id_++;
      remembered.segment.label = wall.label;
      remembered.segment.first_seen_us = stamp_us;
    }
    remembered.low = std::min(remembered.low, low);
    remembered.high = std::max(remembered.high, high);
    const auto end = [&](double fraction) {
      const Eigen::Vector2d p_world = plan.a + fraction * (plan.b - plan.a);
      const double sigma = params_.end_noise_m * (p_world - T_world_robot_.position()).norm();
      Eigen::Vector2d p = transform(T_odom_world, p_world);
      p.x() += gaussian(engine_, sigma);
      p.y() += gaussian(engine_, sigma);
      return Eigen::Vector3d(p.x(), p.y(), 0.0);
    };
    remembered.segment.odom = {end(remembered.low), end(remembered.high)};
    remembered.segment.last_seen_us = stamp_us;
    remembered.segment.confirmed = stamp_us - remembered.segment.first_seen_us > kSecondUs;
    remembered.segment.life = 100.0;
    // One false segment now and then for every true one, within reach of the robot.
    if (is_new && uniform(engine_, 0.0, 1.0) < params_.false_share) {
      MemorySegment wrong = remembered.segment;
      wrong.id = next_id_++;
      const double bearing = uniform(engine_, -kPi, kPi);
      const double range = uniform(engine_, 0.5, 3.0);
      const double direction = uniform(engine_, -kPi, kPi);
      const double length = uniform(engine_, 0.3, 1.5);
      const Eigen::Vector2d a =
          transform(T_odom_robot_, Eigen::Vector2d(range * std::cos(bearing), range * std::sin(bearing)));
      wrong.odom.a = {a.x(), a.y(), 0.0};
      wrong.odom.b = {a.x() + length * std::cos(direction), a.y() + length * std::sin(direction), 0.0};
      wrong.confirmed = true;
      false_.push_back(wrong);
    }
  }
  constexpr StampUs kForgotten_us = 15 * kSecondUs;
  std::erase_if(memory_, [&](const auto& entry) {
    return entry.second.segment.last_seen_us + kForgotten_us < stamp_us;
  });
  std::erase_if(false_, [&](const MemorySegment& s) { return s.last_seen_us + kForgotten_us < stamp_us; });
}

MemoryUpdate CorridorWorld::next() {
  const double dt_s = 1.0 / params_.rate_hz;
  time_s_ += dt_s;
  drive(dt_s);
  look();
  auto snapshot = std::make_shared<MemorySnapshot>();
  snapshot->stamp_us = static_cast<StampUs>(std::llround(time_s_ * kSecondUs));
  snapshot->revision = ++revision_;
  snapshot->epoch = epoch_;
  snapshot->T_odom_robot = T_odom_robot_;
  for (const auto& [index, remembered] : memory_) snapshot->segments.push_back(remembered.segment);
  snapshot->segments.insert(snapshot->segments.end(), false_.begin(), false_.end());
  auto analysis = std::make_shared<ImageAnalysis>();
  analysis->stamp_us = snapshot->stamp_us;
  analysis->intrinsics = intrinsicsFromFieldOfView(320, 240, degToRad(60));
  analysis->T_odom_robot = T_odom_robot_;
  CameraMount mount;
  mount.T_robot_pantilt.translation().z() = 0.45;
  analysis->T_robot_camera = cameraPose(mount, pan_rad_, degToRad(-15));
  return {snapshot, analysis};
}

}  // namespace vismem::test
