// Tests M6: legged robots, walks through a room.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "active_visual_memory/core/attentive_visual_memory.h"
#include "common/geometry/angles.h"
#include "common/geometry/projection.h"

namespace vismem {
namespace {

constexpr StampUs kImage_us = 100'000;

CameraMount mount() {
  CameraMount m;
  m.T_robot_pantilt = poseFromXyzRpy(0, 0, 0.45, 0, 0, 0);
  return m;
}

AttentiveVisualMemoryParams legged() {
  AttentiveVisualMemoryParams p = AttentiveVisualMemoryParams::standard();
  p.rig.mount = mount();
  p.gaze.initial_mode = GazeMode::kOff;
  p.projector.pitch_sigma_rad = degToRad(1.0);
  p.memory.estimation.use_dominant_direction = true;
  p.memory.estimation.tilt_prior.per_frame_rad = degToRad(1.0);
  p.memory.estimation.map_filter.odometry.turn_per_rad = 0.05;
  p.memory.estimation.map_filter.odometry.turn_per_m = degToRad(3.5);
  p.memory.estimation.map_filter.odometry.turn_noise = degToRad(2.9);
  return p;
}

/// The feet of the walls of a room, a door in each.
std::vector<Segment3> room() {
  std::vector<Segment3> walls;
  const auto wall = [&](double x1, double y1, double x2, double y2) {
    const Eigen::Vector3d a{x1, y1, 0.0};
    const Eigen::Vector3d b{x2, y2, 0.0};
    walls.push_back({a, a + 0.4 * (b - a)});
    walls.push_back({a + 0.6 * (b - a), b});
  };
  wall(-2.0, -1.5, 3.0, -1.5);
  wall(3.0, -1.5, 3.0, 1.5);
  wall(3.0, 1.5, -2.0, 1.5);
  wall(-2.0, 1.5, -2.0, -1.5);
  return walls;
}

/// A walk through the room: a turn, a metre ahead and another turn, while the head looks around. Each image
/// has a frame tilt, the camera is tilted, and the odometry slips by `slip_rad` at the end of the first turn.
class Walk {
 public:
  Walk(AttentiveVisualMemory& memory, std::uint64_t seed, const CameraTilt& camera_tilt, double slip_rad)
      : memory_(memory), random_(seed), camera_tilt_(camera_tilt) {
    turn();
    odometry_.theta += slip_rad;
    for (int i = 0; i < 40; ++i) step({0.025, 0.0, 0.0});
    turn();
    for (int i = 0; i < 8; ++i) step({0.025, 0.0, 0.0});
  }
  /// The segments of the memory where they are in the room.
  std::vector<Segment2> remembered() const {
    std::vector<Segment2> lines;
    const Pose2 T_room_odom = truth_ * inverse(odometry_);
    for (const MemoryElement& e : memory_.elements()) {
      const Segment2 line = e.line.segment();
      lines.push_back({transform(T_room_odom, line.a), transform(T_room_odom, line.b)});
    }
    return lines;
  }

 private:
  void turn() {
    for (int i = 0; i < 160; ++i) step({0.0, 0.0, 2.0 * std::numbers::pi / 160.0});
  }
  void step(const Pose2& motion) {
    truth_ = truth_ * motion;
    odometry_ = odometry_ * motion;
    const double phase = 0.11 * ++images_;
    const double pan = 0.8 * std::sin(phase);
    const double tilt = -0.35 + 0.15 * std::sin(0.7 * phase);
    RobotObservation o;
    o.frame.stamp_us = images_ * kImage_us;
    o.frame.seq = images_;
    o.frame.intrinsics = intrinsicsFromFieldOfView(320, 240, degToRad(60.0));
    o.T_odom_robot = odometry_;
    o.pan_tilt = PanTilt{pan, tilt};
    o.T_robot_camera = cameraPose(mount(), pan, tilt);
    std::normal_distribution<double> frame_tilt(0.0, degToRad(0.8));
    std::normal_distribution<double> px_noise(0.0, 0.3);
    const CameraTilt now = camera_tilt_ + CameraTilt(frame_tilt(random_), frame_tilt(random_), 0.0, 0.0);
    const Pose3 T_room_camera = toPose3(truth_) * tilted(o.T_robot_camera, now);
    std::vector<ImageSegment> seen;
    for (const Segment3& wall : room()) {
      auto px = projectSegment(o.frame.intrinsics, T_room_camera, wall);
      if (!px || px->length() < 15.0) continue;
      const Eigen::Vector2d along = (px->b - px->a).normalized();
      const Eigen::Vector2d across{-along.y(), along.x()};
      px->a += px_noise(random_) * across;
      px->b += px_noise(random_) * across;
      seen.push_back({*px, "edge", 40.0});
    }
    memory_.update(o, seen);
  }

