// Tests L6.
#include "localization/core/hypotheses/landmark_explorers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "common/geometry/angles.h"
#include "localization/core/hypotheses/explorers.h"
#include "localization/corridor_world.h"

namespace vismem {
namespace {

MapSegment wall(double x1, double y1, double x2, double y2, const Label& label = "skirting") {
  return {{{x1, y1, 0.0}, {x2, y2, 0.0}}, label, 0.0};
}

const Pose2 kTruth{1.2, 0.9, 0.7};
RandomEngine g_engine(7);

/// What a robot at kTruth remembers of a part of the world.
ObservedSegment seen(const MapIndex& map, double x1, double y1, double x2, double y2,
                     const Label& label = "skirting") {
  return {transform(inverse(kTruth), Segment2{{x1, y1}, {x2, y2}}), *map.labelId(label), 1.0};
}

/// Share of picks that come near the truth.
double shareNearTruth(const LandmarkExplorers::Proposals& proposals) {
  RandomEngine engine(1);
  int near = 0;
  constexpr int kPicks = 400;
  for (int i = 0; i < kPicks; ++i) {
    const Pose2 pose = proposals.pick(engine);
    near += (pose.position() - kTruth.position()).norm() < 0.05 &&
            std::abs(angleDifference(pose.theta, kTruth.theta)) < degToRad(2);
  }
  return static_cast<double>(near) / kPicks;
}

TEST(Junctions, ACornerHasOnePairOfArms) {
  std::vector<JunctionLandmark> found;
  appendJunctions({{{0, 0}, {2, 0}}, 0}, {{{0.05, 0.1}, {0.05, 3}}, 1}, 0.2, found);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR((found[0].vertex - Eigen::Vector2d(0.05, 0)).norm(), 0.0, 1e-9);
  EXPECT_NEAR(found[0].direction_a, 0.0, 1e-9);
  EXPECT_NEAR(found[0].turn, degToRad(90), 1e-9);
  EXPECT_NEAR(found[0].length_b, 3.0, 1e-9);
}

TEST(Junctions, ATHasTwoPairs) {
  std::vector<JunctionLandmark> found;
  appendJunctions({{{-2, 0}, {2, 0}}, 0}, {{{0, 0}, {0, 3}}, 0}, 0.2, found);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_NEAR(std::abs(found[0].turn), degToRad(90), 1e-9);
  EXPECT_NEAR(found[0].turn + found[1].turn, 0.0, 1e-9);
}

TEST(Junctions, AlongOneLineTheyNeedAChangeOfLabel) {
  std::vector<JunctionLandmark> found;
  appendJunctions({{{0, 0}, {2, 0}}, 0}, {{{2.05, 0}, {3, 0}}, 0}, 0.2, found);
  EXPECT_TRUE(found.empty());
  appendJunctions({{{0, 0}, {2, 0}}, 0}, {{{2.05, 0}, {3, 0}}, 1}, 0.2, found);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(std::abs(found[0].turn), degToRad(180), 1e-9);
}

TEST(Junctions, SegmentsApartHaveNone) {
  std::vector<JunctionLandmark> found;
  appendJunctions({{{0, 0}, {2, 0}}, 0}, {{{3, 1}, {3, 3}}, 0}, 0.2, found);
  appendJunctions({{{0, 0}, {2, 0}}, 0}, {{{0, 0.1}, {2, 0.1}}, 1}, 0.2, found);
  EXPECT_TRUE(found.empty());
}

/// A room with one corner of a kind: two labels meet.
SegmentMap roomMap() {
  SegmentMap map;
  map.segments = {wall(0, 0, 4, 0), wall(4, 0, 4, 3), wall(4, 3, 0, 3, "brick"), wall(0, 3, 0, 0),
                  wall(1.5, 1, 2.1, 1, "step")};
  return map;
}

TEST(LandmarkExplorers, ACornerFixesThePose) {
  const MapIndex map(roomMap(), {});
  const LandmarkExplorers explorers(map, {true, false, false});
  FloorObservation observation;
  observation.segments = {seen(map, 4, 2.9, 4, 2), seen(map, 3.8, 3, 2.5, 3, "brick")};
  const auto proposals = explorers.match(observation, 500, g_engine);
  // Of the two corners of these labels only one turns this way.
  EXPECT_EQ(proposals.count(), 1u);
  EXPECT_EQ(shareNearTruth(proposals), 1.0);
  EXPECT_TRUE(LandmarkExplorers(map, {false, true, true}).match(observation, 500, g_engine).isEmpty());
}

TEST(LandmarkExplorers, ADoorIsRecognisedByItsLengthInBothDirections) {
  const MapIndex map(roomMap(), {});
  const LandmarkExplorers explorers(map, {false, true, false});
  FloorObservation observation;
  observation.segments = {seen(map, 1.52, 1, 2.1, 1, "step")};
  const auto proposals = explorers.match(observation, 500, g_engine);
  EXPECT_EQ(proposals.count(), 2u);
  EXPECT_NEAR(shareNearTruth(proposals), 0.5, 0.1);
  EXPECT_TRUE(LandmarkExplorers(map, {true, false, true}).match(observation, 500, g_engine).isEmpty());
}

TEST(LandmarkExplorers, AChangeOfLabelAlongAWallFixesThePose) {
  SegmentMap two;
  two.segments = {wall(0, 0, 4, 0), wall(4, 0, 9, 0, "brick")};
  const MapIndex map(two, {});
  const LandmarkExplorers explorers(map, {false, true, false});
  FloorObservation observation;
  observation.segments = {seen(map, 0.8, 0, 3.95, 0), seen(map, 4.02, 0, 7, 0, "brick")};
  const auto proposals = explorers.match(observation, 500, g_engine);
  EXPECT_EQ(proposals.count(), 1u);
  EXPECT_EQ(shareNearTruth(proposals), 1.0);
}

TEST(LandmarkExplorers, AParallelogramFixesThePoseUpToItsSymmetry) {
  SegmentMap rug;
  rug.segments = {wall(2, 1, 4, 1, "rug"), wall(4, 1, 4, 2, "rug"), wall(4, 2, 2, 2, "rug"),
                  wall(2, 2, 2, 1, "rug"), wall(0, 0, 9, 0)};
  const MapIndex map(rug, {});
  const LandmarkExplorers explorers(map, {false, false, true});
  FloorObservation observation;
  auto& corners = observation.parallelograms.emplace_back();
  const Eigen::Vector2d world[] = {{2, 1}, {4.05, 1}, {4, 2}, {2, 2.03}};
  for (std::size_t i = 0; i < 4; ++i) corners[i] = transform(inverse(kTruth), world[i]);
  const auto proposals = explorers.match(observation, 500, g_engine);
  // Each of four corners lies on itself or on the opposite one.
  EXPECT_EQ(proposals.count(), 8u);
  RandomEngine engine(2);
  int near = 0;
  for (int i = 0; i < 100; ++i) {
    const Pose2 pose = proposals.pick(engine);
    near += (pose.position() - kTruth.position()).norm() < 0.12;
  }
  EXPECT_NEAR(near, 50, 15);
  EXPECT_TRUE(LandmarkExplorers(map, {true, true, false}).match(observation, 500, g_engine).isEmpty());
}

TEST(LandmarkExplorers, FindThePoseInALargeMap) {
  SegmentMap large;
  for (int i = 0; i < 2500; ++i) {
    const double x = 10.0 * (i % 50);
    const double y = 10.0 * (i / 50);
    large.segments.push_back(wall(x, y, x + 3 + 0.001 * i, y));
    large.segments.push_back(wall(x, y, x, y + 3));
  }
  const MapIndex map(large, [] {
    MapIndex::Params params;
    params.build_fields = false;
    return params;
  }());
  const LandmarkExplorers explorers(map, {});
  FloorObservation observation;
  observation.segments = {seen(map, 0, 0, 3, 0), seen(map, 0, 0, 0, 3)};
  // A sample of what would be 10 000 places.
  const auto proposals = explorers.match(observation, 500, g_engine);
  EXPECT_GE(proposals.count(), 100u);
  EXPECT_LE(proposals.count(), 2000u);
}

// Fox 2003, equation 7: k - 1 = 1, error 0.05: 10 * (1 - 2/9 + sqrt(2/9) * 2.326)^3 = 10 * 1.87425^3 = 65.8.
TEST(KldBound, HandWorkedExample) {
  EXPECT_EQ(kldBound(1, 0.05), 1);
  EXPECT_EQ(kldBound(2, 0.05), 66);
  EXPECT_GT(kldBound(20, 0.05), kldBound(10, 0.05));
  EXPECT_GT(kldBound(10, 0.01), kldBound(10, 0.05));
}

}  // namespace
}  // namespace vismem
