#include "active_visual_memory/core/drift_alignment.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "active_visual_memory/core/thin_lines.h"

namespace vismem {
namespace {

/// Residuals of a room's four walls, two metres around the robot, as a drifted robot sees them.
std::vector<DriftResidual> wallsSeen(const SmallMotion& drift, double sigma_m, std::mt19937_64& random) {
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

TEST(DriftAlignment, ARobotThatStandsDoesNotDrift) {
  DriftAlignment alignment;
  std::mt19937_64 random(1);
  const SmallMotion drift{{0.0, 0.0}, {0.05, 0.02}, 0.03};
  EXPECT_FALSE(alignment.solve({0.0, 0.0}, wallsSeen(drift, 0.005, random), {}));
  alignment.travel({}, {}, {});
  EXPECT_FALSE(alignment.solve({0.0, 0.0}, wallsSeen(drift, 0.005, random), {}));
}

TEST(DriftAlignment, FindsTheDriftOfARobotThatMoved) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    std::mt19937_64 random(seed);
    DriftAlignment alignment;
    alignment.travel({}, {1.5, 0.3, 1.6}, {});
    const SmallMotion drift{{0.3, -0.2}, {0.03, -0.02}, -0.025};
    const auto found = alignment.solve({0.3, -0.2}, wallsSeen(drift, 0.005, random), {});
    ASSERT_TRUE(found);
    EXPECT_NEAR((found->motion.shift - drift.shift).norm(), 0.0, 0.006) << "seed " << seed;
    EXPECT_NEAR(found->motion.turn_rad, drift.turn_rad, 0.003) << "seed " << seed;
    EXPECT_LT(alignment.sigmaAt(2.0), 0.01);
  }
}

TEST(DriftAlignment, IsNotLedAstrayByWhatMovedByItself) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    std::mt19937_64 random(seed);
    DriftAlignment alignment;
    alignment.travel({}, {0.5, 0.0, 0.3}, {});
    const SmallMotion drift{{0.0, 0.0}, {0.008, 0.004}, 0.004};
    auto residuals = wallsSeen(drift, 0.005, random);
    // A third of what is seen stands elsewhere now.
    for (std::size_t i = 0; i < residuals.size(); i += 3) residuals[i].residual_m += 0.12;
    const auto found = alignment.solve({0.0, 0.0}, residuals, {});
    ASSERT_TRUE(found);
    EXPECT_NEAR((found->motion.shift - drift.shift).norm(), 0.0, 0.012) << "seed " << seed;
    EXPECT_NEAR(found->motion.turn_rad, drift.turn_rad, 0.006) << "seed " << seed;
  }
}

TEST(DriftAlignment, BelievesNoMoreThanOdometryMayHaveDrifted) {
  // One wall tells nothing along itself, and a drift of half a metre after a centimetre is none.
  DriftAlignment alignment;
  alignment.travel({}, {0.01, 0.0, 0.0}, {});
  std::vector<DriftResidual> residuals{{{2.0, 0.0}, {1.0, 0.0}, 0.5, 1e-4}};
  const auto found = alignment.solve({0.0, 0.0}, residuals, {});
  ASSERT_TRUE(found);
  EXPECT_LT(found->motion.shift.norm(), 0.001);
  EXPECT_EQ(found->motion.shift.y(), 0.0);
}

TEST(DriftAlignment, LearnsADriftOfTheHeadingThatGoesOn) {
  // A robot turns on itself and its odometry counts 3 % too little: its memory turns away, each image by as
  // much.
  for (const double share : {0.03, -0.02, 0.0}) {
    std::mt19937_64 random(3);
    std::normal_distribution<double> noise(0.0, 0.002);
    DriftAlignment alignment;
    Pose2 robot;
    double behind = 0.0;
    for (int i = 0; i < 200; ++i) {
      const Pose2 next = robot * Pose2{0.0, 0.0, 0.04};
      const SmallMotion expected = alignment.travel(robot, next, {});
      robot = next;
      behind += share * 0.04 - expected.turn_rad;
      const SmallMotion drift{{0.0, 0.0}, {0.0, 0.0}, behind + noise(random)};
      const auto found = alignment.solve({0.0, 0.0}, wallsSeen(drift, 0.02, random), {});
      ASSERT_TRUE(found);
      behind -= found->motion.turn_rad;
    }
    EXPECT_NEAR(alignment.headingRates().x(), share, 0.006);
    EXPECT_LT(std::abs(behind), 0.01);
    alignment.reset();
    EXPECT_NEAR(alignment.travel({}, {0.0, 0.0, 0.04}, {}).turn_rad, share * 0.04, 2.5e-4) << "it is kept";
    EXPECT_NEAR(alignment.travel({}, {0.0, 0.0, -0.04}, {}).turn_rad, -share * 0.04, 2.5e-4);
  }
}

TEST(ThinLines, TheFormulaIsThatOfABlurredBar) {
  // The steepest places of a bar of half width h blurred by a Gaussian: where its slope's own slope is 0.
  const double sigma = 1.2;
  for (const double h : {0.3, 0.7, 1.2, 2.0, 4.0}) {
    const auto slope = [&](double x) {
      const auto g = [&](double d) { return std::exp(-0.5 * d * d / (sigma * sigma)); };
      return g(x + h) - g(x - h);
    };
    double steepest = 0.0;
    double least = 0.0;
    for (double x = 0.0; x < 8.0; x += 1e-4) {
      if (slope(x) < least) least = slope(x), steepest = x;
    }
    EXPECT_NEAR(halfWidthOfLine(steepest, sigma), h, 0.02 + 0.1 * std::max(0.0, 1.0 - h)) << "h " << h;
  }
  EXPECT_EQ(halfWidthOfLine(1.7, 0.0), 1.7);
  EXPECT_LT(halfWidthOfLine(1.0, 1.2), 0.1) << "nearer than the blur allows: a line without width";
}

TEST(ThinLines, BothEdgesOfALineMoveInwardsAndNothingElseDoes) {
  const auto edge = [](double x1, double y1, double x2, double y2) {
    ImageSegment s;
    s.px = {{x1, y1}, {x2, y2}};
    s.strength = 50.0;
    return s;
  };
  const std::vector<ImageSegment> seen{
      edge(10, 100, 200, 100),      // upper edge of a thin line
      edge(190, 102.6, 20, 102.6),  // its lower edge, the other way round
      edge(10, 150, 200, 150),      // alone
      edge(10, 153, 200, 153),      // beside it, of the same polarity
      edge(10, 200, 200, 200),      // a line of 12 pixels
      edge(200, 212, 10, 212),
  };
  const auto corrected = correctThinLines(seen, {});
  ASSERT_EQ(corrected.size(), seen.size());
  EXPECT_GT(corrected[0].px.a.y(), 100.2);
  EXPECT_LT(corrected[1].px.a.y(), 102.4);
  EXPECT_NEAR(corrected[0].px.a.y() - 100.0, 102.6 - corrected[1].px.a.y(), 1e-9);
  EXPECT_LT(corrected[0].px.a.y(), corrected[1].px.a.y());
  for (std::size_t i = 2; i < seen.size(); ++i) {
    EXPECT_EQ(corrected[i].px.a, seen[i].px.a) << i;
    EXPECT_EQ(corrected[i].px.b, seen[i].px.b) << i;
  }
  ThinLineParams off;
  off.sigma_px = 0.0;
  EXPECT_EQ(correctThinLines(seen, off)[0].px.a, seen[0].px.a);
}

}  // namespace
}  // namespace vismem
