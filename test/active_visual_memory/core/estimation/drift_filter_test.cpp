// Tests M6.
#include "active_visual_memory/core/estimation/drift_filter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace vismem {
namespace {

/// Residuals of a room's four walls, two metres around the robot, as a drifted robot sees them.
std::vector<DriftResidual> wallsSeen(const PlanarIncrement& drift, double sigma_m, std::mt19937_64& random) {
  std::normal_distribution<double> noise(0.0, sigma_m);
  std::vector<DriftResidual> residuals;
  for (int i = 0; i < 16; ++i) {
    const double along = -1.5 + 0.2 * i;
    for (const auto& [p, n] : {std::pair<Eigen::Vector2d, Eigen::Vector2d>{{2.0, along}, {1.0, 0.0}},
                               std::pair<Eigen::Vector2d, Eigen::Vector2d>{{along, -2.0}, {0.0, 1.0}}}) {
      const Eigen::Vector2d seen = drift.apply(p);
      residuals.push_back({seen, n, n.dot(seen - p) + noise(random), sigma_m * sigma_m});
    }
  }
  return residuals;
}

TEST(DriftFilter, ARobotThatStandsDoesNotDrift) {
  DriftFilter filter;
  std::mt19937_64 random(1);
  const PlanarIncrement drift{{0.0, 0.0}, {0.05, 0.02}, 0.03};
  EXPECT_FALSE(filter.update({0.0, 0.0}, wallsSeen(drift, 0.005, random), {}));
  filter.predict({}, {}, {});
  EXPECT_FALSE(filter.update({0.0, 0.0}, wallsSeen(drift, 0.005, random), {}));
}

TEST(DriftFilter, FindsTheDriftOfARobotThatMoved) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    std::mt19937_64 random(seed);
    DriftFilter filter;
    filter.predict({}, {1.5, 0.3, 1.6}, {});
    const PlanarIncrement drift{{0.3, -0.2}, {0.03, -0.02}, -0.025};
    const auto found = filter.update({0.3, -0.2}, wallsSeen(drift, 0.005, random), {});
    ASSERT_TRUE(found);
    EXPECT_NEAR((found->motion.shift - drift.shift).norm(), 0.0, 0.006) << "seed " << seed;
    EXPECT_NEAR(found->motion.turn_rad, drift.turn_rad, 0.003) << "seed " << seed;
    EXPECT_LT(filter.sigmaAt(2.0), 0.01);
  }
}

TEST(DriftFilter, IgnoresOutliersThatMovedByThemselves) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    std::mt19937_64 random(seed);
    DriftFilter filter;
    filter.predict({}, {0.5, 0.0, 0.3}, {});
    const PlanarIncrement drift{{0.0, 0.0}, {0.008, 0.004}, 0.004};
    auto residuals = wallsSeen(drift, 0.005, random);
    // A third of what is seen stands elsewhere now.
    for (std::size_t i = 0; i < residuals.size(); i += 3) residuals[i].residual_m += 0.12;
    const auto found = filter.update({0.0, 0.0}, residuals, {});
    ASSERT_TRUE(found);
    EXPECT_NEAR((found->motion.shift - drift.shift).norm(), 0.0, 0.012) << "seed " << seed;
    EXPECT_NEAR(found->motion.turn_rad, drift.turn_rad, 0.006) << "seed " << seed;
  }
}

TEST(DriftFilter, ItsPriorBoundsTheCorrection) {
  // One wall measures no shift along itself, and half a metre after a centimetre is far outside the prior.
  DriftFilter filter;
  filter.predict({}, {0.01, 0.0, 0.0}, {});
  std::vector<DriftResidual> residuals{{{2.0, 0.0}, {1.0, 0.0}, 0.5, 1e-4}};
  const auto found = filter.update({0.0, 0.0}, residuals, {});
  ASSERT_TRUE(found);
  EXPECT_LT(found->motion.shift.norm(), 0.001);
  EXPECT_EQ(found->motion.shift.y(), 0.0);
}

TEST(DriftFilter, EstimatesALastingHeadingRate) {
  // A robot turns on itself and its odometry counts 3 % too little: its memory turns away, each image by as
  // much.
  for (const double share : {0.03, -0.02, 0.0}) {
    std::mt19937_64 random(3);
    std::normal_distribution<double> noise(0.0, 0.002);
    DriftFilter filter;
    Pose2 robot;
    double behind = 0.0;
    for (int i = 0; i < 200; ++i) {
      const Pose2 next = robot * Pose2{0.0, 0.0, 0.04};
      const PlanarIncrement expected = filter.predict(robot, next, {});
      robot = next;
      behind += share * 0.04 - expected.turn_rad;
      const PlanarIncrement drift{{0.0, 0.0}, {0.0, 0.0}, behind + noise(random)};
      const auto found = filter.update({0.0, 0.0}, wallsSeen(drift, 0.02, random), {});
      ASSERT_TRUE(found);
      behind -= found->motion.turn_rad;
    }
    DriftFilter later = filter;
    EXPECT_NEAR(later.predict({}, {0.0, 0.0, 1.0}, {}).turn_rad, share, 0.006);
    EXPECT_LT(std::abs(behind), 0.01);
    filter.reset();
    EXPECT_NEAR(filter.predict({}, {0.0, 0.0, 0.04}, {}).turn_rad, share * 0.04, 2.5e-4) << "it is kept";
    EXPECT_NEAR(filter.predict({}, {0.0, 0.0, -0.04}, {}).turn_rad, -share * 0.04, 2.5e-4);
  }
}

}  // namespace
}  // namespace vismem
