// Tests L6.
#include "localization/core/hypotheses/explorers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "localization/corridor_world.h"

namespace vismem {
namespace {

constexpr double kPi = std::numbers::pi;

TEST(Explorers, AreManyWhenLostAndFewAndRareWhenReliable) {
  const ExplorerParams params;
  EXPECT_GE(explorerCount(params, 0.0, false, 1), 1000);
  EXPECT_GE(explorerCount(params, 0.59, false, 3), 1000);
  EXPECT_EQ(explorerCount(params, 0.9, false, 1), 0);
  EXPECT_EQ(explorerCount(params, 0.9, false, 4), params.count_reliable);
  EXPECT_EQ(explorerCount(params, 0.0, true, 1), 0);
  EXPECT_EQ(explorerCount(params, 0.0, true, 4), params.count_lost);
}

TEST(Explorers, UniformOnesStayInTheMapsBoundingBox) {
  const MapIndex map(test::corridorMap(), {});
  RandomEngine engine(4);
  for (int i = 0; i < 1000; ++i) {
    const Pose2 pose = uniformExplorer(map, 0.0, engine);
    EXPECT_TRUE(pose.x >= -0.75 && pose.x <= 8.75 && pose.y >= -0.75 && pose.y <= 5.75);
  }
}

TEST(Explorers, UniformOnesAreReducedInProportionInALargeMap) {
  const MapIndex map(test::corridorMap(), {});  // 9.5 x 6.5 m
  EXPECT_DOUBLE_EQ(uniformShare(map, 0.0, 1000.0), 1.0);
  EXPECT_NEAR(uniformShare(map, 0.0, 0.25 * 9.5 * 6.5), 0.25, 1e-9);
  EXPECT_NEAR(uniformShare(map, 1.0, 0.25 * 11.5 * 8.5), 0.25, 1e-9);
  EXPECT_DOUBLE_EQ(uniformShare(map, 0.0, 0.0), 1.0) << "0: never reduced";
}

TEST(Explorers, BestPlacesAreDistinctAndInOrder) {
  std::vector<Individual> best = {{{0, 0, 0}, 0.7}, {{0.1, 0, 0}, 0.9}, {{3, 0, 0}, 0.8}, {{6, 0, 0}, 0.2}};
  keepBestPlaces(best, 6, 0.3, {});
  ASSERT_EQ(best.size(), 2u);
  EXPECT_DOUBLE_EQ(best[0].health, 0.9);
  EXPECT_DOUBLE_EQ(best[1].health, 0.8);
}

TEST(Explorers, ConstructedOnesAlignAnObservedSegmentWithTheMap) {
  SegmentMap one;
  one.segments = {{{{2, 1, 0}, {6, 1, 0}}, "skirting", 0.0}};
  const MapIndex map(one, {});
  const ConstructedExplorers constructed(map);
  FloorObservation observation;
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

TEST(Explorers, ConstructedOnesDrawMapSegmentsByLength) {
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
  FloorObservation observation;
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
    // Five standard deviations of a count, plus one where the expectation is near 0.
    EXPECT_NEAR(chosen[i], kCount * share, 5.0 * std::sqrt(kCount * share) + 1.0) << "segment " << i;
    if (share == 0.0) {
      EXPECT_EQ(chosen[i], 0);
    }
  }
}

}  // namespace
}  // namespace vismem
