// Tests L9.
#include "localization/core/hypotheses/evolution.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/geometry/angles.h"

namespace vismem {
namespace {

constexpr double kPi = std::numbers::pi;

/// Falls with the distance from (1, 2, pi), on the circle.
double healthOf(const Pose2& pose) {
  return std::max(0.0,
                  1.0 - std::hypot(pose.x - 1.0, pose.y - 2.0) - std::abs(angleDifference(pose.theta, kPi)));
}

TEST(Evolution, KeepsCrossesAndMutatesTwentyTwentySixtyPercent) {
  const EvolutionParams params;
  EXPECT_EQ(eliteCount(params), 6);
  RandomEngine engine(1);
  Race race = createRace({{1, 2, kPi}, 1.0}, params, engine);
  EXPECT_EQ(race.individuals.size(), 30u);
  rateRace(race, params, healthOf);
  evolveRace(race, params, engine);
  EXPECT_EQ(race.individuals.size(), 30u);
}

TEST(Evolution, ANewRaceLiesWithinThermalNoise) {
  const EvolutionParams params;
  RandomEngine engine(2);
  const Race race = createRace({{1, 2, kPi}, 1.0}, params, engine);
  for (const Individual& one : race.individuals) {
    EXPECT_LE(std::abs(one.T_world_robot.x - 1.0), 0.1);
    EXPECT_LE(std::abs(one.T_world_robot.y - 2.0), 0.1);
    EXPECT_LE(std::abs(angleDifference(one.T_world_robot.theta, kPi)), degToRad(15) + 1e-12);
  }
}

TEST(Evolution, MutantsLieWithinTheSmallerNoiseOfAParent) {
  const EvolutionParams params;
  RandomEngine engine(4);
  Race race = createRace({{1, 2, kPi}, 1.0}, params, engine);
  rateRace(race, params, healthOf);
  const std::vector<Individual> parents = race.individuals;
  evolveRace(race, params, engine);
  for (std::size_t i = 12; i < 30; ++i) {  // behind elite and crossover
    const Pose2& mutant = race.individuals[i].T_world_robot;
    EXPECT_TRUE(std::any_of(parents.begin(), parents.end(), [&](const Individual& parent) {
      const Pose2& from = parent.T_world_robot;
      return std::abs(mutant.x - from.x) <= 0.03 && std::abs(mutant.y - from.y) <= 0.03 &&
             std::abs(angleDifference(mutant.theta, from.theta)) <= degToRad(3) + 1e-12;
    }));
  }
}

TEST(EvolutionProperty, TheEliteSurvivesAGenerationUnchanged) {
  const EvolutionParams params;
  RandomEngine engine(3);
  Race race = createRace({{1.2, 2.1, kPi - 0.1}, 0.5}, params, engine);
  double best = 0.0;
  for (int generation = 0; generation < 50; ++generation) {
    rateRace(race, params, healthOf);
    EXPECT_GE(race.individuals[0].health, best);  // with one and the same observation it only gets better
    best = race.individuals[0].health;
    const std::vector<Individual> before = race.individuals;
    evolveRace(race, params, engine);
    for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(race.individuals[i].T_world_robot, before[i].T_world_robot);
  }
  EXPECT_GT(best, 0.95);
}

TEST(EvolutionProperty, TheEliteAreTheHealthiestInOrder) {
  const EvolutionParams params;
  RandomEngine engine(7);
  for (int round = 0; round < 200; ++round) {
    const Pose2 around{uniform(engine, 0.5, 1.5), uniform(engine, 1.5, 2.5), kPi};
    Race whole = createRace({around}, params, engine);
    // Equal healths too.
    for (Individual& one : whole.individuals) {
      if (uniform(engine, 0, 1) < 0.3) one = whole.individuals[pick(engine, whole.individuals.size())];
    }
    std::vector<Individual> reference = whole.individuals;
    for (Individual& one : reference) one.health = healthOf(one.T_world_robot);
    std::stable_sort(reference.begin(), reference.end(),
                     [](const Individual& a, const Individual& b) { return a.health > b.health; });
    rateRace(whole, params, healthOf);
    for (std::size_t i = 0; i < 6; ++i) {
      EXPECT_EQ(whole.individuals[i].T_world_robot, reference[i].T_world_robot);
      EXPECT_EQ(whole.individuals[i].health, reference[i].health);
    }
  }
}

TEST(Evolution, TheEliteIsNotRatedTwiceByOneObservation) {
  const EvolutionParams params;
  RandomEngine engine(8);
  Race race = createRace({{1, 2, kPi}}, params, engine);
  int rated = 0;
  const auto count = [&](const Pose2& pose) {
    ++rated;
    return healthOf(pose);
  };
  rateRace(race, params, count);
  EXPECT_EQ(rated, 30);
  evolveRace(race, params, engine);
  rateRace(race, params, count);
  EXPECT_EQ(rated, 54);
  // As if all had been.
  Race again = race;
  for (Individual& one : again.individuals) one.is_rated = false;
  rateRace(again, params, count);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(again.individuals[i].T_world_robot, race.individuals[i].T_world_robot);
    EXPECT_EQ(again.individuals[i].health, race.individuals[i].health);
  }
}

TEST(Evolution, MeansAreTakenOnTheCircle) {
  const Pose2 mean = meanPose({0, 0, kPi - 0.2}, {2, 4, -kPi + 0.1});
  EXPECT_NEAR(mean.x, 1.0, 1e-12);
  EXPECT_NEAR(mean.y, 2.0, 1e-12);
  EXPECT_NEAR(angleDifference(mean.theta, kPi - 0.05), 0.0, 1e-9);
}

TEST(Evolution, PoseOfARaceAcrossTheWrapIsItsElitesMean) {
  EvolutionParams params;
  params.individuals = 4;
  params.elitism = 0.5;
  Race race;
  race.individuals = {
      {{1.0, 2.0, kPi - 0.1}, 0}, {{1.0, 2.0, -kPi + 0.1}, 0}, {{5, 5, 0}, 0}, {{6, 6, 0}, 0}};
  rateRace(race, params, healthOf);
  EXPECT_NEAR(std::abs(race.T_world_robot.theta), kPi, 1e-9);
  EXPECT_NEAR(race.health, 0.9, 1e-9);  // both of the elite are 0.1 rad off
}

}  // namespace
}  // namespace vismem
