// Units of localization/core/evolution and explorers (SPEC L6, L9).
#include "localization/core/evolution.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "common/geometry/angles.h"
#include "localization/core/explorers.h"
#include "localization/corridor_world.h"

namespace vismem {
namespace {

constexpr double kPi = std::numbers::pi;

/// Falls with the distance from (1, 2, pi), on the circle.
double healthOf(const Pose2& pose, double = 0.0) {
  return std::max(0.0,
                  1.0 - std::hypot(pose.x - 1.0, pose.y - 2.0) - std::abs(angleDifference(pose.theta, kPi)));
}

TEST(Evolution, TwentyTwentySixtyOfThirty) {
  const EvolutionParams params;
  EXPECT_EQ(eliteCount(params), 6);
  RandomEngine engine(1);
  Race race = foundRace({{1, 2, kPi}, 1.0}, params, engine);
  EXPECT_EQ(race.individuals.size(), 30u);
  rateRace(race, params, healthOf);
  evolveRace(race, params, engine);
  EXPECT_EQ(race.individuals.size(), 30u);
}

TEST(Evolution, BornWithinThermalNoise) {
  const EvolutionParams params;
  RandomEngine engine(2);
  const Race race = foundRace({{1, 2, kPi}, 1.0}, params, engine);
  for (const Individual& one : race.individuals) {
    EXPECT_LE(std::abs(one.T_world_robot.x - 1.0), 0.1);
    EXPECT_LE(std::abs(one.T_world_robot.y - 2.0), 0.1);
    EXPECT_LE(std::abs(angleDifference(one.T_world_robot.theta, kPi)), degToRad(15) + 1e-12);
  }
}

TEST(EvolutionProperty, TheEliteSurvivesAGenerationUnchanged) {
  const EvolutionParams params;
  RandomEngine engine(3);
  Race race = foundRace({{1.2, 2.1, kPi - 0.1}, 0.5}, params, engine);
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

TEST(EvolutionProperty, HealthsUnderTheEliteNeedNotBeTold) {
  const EvolutionParams params;
  RandomEngine engine(7);
  int spared = 0;
  for (int round = 0; round < 200; ++round) {
    const Pose2 around{uniform(engine, 0.5, 1.5), uniform(engine, 1.5, 2.5), kPi};
    Race whole = foundRace({around}, params, engine);
    // Equal healths too.
    for (Individual& one : whole.individuals) {
      if (uniform(engine, 0, 1) < 0.3) one = whole.individuals[pick(engine, whole.individuals.size())];
    }
    Race thrifty = whole;
    std::vector<Individual> reference = whole.individuals;
    for (Individual& one : reference) one.health = healthOf(one.T_world_robot);
    std::stable_sort(reference.begin(), reference.end(),
                     [](const Individual& a, const Individual& b) { return a.health > b.health; });
    rateRace(whole, params, healthOf);
    rateRace(thrifty, params, [&](const Pose2& pose, double least) {
      const double health = healthOf(pose);
      spared += health < least ? 1 : 0;
      return health < least ? 0.0 : health;
    });
    ASSERT_EQ(whole.individuals.size(), thrifty.individuals.size());
    for (std::size_t i = 0; i < whole.individuals.size(); ++i) {
      ASSERT_EQ(whole.individuals[i].T_world_robot, thrifty.individuals[i].T_world_robot);
      ASSERT_EQ(whole.individuals[i].health, thrifty.individuals[i].health);
    }
    EXPECT_EQ(whole.health, thrifty.health);
    for (std::size_t i = 0; i < 6; ++i) {
      EXPECT_EQ(whole.individuals[i].T_world_robot, reference[i].T_world_robot);
      EXPECT_EQ(whole.individuals[i].health, reference[i].health);
    }
  }
  EXPECT_GT(spared, 2000);
}

TEST(Evolution, TheEliteIsNotRatedAgainForTheSameObservation) {
  const EvolutionParams params;
  RandomEngine engine(8);
  Race race = foundRace({{1, 2, kPi}}, params, engine);
  int rated = 0;
  const auto count = [&](const Pose2& pose, double) {
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

TEST(Explorers, ManyWhenLostFewAndSeldomWhenReliable) {
  const ExplorerParams params;
  EXPECT_GE(explorerCount(params, 0.0, 1), 1000);
  EXPECT_GE(explorerCount(params, 0.59, 3), 1000);
  EXPECT_EQ(explorerCount(params, 0.9, 1), 0);
  EXPECT_EQ(explorerCount(params, 0.9, 4), params.count_reliable);
}

TEST(Explorers, UniformOnesStayInTheMapsBox) {
  const MapIndex map(test::corridorMap(), {});
  RandomEngine engine(4);
  for (int i = 0; i < 1000; ++i) {
    const Pose2 pose = uniformExplorer(map, 0.0, engine);
    EXPECT_TRUE(pose.x >= -0.75 && pose.x <= 8.75 && pose.y >= -0.75 && pose.y <= 5.75);
  }
}

TEST(Explorers, UniformOnesAreFewerInALargeMapInProportion) {
  const MapIndex map(test::corridorMap(), {});  // 9.5 x 6.5 m
  EXPECT_DOUBLE_EQ(uniformShare(map, 0.0, 1000.0), 1.0);
  EXPECT_NEAR(uniformShare(map, 0.0, 0.25 * 9.5 * 6.5), 0.25, 1e-9);
  EXPECT_NEAR(uniformShare(map, 1.0, 0.25 * 11.5 * 8.5), 0.25, 1e-9);
  EXPECT_DOUBLE_EQ(uniformShare(map, 0.0, 0.0), 1.0) << "0: as many in every map";
}

TEST(Explorers, BestPlacesAreDistinctAndInOrder) {
  std::vector<Individual> explorers = {
      {{0, 0, 0}, 0.7}, {{0.1, 0, 0}, 0.9}, {{3, 0, 0}, 0.8}, {{6, 0, 0}, 0.2}};
  const auto best = bestPlaces(explorers, 6, 0.3, {});
  ASSERT_EQ(best.size(), 2u);
  EXPECT_DOUBLE_EQ(best[0].health, 0.9);
  EXPECT_DOUBLE_EQ(best[1].health, 0.8);
}

TEST(ExplorersProperty, WhatIsUnderTheBarWouldNotHaveBeenAmongTheBest) {
  RandomEngine engine(9);
  int spared = 0;
  for (int round = 0; round < 300; ++round) {
    // From so crowded that many are at one place to far apart.
    const double side_m = std::pow(10.0, uniform(engine, -0.7, 1.5));
    const int count = 1 + static_cast<int>(pick(engine, 7));
    std::vector<Individual> all;
    std::vector<Individual> told;
    CandidateBar bar(count, 0.3, {});
    for (int i = 0; i < 200; ++i) {
      Individual one{{uniform(engine, 0, side_m), uniform(engine, 0, side_m), uniform(engine, -kPi, kPi)},
                     0.05 * std::floor(uniform(engine, 0, 20))};  // equal ones too
      all.push_back(one);
      if (one.health < bar.least()) {
        ++spared;
        one.health = 0.0;
      }
      told.push_back(one);
      bar.add(one);
    }
    const auto expected = bestPlaces(all, count, 0.3, {});
    const auto best = bestPlaces(told, count, 0.3, {});
    ASSERT_EQ(best.size(), expected.size());
    for (std::size_t i = 0; i < best.size(); ++i) {
      ASSERT_EQ(best[i].T_world_robot, expected[i].T_world_robot) << "round " << round;
      ASSERT_EQ(best[i].health, expected[i].health);
    }
  }
  EXPECT_GT(spared, 20'000);
}

TEST(Explorers, ConstructedOnesLayASeenSegmentOnTheMap) {
  SegmentMap one;
  one.segments = {{{{2, 1, 0}, {6, 1, 0}}, "skirting", 0.0}};
  const MapIndex map(one, {});
  const ConstructedExplorers constructed(map);
  RobustObservation observation;
  observation.segments = {{{{0.5, 0.7}, {1.5, 0.7}}, 0, 1.0}};
  observation.segment_weight = 1.0;
  RandomEngine engine(6);
  for (int i = 0; i < 200; ++i) {
    const auto pose = constructed.propose(observation, engine);
    ASSERT_TRUE(pose);
    const Segment2 world = transform(*pose, observation.segments[0].robot);
    // On the wall's line, and overlapping it.
    EXPECT_NEAR(world.a.y(), 1.0, 1e-9);
    EXPECT_NEAR(world.b.y(), 1.0, 1e-9);
    EXPECT_LE(std::min(world.a.x(), world.b.x()), 6.0);
    EXPECT_GE(std::max(world.a.x(), world.b.x()), 2.0);
  }
}

TEST(Explorers, ConstructedOnesChooseSegmentsByLength) {
  SegmentMap map_edges;
  RandomEngine engine(7);
  double whole = 0.0;
  // Lengths from millimetres to tens of metres, and points, each on a line of its own.
  for (int i = 0; i < 40; ++i) {
    const double length = i % 8 == 0 ? 0.0 : std::exp(uniform(engine, -6.0, 3.5));
    whole += length;
    map_edges.segments.push_back({{{0, 1.0 * i, 0}, {length, 1.0 * i, 0}}, "skirting", 0.0});
  }
  const MapIndex map(map_edges, {});
  const ConstructedExplorers constructed(map);
  RobustObservation observation;
  observation.segments = {{{{0.0, 0.0}, {1.0, 0.0}}, 0, 1.0}};
  observation.segment_weight = 1.0;
  constexpr int kCount = 40'000;
  std::vector<int> chosen(map_edges.segments.size(), 0);
  for (int i = 0; i < kCount; ++i) {
    const auto pose = constructed.propose(observation, engine);
    ASSERT_TRUE(pose);
    ++chosen.at(static_cast<std::size_t>(std::lround(pose->y)));
  }
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const double share = map_edges.segments[i].world.floor().length() / whole;
    // Five standard deviations of a count; one where hardly any is expected.
    EXPECT_NEAR(chosen[i], kCount * share, 5.0 * std::sqrt(kCount * share) + 1.0) << "segment " << i;
    if (share == 0.0) {
      EXPECT_EQ(chosen[i], 0);
    }
  }
}

}  // namespace
}  // namespace vismem
