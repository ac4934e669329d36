#include "active_visual_memory/core/joint_alignment.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "active_visual_memory/core/attentive_visual_memory.h"
#include "active_visual_memory/core/drift_residuals.h"
#include "active_visual_memory/core/slip_detector.h"
#include "common/geometry/angles.h"
#include "common/geometry/projection.h"
#include "common/kinematics/kinematics.h"

namespace vismem {
namespace {

constexpr StampUs kImage_us = 100'000;

CameraMount mount() {
  CameraMount m;
  m.T_robot_pantilt = poseFromXyzRpy(0, 0, 0.45, 0, 0, 0);
  return m;
}

AttentiveVisualMemoryParams swaying() {
  AttentiveVisualMemoryParams p = AttentiveVisualMemoryParams::standard();
  p.gaze.mount = mount();
  p.gaze.initial_mode = GazeMode::kOff;
  p.projector.pitch_sigma_rad = degToRad(1.0);
  p.memory.joint = true;
  p.memory.compass = true;
  p.memory.lean.sway_rad = degToRad(1.0);
  p.memory.alignment.turn_per_rad = 0.05;
  p.memory.alignment.turn_per_m = degToRad(3.5);
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

/// A walk through the room: a turn, a metre ahead and another turn, while the head looks about. The body
/// sways in each image, the camera leans, and its odometry turns beside by `slip_rad` at the end of the first
/// turn.
class Walk {
 public:
  Walk(AttentiveVisualMemory& memory, std::uint64_t seed, const Lean& lean, double slip_rad,
       double last_slip_rad = 0.0)
      : memory_(memory), random_(seed), lean_(lean) {
    turn();
    odometry_.theta += slip_rad;
    for (int i = 0; i < 40; ++i) step({0.025, 0.0, 0.0});
    turn();
    odometry_.theta += last_slip_rad;
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
    std::normal_distribution<double> sway(0.0, degToRad(0.8));
    std::normal_distribution<double> px_noise(0.0, 0.3);
    const Lean now = lean_ + Lean(sway(random_), sway(random_), 0.0, 0.0);
    const Pose3 T_room_camera = toPose3(truth_) * leaned(o.T_robot_camera, now);
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
    memory_.step(o, seen);
  }

  AttentiveVisualMemory& memory_;
  std::mt19937_64 random_;
  Lean lean_;
  Pose2 truth_;
  Pose2 odometry_;
  int images_ = 0;
};

TEST(JointAlignment, FindsTheLeanOfABodyThatSwaysAndKnowsHowWell) {
  const Lean lean{0.0, 0.0, degToRad(-0.5), degToRad(0.3)};
  constexpr int kWalks = 12;
  Lean sum = Lean::Zero();
  double normalised = 0.0;
  for (int seed = 1; seed <= kWalks; ++seed) {
    AttentiveVisualMemory memory(swaying());
    const Walk walk(memory, static_cast<std::uint64_t>(seed), lean, 0.0);
    const Lean off = memory.lean() - lean;
    sum += off;
    normalised += off.dot(memory.leanCovariance().inverse() * off) / 4.0;
    EXPECT_LT(std::abs(radToDeg(off[2])), 0.25) << seed;
  }
  // Its mean is right: half of it would be found if the memory confirmed the lean that it was made with.
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
    sum += line.length() * std::abs(offCourse(line.direction(), 0.0));
    length += line.length();
  }
  return radToDeg(sum / length);
}

TEST(JointAlignment, FollowsASlipOfTheFeet) {
  constexpr int kWalks = 6;
  const auto meanAfter = [](double slip_rad, const AttentiveVisualMemoryParams& params) {
    double mean = 0.0;
    for (int seed = 1; seed <= kWalks; ++seed) {
      AttentiveVisualMemory memory(params);
      mean += turned(Walk(memory, static_cast<std::uint64_t>(seed), Lean::Zero(), slip_rad)) / kWalks;
    }
    return mean;
  };
  for (const double slip : {0.0, degToRad(6.0), degToRad(-6.0)}) {
    EXPECT_LT(meanAfter(slip, swaying()), 1.0) << radToDeg(slip);
  }
}

TEST(JointAlignment, TurnsByASlipAtOnceWhenTheWalkIsOver) {
  // What is seen of it afterwards is too little for the filter alone.
  AttentiveVisualMemoryParams deaf = swaying();
  deaf.memory.slip.sigmas = 1e9;
  constexpr int kWalks = 6;
  double with = 0.0;
  double without = 0.0;
  for (int seed = 1; seed <= kWalks; ++seed) {
    AttentiveVisualMemory hears(swaying());
    with += turned(Walk(hears, static_cast<std::uint64_t>(seed), Lean::Zero(), 0.0, degToRad(6.0))) / kWalks;
    AttentiveVisualMemory is_deaf(deaf);
    without +=
        turned(Walk(is_deaf, static_cast<std::uint64_t>(seed), Lean::Zero(), 0.0, degToRad(6.0))) / kWalks;
  }
  EXPECT_LT(with, 0.75 * without) << with << " " << without;
}

TEST(JointAlignment, ExpectsTheHeadingToErrAsItIsTold) {
  // Of a robot that drives a metre: a line ahead of it, seen before, is as far off as the heading.
  const auto after = [](double turn_noise) {
    JointAlignment joint{LeanParams{}};
    JointAlignment::Params params;
    params.turn_noise = turn_noise;
    params.drift.turn_per_rad = params.drift.turn_per_m = params.drift.shift_per_m = 0.0;
    FloorSegment seen;
    seen.odom = {{2.0, 0.0}, {3.0, 0.0}};
    seen.P_a = seen.P_b = 1e-6 * Eigen::Matrix2d::Identity();
    joint.solve({0.0, 0.0}, {}, std::nullopt, {}, params);
    joint.begin(1, seen, {cameraPose(mount(), 0.0, -0.3), 0.0}, 1.0, 0.0);
    const double before = joint.placeVariance(1, Eigen::Vector2d::UnitY(), {2.0, 0.0});
    joint.travel({}, {1.0, 0.0, 0.0}, params);
    joint.solve({1.0, 0.0}, {}, std::nullopt, {}, params);
    return joint.placeVariance(1, Eigen::Vector2d::UnitY(), {2.0, 0.0}) - before;
  };
  EXPECT_NEAR(after(0.05) - after(0.0), 0.05 * 0.05, 1e-9);
}

TEST(JointAlignment, KnowsLinesByTheirNames) {
  JointAlignment joint{LeanParams{}};
  const LeaningView view(cameraPose(mount(), 0.0, -0.3), 0.0);
  FloorSegment seen;
  seen.odom = {{1.0, -0.5}, {1.0, 0.5}};
  seen.P_a = seen.P_b = 1e-4 * Eigen::Matrix2d::Identity();
  joint.solve({0.0, 0.0}, {}, std::nullopt, {}, {});
  joint.begin(7, seen, view, 1.0, 0.0);
  joint.beginAs(8, 7);
  EXPECT_TRUE(joint.knows(7) && joint.knows(8) && !joint.knows(9));
  const double known = joint.placeVariance(7, Eigen::Vector2d::UnitX(), {1.0, 0.0});
  EXPECT_GT(known, 0.0);
  EXPECT_DOUBLE_EQ(joint.placeVariance(8, Eigen::Vector2d::UnitX(), {1.0, 0.0}), known);
  joint.rename(8, 9);
  joint.forget(7);
  EXPECT_TRUE(!joint.knows(7) && !joint.knows(8) && joint.knows(9));
  EXPECT_DOUBLE_EQ(joint.placeVariance(9, Eigen::Vector2d::UnitX(), {1.0, 0.0}), known);
  for (std::uint64_t id = 100; id < 100 + 2 * JointAlignment::kMostLines; ++id)
    joint.begin(id, seen, view, 1.0, 0.0);
  EXPECT_TRUE(joint.knows(99 + 2 * JointAlignment::kMostLines)) << "the one unseen for longest gives way";
  joint.reset();
  EXPECT_FALSE(joint.knows(99 + 2 * JointAlignment::kMostLines));
}

/// A line that lies across the view.
FloorSegment across(double x, double slope) {
  FloorSegment seen;
  seen.odom = {{x, -0.5}, {x + slope, 0.5}};
  seen.P_a = seen.P_b = 1e-4 * x * Eigen::Matrix2d::Identity();
  return seen;
}

TEST(JointAlignment, ForgetsALineAndNothingOfTheOthers) {
  JointAlignment joint{LeanParams{}};
  const LeaningView view(cameraPose(mount(), 0.0, -0.3), 0.0);
  joint.solve({0.0, 0.0}, {}, std::nullopt, {}, {});
  for (int id = 1; id <= 5; ++id) {
    joint.begin(static_cast<std::uint64_t>(id), across(0.5 + 0.3 * id, 0.1 * id), view, 1.0, 0.0);
  }
  const auto variance = [&](std::uint64_t id) {
    return joint.placeVariance(id, Eigen::Vector2d{1.0, -0.2}.normalized(), {1.5, 0.4});
  };
  const double first = variance(1);
  const double fourth = variance(4);
  const double last = variance(5);
  EXPECT_NE(first, fourth);
  joint.forget(2);
  joint.keepIf([](std::uint64_t id) { return id != 3; });
  EXPECT_EQ(variance(1), first);
  EXPECT_EQ(variance(4), fourth);
  EXPECT_EQ(variance(5), last);
  joint.forget(5);
  EXPECT_EQ(variance(4), fourth);
  EXPECT_EQ(variance(5), 0.0) << "it is unknown";
}

TEST(JointAlignment, LooksWithoutLearning) {
  JointAlignment joint{LeanParams{}};
  const LeaningView view(cameraPose(mount(), 0.0, -0.3), 0.0);
  const JointAlignment::Params params;
  joint.solve({0.0, 0.0}, {}, std::nullopt, {}, params);
  joint.begin(1, across(1.0, 0.0), view, 1.0, 0.0);
  joint.begin(2, across(2.0, 0.1), view, 1.0, 0.0);
  joint.travel({}, {0.1, 0.0, 0.2}, params);
  const Eigen::Vector2d robot{0.1, 0.0};
  std::vector<JointResidual> residuals(2);
  residuals[0].line = 1;
  residuals[1].line = 2;
  for (JointResidual& residual : residuals) {
    residual.common.p = {1.0, 0.3};
    residual.common.residual_m = 0.01;
    residual.common.variance_m2 = 1e-4;
    residual.common.d_lean = {0.1, 1.0, 0.2, 0.9};
    residual.common.d_sway = {0.1, 1.0};
  }
  const std::vector<LineDirection> directions{{1, 1.55}};
  const double before = joint.placeVariance(1, Eigen::Vector2d::UnitX(), {1.0, 0.3});
  const auto looked = joint.look(robot, residuals, 0.01, directions, params);
  ASSERT_TRUE(looked);
  EXPECT_GT(looked->motion.shift.norm(), 1e-4);
  EXPECT_EQ(joint.placeVariance(1, Eigen::Vector2d::UnitX(), {1.0, 0.3}), before);
  EXPECT_FALSE(joint.course());
  EXPECT_EQ(joint.lean(), Lean::Zero());
  const auto solved = joint.solve(robot, residuals, 0.01, directions, params);
  ASSERT_TRUE(solved);
  EXPECT_EQ(looked->motion.shift, solved->motion.shift);
  EXPECT_EQ(looked->motion.turn_rad, solved->motion.turn_rad);
  EXPECT_EQ(looked->lean, solved->lean);
  EXPECT_EQ(looked->sway, solved->sway);
  EXPECT_EQ(looked->P_sway, solved->P_sway);
  EXPECT_LT(joint.placeVariance(1, Eigen::Vector2d::UnitX(), {1.0, 0.3}), before);
  EXPECT_TRUE(joint.course());
}

TEST(SlipDetector, BelievesSeveralImagesAndNoSingleOne) {
  const SlipDetector::Params params;
  const double sigma = degToRad(2.5);
  std::mt19937_64 random(3);
  std::normal_distribution<double> noise(0.0, sigma);
  SlipDetector detector;
  for (int i = 0; i < 400; ++i) {
    EXPECT_FALSE(detector.add(i * kImage_us, noise(random), sigma * sigma, params)) << i;
  }
  const double slip = degToRad(6.0);
  for (int i = 400;; ++i) {
    ASSERT_LT(i, 412) << "a slip of 6 degrees is found within 12 images";
    const auto found = detector.add(i * kImage_us, slip + noise(random), sigma * sigma, params);
    if (!found) continue;
    EXPECT_GE(i, 402);
    EXPECT_NEAR(found->turn_rad, slip, 3.0 * found->sigma_rad);
    EXPECT_NEAR(static_cast<double>(found->since_us), 400.0 * kImage_us, 3.0 * kImage_us);
    break;
  }
}

}  // namespace
}  // namespace vismem
