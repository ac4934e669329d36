// Tests M6.
#include "active_visual_memory/core/estimation/map_filter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "common/geometry/angles.h"
#include "common/geometry/projection.h"
#include "common/kinematics/kinematics.h"

namespace vismem {
namespace {

CameraMount mount() {
  CameraMount m;
  m.T_robot_pantilt = poseFromXyzRpy(0, 0, 0.45, 0, 0, 0);
  return m;
}

TEST(MapFilter, HeadingNoiseGrowsByTurnNoise) {
  // Of a robot that drives a metre: a line ahead of it, seen before, is as far off as the heading.
  const auto after = [](double turn_noise) {
    MapFilter filter{TiltPrior{}};
    MapFilter::Params params;
    params.odometry.turn_noise = turn_noise;
    params.odometry.turn_per_rad = params.odometry.turn_per_m = params.odometry.shift_per_m = 0.0;
    params.odometry.travel_scale = 0.0;
    FloorSegment seen;
    seen.place({{2.0, 0.0}, {3.0, 0.0}});
    seen.a.P = seen.b.P = 1e-6 * Eigen::Matrix2d::Identity();
    filter.update({{0.0, 0.0}, {}, std::nullopt, {}}, params);
    filter.addLine(1, seen, {cameraPose(mount(), 0.0, -0.3), 0.0}, 1.0, 0.0);
    const double before = filter.placeVariance(1, Eigen::Vector2d::UnitY(), {2.0, 0.0});
    filter.predict({}, {1.0, 0.0, 0.0}, params);
    filter.update({{1.0, 0.0}, {}, std::nullopt, {}}, params);
    return filter.placeVariance(1, Eigen::Vector2d::UnitY(), {2.0, 0.0}) - before;
  };
  EXPECT_NEAR(after(0.05) - after(0.0), 0.05 * 0.05, 1e-9);
}

/// Residuals of a room's two walls, two metres from the robot, against a known map, after a drift of the
/// odometry.
std::vector<LineResidual> wallsSeen(const PlanarIncrement& drift, double sigma_m, std::mt19937_64& random) {
  std::normal_distribution<double> noise(0.0, sigma_m);
  std::vector<LineResidual> residuals;
  for (int i = 0; i < 16; ++i) {
    const double along = -1.5 + 0.2 * i;
    for (const auto& [p, n] : {std::pair<Eigen::Vector2d, Eigen::Vector2d>{{2.0, along}, {1.0, 0.0}},
                               std::pair<Eigen::Vector2d, Eigen::Vector2d>{{along, -2.0}, {0.0, 1.0}}}) {
      LineResidual& residual = residuals.emplace_back();
      residual.p = drift.apply(p);
      residual.direction = n;
      residual.residual_m = n.dot(residual.p - p) + noise(random);
      residual.variance_m2 = sigma_m * sigma_m;
    }
  }
  return residuals;
}

std::optional<Correction> updated(MapFilter& filter, const Eigen::Vector2d& robot,
                                  const std::vector<LineResidual>& residuals) {
  return filter.update({robot, residuals, std::nullopt, {}}, {});
}

TEST(MapFilter, ARobotThatStandsDoesNotDrift) {
  MapFilter filter{TiltPrior{}};
  std::mt19937_64 random(1);
  const PlanarIncrement drift{{0.0, 0.0}, {0.05, 0.02}, 0.03};
  for (int i = 0; i < 2; ++i) {
    const auto found = updated(filter, {0.0, 0.0}, wallsSeen(drift, 0.005, random));
    ASSERT_TRUE(found);
    EXPECT_LT(found->motion.shift().norm(), 1e-8);
    EXPECT_LT(std::abs(found->motion.turn_rad()), 1e-8);
    filter.predict({}, {}, {});
  }
}

TEST(MapFilter, FindsTheDriftOfARobotThatMoved) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    std::mt19937_64 random(seed);
    MapFilter filter{TiltPrior{}};
    filter.predict({}, {1.5, 0.3, 1.6}, {});
    const PlanarIncrement drift{{0.3, -0.2}, {0.03, -0.02}, -0.025};
    const auto found = updated(filter, {0.3, -0.2}, wallsSeen(drift, 0.005, random));
    ASSERT_TRUE(found);
    EXPECT_NEAR((found->motion.shift() - drift.shift()).norm(), 0.0, 0.006) << "seed " << seed;
    EXPECT_NEAR(found->motion.turn_rad(), drift.turn_rad(), 0.003) << "seed " << seed;
  }
}

TEST(MapFilter, IgnoresOutliersThatMovedByThemselves) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    std::mt19937_64 random(seed);
    MapFilter filter{TiltPrior{}};
    filter.predict({}, {0.5, 0.0, 0.3}, {});
    const PlanarIncrement drift{{0.0, 0.0}, {0.008, 0.004}, 0.004};
    auto residuals = wallsSeen(drift, 0.005, random);
    // A third of what is seen stands elsewhere now.
    for (std::size_t i = 0; i < residuals.size(); i += 3) residuals[i].residual_m += 0.12;
    const auto found = updated(filter, {0.0, 0.0}, residuals);
    ASSERT_TRUE(found);
    EXPECT_NEAR((found->motion.shift() - drift.shift()).norm(), 0.0, 0.012) << "seed " << seed;
    EXPECT_NEAR(found->motion.turn_rad(), drift.turn_rad(), 0.006) << "seed " << seed;
  }
}

