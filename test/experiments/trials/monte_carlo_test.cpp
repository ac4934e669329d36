// Monte Carlo localization, the peer of E5 and E6.
#include "experiments/trials/monte_carlo.h"

#include <gmock/gmock.h>

#include <cmath>

#include "common/geometry/angles.h"
#include "localization/corridor_world.h"

namespace vismem {
namespace {

using test::CorridorParams;
using test::CorridorWorld;

/// The tuned filter, small enough for tests of every day.
MonteCarloParams smallMonteCarlo() {
  MonteCarloParams params = tunedMonteCarlo();
  params.least_particles = 500;
  params.most_particles = 3000;
  params.points = 20;
  return params;
}

double errorOf(const PoseEstimate& estimate, const Pose2& truth) {
  return estimate.T_world_robot ? (estimate.T_world_robot->position() - truth.position()).norm() : 1e9;
}

TEST(KldSampling, GivesFoxsBound) {
  // k = 2, error 0.05, 99 %: a = 2/9, (1 - 0.22222 + 0.47140 x 2.326)^3 = 1.87427^3 = 6.5841, times 10.
  EXPECT_NEAR(kldParticleCount(2, 0.05, 2.326), 65.84, 0.05);
  // The bound is half of the chi-square quantile with k - 1 degrees of freedom over the error:
  // chi-square(0.99, 99) = 134.642.
  EXPECT_NEAR(kldParticleCount(100, 0.05, 2.326), 134.642 / 0.1, 1.5);
  EXPECT_DOUBLE_EQ(kldParticleCount(1, 0.05, 2.326), 1.0);
}

TEST(KldSampling, NeedsMoreForMoreBinsAndLessForMoreError) {
  EXPECT_GT(kldParticleCount(200, 0.05, 2.326), kldParticleCount(100, 0.05, 2.326));
  EXPECT_LT(kldParticleCount(100, 0.10, 2.326), kldParticleCount(100, 0.05, 2.326));
}

TEST(MonteCarlo, FollowsTheRobotFromAKnownStart) {
  for (const auto& params : {stockMonteCarlo(), smallMonteCarlo()}) {
    CorridorWorld world(CorridorParams{}, 3);
    MonteCarlo filter(params, test::corridorMap(), 1);
    filter.update(world.next());
    filter.setPose(world.truth());
    double sum = 0.0;
    constexpr int kImages = 150;
    for (int i = 0; i < kImages; ++i) sum += errorOf(filter.update(world.next()), world.truth());
    // The robot drives 4.5 m meanwhile; a filter that lost it is metres away.
    EXPECT_LT(sum / kImages, 0.3);
  }
}

TEST(MonteCarlo, FindsTheRobotFromAnywhere) {
  int found = 0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    CorridorWorld world(CorridorParams{}, seed);
    MonteCarlo filter(smallMonteCarlo(), test::corridorMap(), seed);
    bool there = false;
    for (int i = 0; i < 300 && !there; ++i) {
      const PoseEstimate estimate = filter.update(world.next());
      there = i > 100 && errorOf(estimate, world.truth()) < 0.2;
    }
    if (there) ++found;
  }
  EXPECT_GE(found, 3);
}

TEST(MonteCarlo, UsesFewerParticlesOnceItKnows) {
  CorridorWorld world(CorridorParams{}, 3);
  MonteCarloParams params = stockMonteCarlo();
  params.alpha_slow = params.alpha_fast = 0.0;  // every random particle would occupy a bin of its own
  MonteCarlo filter(params, test::corridorMap(), 1);
  EXPECT_EQ(filter.particleCount(), 2000u);
  filter.update(world.next());
  filter.setPose(world.truth());
  // Straight on: a turn spreads the particles, and rightly so.
  for (int i = 0; i < 40; ++i) filter.update(world.next());
  EXPECT_LT(filter.particleCount(), 1200u);
}

TEST(MonteCarlo, TheSameSeedGivesTheSameEstimates) {
  std::vector<Pose2> first;
  for (int run = 0; run < 2; ++run) {
    CorridorWorld world(CorridorParams{}, 2);
    MonteCarlo filter(smallMonteCarlo(), test::corridorMap(), 5);
    for (int i = 0; i < 30; ++i) {
      const auto estimate = filter.update(world.next());
      ASSERT_TRUE(estimate.T_world_robot);
      if (run == 0) {
        first.push_back(*estimate.T_world_robot);
      } else {
        EXPECT_EQ(first[static_cast<std::size_t>(i)], *estimate.T_world_robot);
      }
    }
  }
}

TEST(MonteCarlo, FindsAKidnappedRobotAgain) {
  // Without random particles nothing would be left at the new place.
  CorridorWorld world(CorridorParams{}, 3);
  MonteCarlo filter(smallMonteCarlo(), test::corridorMap(), 1);
  filter.update(world.next());
  filter.setPose(world.truth());
  for (int i = 0; i < 100; ++i) filter.update(world.next());
  world.kidnap();
  bool there = false;
  for (int i = 0; i < 600 && !there; ++i) {
    const PoseEstimate estimate = filter.update(world.next());
    there = i > 50 && errorOf(estimate, world.truth()) < 0.3;
  }
  EXPECT_TRUE(there);
}

}  // namespace
}  // namespace vismem
