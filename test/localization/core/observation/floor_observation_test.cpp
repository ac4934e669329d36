// Tests L3, L12.
#include "localization/core/observation/floor_observation.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/geometry/angles.h"
#include "common/geometry/projection.h"
#include "localization/core/corner_scene.h"

namespace vismem {
namespace {

/// A line straight ahead, as wide as asked for.
ImageAnalysis centredLine(double half_width_px) {
  return lineAhead(159.5 - half_width_px, 159.5 + half_width_px);
}

TEST(ObserveMemory, HalvesTheWeightEveryFourSecondsUnseen) {
  const MapIndex map = cornerMap();
  const ObservationParams params;  // 5 points a metre
  EXPECT_NEAR(observeMemory(snapshotOf({remembered(0, 1, 1, 1)}), map, params).amount, 5.0, 1e-9);
  EXPECT_NEAR(observeMemory(snapshotOf({remembered(0, 1, 1, 1, 4)}), map, params).amount, 2.5, 1e-9);
  EXPECT_NEAR(observeMemory(snapshotOf({remembered(0, 1, 1, 1, 8)}), map, params).amount, 1.25, 1e-9);
}

TEST(ObserveMemory, UnconfirmedElementsWeighLess) {
  const MapIndex map = cornerMap();
  MemorySegment segment = remembered(0, 1, 1, 1);
  segment.confirmed = false;
  const ObservationParams params;
  EXPECT_NEAR(observeMemory(snapshotOf({segment}), map, params).amount, 5.0 * 0.4, 1e-9);
}

TEST(ObserveMemory, LeavesOutWhatIsOffTheFloor) {
  MemorySegment top = remembered(0, 1, 1, 1);
  top.confirmed = false;
  top.off_floor = true;
  EXPECT_TRUE(observeMemory(snapshotOf({top}), cornerMap(), {}).points.empty());
}

TEST(ObserveMemory, WeightsSumToAtMostTheEffectivePoints) {
  const MapIndex map = cornerMap();
  std::vector<MemorySegment> many;
  for (int i = 0; i < 30; ++i) many.push_back(remembered(0, 0.1 * i, 3, 0.1 * i));
  const FloorObservation observation = observeMemory(snapshotOf(many), map, {});
  double sum = 0.0;
  for (const FloorPoint& point : observation.points) sum += point.weight;
  EXPECT_NEAR(sum, 30.0, 1e-9);
}

TEST(ObserveMemory, LeavesOutLabelsThatTheMapLacks) {
  const MapIndex map = cornerMap();
  MemorySegment unknown = remembered(0, 1, 1, 1);
  unknown.label = kUnknownLabel;
  MemorySegment foreign = remembered(0, 1, 1, 1);
  foreign.label = "poster";
  EXPECT_TRUE(observeMemory(snapshotOf({unknown, foreign}), map, {}).points.empty());
}

TEST(ObserveImage, PointsLieOnTheProjectedLine) {
  // Camera at 1 m, 45 degrees down: its middle row shows the floor 1 m ahead; range noise there is
  // (1^2 + 1^2) / 1 * 0.01 = 0.02 m across this line, beside the least sigma of every point.
  SegmentMap one;
  one.segments = {wall(1, -3, 1, 3)};
  const MapIndex map(one, {});
  CameraMount mount;
  mount.T_robot_pantilt = poseFromXyzRpy(0, 0, 1, 0, 0, 0);
  ImageAnalysis analysis;
  analysis.intrinsics = intrinsicsFromFieldOfView(320, 240, degToRad(60));
  analysis.T_robot_camera = cameraPose(mount, 0.0, degToRad(-45));
  analysis.observed = {{{{140, 119.5}, {180, 119.5}}, "skirting", 30.0},
                       {{{140, 20}, {180, 20}}, kUnknownLabel, 30.0}};
  ObservationParams params;
  params.camera_sigma_rad = 0.01;
  params.end_metres = 0.0;
  const FloorObservation observation = observeImage(analysis, map, params);
  ASSERT_FALSE(observation.points.empty());
  for (const FloorPoint& point : observation.points) {
    EXPECT_NEAR(point.p_robot.x(), 1.0, 1e-9);
    EXPECT_NEAR(lineAngleDifference(point.direction_robot, degToRad(90)), 0.0, 1e-9);
    EXPECT_NEAR(point.sigma_m, std::hypot(ObservationParams().sigma_m, 0.02), 2e-3);
  }
  // 40 px at f = 277 px and 1.414 m: 0.204 m of floor at 5 points a metre.
  EXPECT_NEAR(observation.amount, 5.0 * 40 / 277.13 * std::sqrt(2.0), 1e-3);
}

TEST(ObserveImage, LevelEdgesCountBelowTheCamera) {
  for (const double height_m : {0.5, 2.0}) {
    SegmentMap map;
    map.segments = {{{{1, -3, height_m}, {1, 3, height_m}}, "skirting", 0.0}};
    EXPECT_EQ(observeImage(centredLine(60), MapIndex(map, {}), {}).points.empty(), height_m > 1.0);
  }
}

TEST(ObserveImage, WhatTheMemoryKnowsOffTheFloorShowsEdgesAtHeightsOnly) {
  SegmentMap floor, raised;
  floor.segments = {wall(1, -3, 1, 3)};
  raised.segments = {wall(1, -3, 1, 3), {{{1, -3, 0.5}, {1, 3, 0.5}}, "skirting", 0.0}};
  ImageAnalysis analysis = centredLine(60);
  analysis.predicted = {{7, analysis.observed[0].px, analysis.observed[0].label, true}};
  EXPECT_FALSE(observeImage(analysis, MapIndex(floor, {}), {}).points.empty()) << "no match";
  analysis.matches = {{0, 0}};
  const FloorObservation none = observeImage(analysis, MapIndex(floor, {}), {});
  EXPECT_TRUE(none.points.empty());
  EXPECT_TRUE(none.segments.empty());
  const FloorObservation high = observeImage(analysis, MapIndex(raised, {}), {});
  ASSERT_FALSE(high.points.empty());
  EXPECT_TRUE(high.segments.empty());
  for (const FloorPoint& point : high.points) {
    EXPECT_FALSE(point.mayLieAt(0.0));
    EXPECT_TRUE(point.mayLieAt(0.5));
  }
}

TEST(ObserveImage, AnEndInsideTheImageAddsAPoint) {
  SegmentMap one;
  one.segments = {wall(1, -3, 1, 3)};
  const MapIndex map(one, {});
  ObservationParams without;
  without.end_metres = 0.0;
  const auto more = [&](const ImageAnalysis& analysis) {
    return observeImage(analysis, map, {}).points.size() - observeImage(analysis, map, without).points.size();
  };
  EXPECT_EQ(more(lineAhead(40, 280)), 2u);
  EXPECT_EQ(more(lineAhead(0, 280)), 1u) << "an end cut by the border is not used";
  EXPECT_EQ(more(lineAhead(0, 319)), 0u);
  const auto observation = observeImage(lineAhead(40, 280), map, {});
  EXPECT_EQ(observation.amount, observeImage(lineAhead(40, 280), map, without).amount);
  const double reach = 120 / 277.13 * std::sqrt(2.0);
  EXPECT_NEAR(std::abs(observation.points.back().p_robot.y()), reach, 5e-3);
}

TEST(Observe, MemoryAndImageShareTheEffectivePoints) {
  const MapIndex map = cornerMap();
  std::vector<MemorySegment> many;
  for (int i = 0; i < 30; ++i) many.push_back(remembered(0, 0.1 * i, 3, 0.1 * i));
  ObservationParams params;
  params.image_share = 0.4;
  params.end_metres = 0.0;
  const auto sumOf = [&](const MemoryUpdate& update) {
    double sum = 0.0;
    for (const FloorPoint& point : observe(update, map, params).points) sum += point.weight;
    return sum;
  };
  const auto snapshot = std::make_shared<MemorySnapshot>(snapshotOf(many));
  // Without image points the memory has all 30 points.
  EXPECT_NEAR(sumOf({snapshot, std::make_shared<ImageAnalysis>()}), 30.0, 1e-9);
  // With a short line in the image (0.2 m, one point at 5 a metre, of the 6 that leave the memory nothing)
  // the memory is held to five sixths of its 60 %.
  CameraMount mount;
  mount.T_robot_pantilt = poseFromXyzRpy(0, 0, 1, 0, 0, 0);
  auto analysis = std::make_shared<ImageAnalysis>();
  analysis->intrinsics = intrinsicsFromFieldOfView(320, 240, degToRad(60));
  analysis->T_robot_camera = cameraPose(mount, 0.0, degToRad(-45));
  analysis->observed = {{{{140, 119.5}, {180, 119.5}}, "skirting", 30.0}};
  const double seen = 5.0 * 40 / 277.13 * std::sqrt(2.0);
  EXPECT_NEAR(sumOf({snapshot, analysis}), (1.0 - seen / 6.0) * 0.6 * 30.0 + seen, 1e-3);
  params.source = ObservationSource::kImage;
  EXPECT_EQ(sumOf({snapshot, std::make_shared<ImageAnalysis>()}), 0.0);
}

TEST(Observe, AnImageWithEnoughPointsExcludesTheMemory) {
  const MapIndex map = cornerMap();
  ObservationParams params;
  params.memory_below_points = 3.0;
  const auto snapshot = std::make_shared<MemorySnapshot>(snapshotOf({remembered(0, 1, 1, 1)}));
  const auto seen = [&](double half_width_px) {
    return observe({snapshot, std::make_shared<ImageAnalysis>(centredLine(half_width_px))}, map, params);
  };
  const FloorObservation much = seen(150);  // 1.5 m, worth 7.6 points
  EXPECT_GT(much.amount, 7.0);
  EXPECT_EQ(much.remembered, 0u);
  EXPECT_EQ(much.segments.size(), 2u) << "segments of both";
  const FloorObservation little = seen(40);  // 0.4 m, worth 2 points
  EXPECT_GT(little.remembered, 0u);
  EXPECT_EQ(little.memory_influence, 0.0);
  EXPECT_NEAR(seen(10).memory_influence, 1.0 - 2.0 * 0.51 / 3.0, 0.01);
}

TEST(ObserveMemory, ObservedPointsHaveASmallerSigmaThanRememberedOnes) {
  const MapIndex map = cornerMap();
  const ObservationParams params;
  const auto remembering = observeMemory(snapshotOf({remembered(0, 1, 1, 1)}), map, params);
  for (const FloorPoint& point : remembering.points) {
    EXPECT_NEAR(point.sigma_m, params.remembered_sigma_m, 1e-12);
  }
  ObservationParams exact = params;
  exact.camera_sigma_rad = 0.0;
  const auto seeing = observeImage(lineAhead(40, 280), map, exact);
  ASSERT_FALSE(seeing.points.empty());
  for (const FloorPoint& point : seeing.points) EXPECT_NEAR(point.sigma_m, params.sigma_m, 1e-12);
  EXPECT_LT(params.sigma_m, params.remembered_sigma_m);
}

}  // namespace
}  // namespace vismem