TEST(MapFilter, ItsPriorBoundsTheCorrection) {
  // One wall measures no shift along itself, and half a metre after a centimetre is far outside the prior.
  MapFilter filter{TiltPrior{}};
  filter.predict({}, {0.01, 0.0, 0.0}, {});
  LineResidual wall;
  wall.p = {2.0, 0.0};
  wall.residual_m = 0.5;
  wall.variance_m2 = 1e-4;
  const auto found = updated(filter, {0.0, 0.0}, {wall});
  ASSERT_TRUE(found);
  EXPECT_LT(found->motion.shift().norm(), 0.001);
  EXPECT_EQ(found->motion.shift().y(), 0.0);
}

TEST(MapFilter, EstimatesALastingHeadingRate) {
  // A robot turns on itself and its odometry counts 3 % too little: its memory turns away, each image by as
  // much.
  for (const double share : {0.03, -0.02, 0.0}) {
    std::mt19937_64 random(3);
    std::normal_distribution<double> noise(0.0, 0.002);
    MapFilter filter{TiltPrior{}};
    Pose2 robot;
    double behind = 0.0;
    for (int i = 0; i < 200; ++i) {
      const Pose2 next = robot * Pose2{0.0, 0.0, 0.04};
      behind += share * 0.04 - filter.predict(robot, next, {}).turn_rad();
      robot = next;
      const PlanarIncrement drift{{0.0, 0.0}, {0.0, 0.0}, behind + noise(random)};
      const auto found = updated(filter, {0.0, 0.0}, wallsSeen(drift, 0.02, random));
      ASSERT_TRUE(found);
      behind -= found->motion.turn_rad();
    }
    MapFilter later = filter;
    EXPECT_NEAR(later.predict({}, {0.0, 0.0, 1.0}, {}).turn_rad(), share, 0.006);
    EXPECT_LT(std::abs(behind), 0.01);
    filter.reset();
    EXPECT_NEAR(filter.predict({}, {0.0, 0.0, 0.04}, {}).turn_rad(), share * 0.04, 2.5e-4) << "it is kept";
    EXPECT_NEAR(filter.predict({}, {0.0, 0.0, -0.04}, {}).turn_rad(), -share * 0.04, 2.5e-4);
  }
}

TEST(MapFilter, EstimatesTheScaleOfTheTravelledWay) {
  // Odometry counts 6 % too much: what rests comes nearer by less than it says, so the memory must move
  // ahead.
  for (const double share : {0.06, -0.04, 0.0}) {
    std::mt19937_64 random(4);
    MapFilter filter{TiltPrior{}};
    Pose2 robot;
    double behind = 0.0;
    for (int i = 0; i < 200; ++i) {
      const Pose2 next = robot * Pose2{0.02, 0.0, 0.0};
      behind += share * 0.02 - filter.predict(robot, next, {}).shift().x();
      robot = next;
      const auto found =
          updated(filter, robot.position(), wallsSeen({robot.position(), {behind, 0.0}, 0.0}, 0.02, random));
      ASSERT_TRUE(found);
      behind -= found->motion.shift().x();
    }
    EXPECT_LT(std::abs(behind), 0.01);
    const Pose2 ahead = robot * Pose2{1.0, 0.0, 0.0};
    MapFilter later = filter;
    EXPECT_NEAR(later.predict(robot, ahead, {}).shift().x(), share, 0.008);
    EXPECT_NEAR(later.predict(ahead, robot, {}).shift().x(), -share, 0.008) << "the way back shrinks as much";
    filter.reset();
    EXPECT_NEAR(filter.predict(robot, ahead, {}).shift().x(), share, 0.008) << "it is kept";
  }
}