  AttentiveVisualMemory& memory_;
  std::mt19937_64 random_;
  CameraTilt camera_tilt_;
  Pose2 truth_;
  Pose2 odometry_;
  int images_ = 0;
};

TEST(SegmentMemoryFilter, EstimatesTheCameraTiltOfALeggedRobotConsistently) {
  const CameraTilt camera_tilt{0.0, 0.0, degToRad(-0.5), degToRad(0.3)};
  constexpr int kWalks = 12;
  CameraTilt sum = CameraTilt::Zero();
  double normalised = 0.0;
  for (int seed = 1; seed <= kWalks; ++seed) {
    AttentiveVisualMemory memory(legged());
    const Walk walk(memory, static_cast<std::uint64_t>(seed), camera_tilt, 0.0);
    const CameraTilt off = memory.cameraTilt() - camera_tilt;
    sum += off;
    normalised += off.dot(memory.cameraTiltCovariance().inverse() * off) / 4.0;
    EXPECT_LT(std::abs(radToDeg(off[2])), 0.25) << seed;
  }
  // Its mean is right: half of it would be found if the memory confirmed the camera tilt that it was made
  // with.
  EXPECT_LT(radToDeg((sum / kWalks).cwiseAbs().maxCoeff()), 0.1)
      << radToDeg(1.0) * (sum / kWalks).transpose();
  EXPECT_LT(normalised / kWalks, 2.5);
  EXPECT_GT(normalised / kWalks, 0.1);
}

/// How far the long lines of the memory are turned against the walls, on average by length [degrees].
double turned(const Walk& walk) {
  double sum = 0.0;
  double length = 0.0;
  for (const Segment2& line : walk.remembered()) {
    if (line.length() < 0.8) continue;
    sum += line.length() * std::abs(offDominantDirection(line.direction(), 0.0));
    length += line.length();
  }
  return radToDeg(sum / length);
}

TEST(SegmentMemoryFilter, FollowsASlipOfTheFeet) {
  constexpr int kWalks = 6;
  const auto meanAfter = [](double slip_rad, const AttentiveVisualMemoryParams& params) {
    double mean = 0.0;
    for (int seed = 1; seed <= kWalks; ++seed) {
      AttentiveVisualMemory memory(params);
      mean += turned(Walk(memory, static_cast<std::uint64_t>(seed), CameraTilt::Zero(), slip_rad)) / kWalks;
    }
    return mean;
  };
  for (const double slip : {0.0, degToRad(6.0), degToRad(-6.0)}) {
    EXPECT_LT(meanAfter(slip, legged()), 1.0) << radToDeg(slip);
  }
}

TEST(SegmentMemoryFilter, AnEdgeThatDrivesAheadDoesNotDragTheMemory) {
  AttentiveVisualMemoryParams params = AttentiveVisualMemoryParams::standard();
  params.rig.mount = mount();
  params.gaze.initial_mode = GazeMode::kOff;
  AttentiveVisualMemory memory(params);
  RobotObservation o;
  o.frame.intrinsics = intrinsicsFromFieldOfView(320, 240, degToRad(60.0));
  o.T_robot_camera = cameraPose(mount(), 0.0, -0.35);
  const auto see = [&](double x_m, const std::vector<Segment3>& edges) {
    ++o.frame.seq;
    o.frame.stamp_us += kImage_us / 3;
    o.T_odom_robot = {x_m, 0.0, 0.0};
    std::vector<ImageSegment> seen;
    for (const Segment3& edge : edges) {
      const auto px = projectSegment(o.frame.intrinsics, toPose3(o.T_odom_robot) * o.T_robot_camera, edge);
      if (px && px->length() > 15.0) seen.push_back({*px, "edge", 40.0});
    }
    memory.update(o, seen);
  };
  // A wall ahead, and the way to it.
  double x = 0.0;
  for (; x < 0.8; x += 0.005) see(x, {{{2.0, -0.5, 0.0}, {2.2, 0.5, 0.0}}});
  ASSERT_EQ(memory.elements().size(), 1u);
  ASSERT_TRUE(memory.elements()[0].plane.on_floor);
  // Another robot hides it and keeps its distance.
  const double begin = x;
  for (; x < begin + 1.0; x += 0.005) {
    see(x, {{{x + 0.7, -0.3, 0.0}, {x + 0.7, 0.3, 0.0}}, {{x + 0.7, 0.3, 0.0}, {x + 0.85, 0.5, 0.0}}});
  }
  EXPECT_NEAR(memory.elements()[0].line.segment().middle().x(), 2.1, 0.02);
}

}  // namespace
}  // namespace vismem