TEST(MapFilter, AddsCopiesReplacesAndRemovesLines) {
  MapFilter filter{TiltPrior{}};
  const TiltView view(cameraPose(mount(), 0.0, -0.3), 0.0);
  FloorSegment seen;
  seen.place({{1.0, -0.5}, {1.0, 0.5}});
  seen.a.P = seen.b.P = 1e-4 * Eigen::Matrix2d::Identity();
  filter.update({{0.0, 0.0}, {}, std::nullopt, {}}, {});
  filter.addLine(7, seen, view, 1.0, 0.0);
  filter.copyLine(8, 7);
  EXPECT_TRUE(filter.contains(7) && filter.contains(8) && !filter.contains(9));
  const double known = filter.placeVariance(7, Eigen::Vector2d::UnitX(), {1.0, 0.0});
  EXPECT_GT(known, 0.0);
  EXPECT_DOUBLE_EQ(filter.placeVariance(8, Eigen::Vector2d::UnitX(), {1.0, 0.0}), known);
  filter.replaceLine(8, 9);
  filter.removeLine(7);
  EXPECT_TRUE(!filter.contains(7) && !filter.contains(8) && filter.contains(9));
  EXPECT_DOUBLE_EQ(filter.placeVariance(9, Eigen::Vector2d::UnitX(), {1.0, 0.0}), known);
  for (std::uint64_t id = 100; id < 100 + 2 * MapFilter::kMaxLines; ++id)
    filter.addLine(id, seen, view, 1.0, 0.0);
  EXPECT_TRUE(filter.contains(99 + 2 * MapFilter::kMaxLines)) << "the one unseen for longest gives way";
  filter.reset();
  EXPECT_FALSE(filter.contains(99 + 2 * MapFilter::kMaxLines));
}

/// A line that lies across the view.
FloorSegment across(double x, double slope) {
  FloorSegment seen;
  seen.place({{x, -0.5}, {x + slope, 0.5}});
  seen.a.P = seen.b.P = 1e-4 * x * Eigen::Matrix2d::Identity();
  return seen;
}

TEST(MapFilter, RemovingALineKeepsTheOthersBits) {
  MapFilter filter{TiltPrior{}};
  const TiltView view(cameraPose(mount(), 0.0, -0.3), 0.0);
  filter.update({{0.0, 0.0}, {}, std::nullopt, {}}, {});
  for (int id = 1; id <= 5; ++id) {
    filter.addLine(static_cast<std::uint64_t>(id), across(0.5 + 0.3 * id, 0.1 * id), view, 1.0, 0.0);
  }
  const auto variance = [&](std::uint64_t id) {
    return filter.placeVariance(id, Eigen::Vector2d{1.0, -0.2}.normalized(), {1.5, 0.4});
  };
  const double first = variance(1);
  const double fourth = variance(4);
  const double last = variance(5);
  EXPECT_NE(first, fourth);
  filter.removeLine(2);
  filter.retainIf([](std::uint64_t id) { return id != 3; });
  EXPECT_EQ(variance(1), first);
  EXPECT_EQ(variance(4), fourth);
  EXPECT_EQ(variance(5), last);
  filter.removeLine(5);
  EXPECT_EQ(variance(4), fourth);
  EXPECT_EQ(variance(5), 0.0) << "it is unknown";
}

TEST(MapFilter, PreviewReturnsWhatUpdateWillAndChangesNothing) {
  MapFilter filter{TiltPrior{}};
  const TiltView view(cameraPose(mount(), 0.0, -0.3), 0.0);
  const MapFilter::Params params;
  filter.update({{0.0, 0.0}, {}, std::nullopt, {}}, params);
  filter.addLine(1, across(1.0, 0.0), view, 1.0, 0.0);
  filter.addLine(2, across(2.0, 0.1), view, 1.0, 0.0);
  filter.predict({}, {0.1, 0.0, 0.2}, params);
  const Eigen::Vector2d robot{0.1, 0.0};
  std::vector<LineResidual> residuals(2);
  residuals[0].line = 1;
  residuals[1].line = 2;
  for (LineResidual& residual : residuals) {
    residual.p = {1.0, 0.3};
    residual.residual_m = 0.01;
    residual.variance_m2 = 1e-4;
    residual.d_tilt = {0.1, 1.0, 0.2, 0.9};
    residual.d_frame_tilt = {0.1, 1.0};
  }
  const std::vector<LineDirection> directions{{1, 1.55}};
  const double before = filter.placeVariance(1, Eigen::Vector2d::UnitX(), {1.0, 0.3});
  const auto previewed = filter.preview({robot, residuals, 0.01, directions}, params);
  ASSERT_TRUE(previewed);
  EXPECT_GT(previewed->motion.shift().norm(), 1e-4);
  EXPECT_EQ(filter.placeVariance(1, Eigen::Vector2d::UnitX(), {1.0, 0.3}), before);
  EXPECT_FALSE(filter.dominantDirection());
  EXPECT_EQ(filter.cameraTilt(), CameraTilt::Zero());
  const auto updated = filter.update({robot, residuals, 0.01, directions}, params);
  ASSERT_TRUE(updated);
  EXPECT_EQ(previewed->motion.shift(), updated->motion.shift());
  EXPECT_EQ(previewed->motion.turn_rad(), updated->motion.turn_rad());
  EXPECT_EQ(previewed->camera_tilt, updated->camera_tilt);
  EXPECT_EQ(previewed->frame_tilt, updated->frame_tilt);
  EXPECT_EQ(previewed->P_frame_tilt, updated->P_frame_tilt);
  EXPECT_LT(filter.placeVariance(1, Eigen::Vector2d::UnitX(), {1.0, 0.3}), before);
  EXPECT_TRUE(filter.dominantDirection());
}

}  // namespace
}  // namespace vismem
