// Tests L4, L5.
#include "localization/core/likelihood/chapter_health.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/geometry/angles.h"
#include "common/geometry/projection.h"
#include "localization/core/many_lines.h"
#include "localization/corridor_world.h"

namespace vismem {
namespace {

MapSegment wall(double x1, double y1, double x2, double y2, const Label& label) {
  return {{{x1, y1, 0.0}, {x2, y2, 0.0}}, label, 0.0};
}

HealthParams ofMemory() {
  HealthParams params;
  params.source = ObservationSource::kMemory;
  return params;
}

TEST(MemoryHealth, IsOneMinusMeanDistanceOverHalfAMetre) {
  SegmentMap map;
  map.segments = {wall(0, 0, 4, 0, "skirting"), wall(0, 0.1, 4, 0.1, "door_foot")};
  const MapIndex index(map, {});
  const int skirting = *index.labelId("skirting");
  // First line: ends 0.1 and 0.2 m from the skirting (the nearer door foot does not count), mean 0.15.
  // Second: ends 0 and 0.3 m, mean 0.15. Mean of both 0.15: H = 1 - 0.15 / 0.5 = 0.7.
  const std::vector<RememberedLine> lines = {{{{1.0, 0.1}, {2.0, 0.2}}, skirting},
                                             {{{1.0, 0.0}, {2.0, -0.3}}, skirting}};
  EXPECT_NEAR(memoryHealth(lines, {0, 0, 0}, index, 0.5), 0.7, 1e-12);
  // Seen from a robot at (3, 1) heading back: the same lines given in its frame.
  const Pose2 pose{3.0, 1.0, degToRad(180)};
  std::vector<RememberedLine> seen;
  for (const RememberedLine& line : lines) seen.push_back({transform(inverse(pose), line.robot), line.label});
  EXPECT_NEAR(memoryHealth(seen, pose, index, 0.5), 0.7, 1e-12);
}

TEST(MemoryHealth, DistancesAreNotTruncatedAndHealthIsClamped) {
  SegmentMap map;
  map.segments = {wall(0, 0, 4, 0, "skirting")};
  const MapIndex index(map, {});
  // One line right, one 10 m away: mean 5 m, far under zero.
  const std::vector<RememberedLine> lines = {{{{1, 0}, {2, 0}}, 0}, {{{1, 10}, {2, 10}}, 0}};
  EXPECT_DOUBLE_EQ(memoryHealth(lines, {0, 0, 0}, index, 0.5), 0.0);
  EXPECT_NEAR(index.distance(0, {1, 10}), 10.0, 1e-12);
}

double exhaustiveHealth(const std::vector<RememberedLine>& lines, const Pose2& pose, const MapIndex& index,
                        double scale_m) {
  double sum_m = 0.0;
  for (const RememberedLine& line : lines) {
    const Segment2 world = transform(pose, line.robot);
    for (const auto& end : {world.a, world.b}) sum_m += exhaustiveDistance(index, line.label, end);
  }
  return std::clamp(1.0 - sum_m / (2.0 * static_cast<double>(lines.size()) * scale_m), 0.0, 1.0);
}

TEST(HealthProperty, FieldsGiveTheExactMemoryHealthInALargeMap) {
  RandomEngine engine(17);
  const SegmentMap map = manyLines(engine);
  const MapIndex index(map, chapterIndex({}));
  int good = 0;
  int far = 0;
  for (int round = 0; round < 60; ++round) {
    const Pose2 truth{uniform(engine, 10, 90), uniform(engine, 10, 90), uniform(engine, -3, 3)};
    std::vector<RememberedLine> lines;
    for (int label = 0; label < 2; ++label) {
      for (const Segment2& line : index.floor(label)) {
        if ((line.middle() - truth.position()).norm() > 6.0) continue;
        lines.push_back({transform(inverse(truth), line), label});
      }
      // Something that the map does not have.
      const Eigen::Vector2d a(uniform(engine, -4, 4), uniform(engine, -4, 4));
      if (round % 2 == 0) lines.push_back({{a, a + Eigen::Vector2d(1, 0)}, label});
    }
    ASSERT_GT(lines.size(), 8u);
    for (int i = 0; i < 30; ++i) {
      const double off = 0.01 * i;
      Pose2 pose = truth * Pose2{off * uniform(engine, -1, 1), off, off * uniform(engine, -1, 1)};
      if (i % 3 == 0) pose.x += uniform(engine, -150, 150);
      // So wide that places far off the map have some health too.
      const double scale_m = i % 2 == 0 ? 0.5 : 50.0;
      const double health = exhaustiveHealth(lines, pose, index, scale_m);
      ASSERT_NEAR(memoryHealth(lines, pose, index, scale_m), health, 1e-12);
      good += health > 0.3 && scale_m < 1.0 ? 1 : 0;
      far += health < 0.9 && health > 0.0 && scale_m > 1.0 ? 1 : 0;
    }
  }
  EXPECT_GT(good, 20);
  EXPECT_GT(far, 50);
}

TEST(HealthProperty, IsOneAtTheTruePose) {
  test::CorridorParams params;
  params.end_noise_m = 0.0;
  params.odometry_scale_error = 0.0;
  params.odometry_turn_noise = 0.0;
  test::CorridorWorld world(params, 4);
  MemoryUpdate update;
  for (int i = 0; i < 50; ++i) update = world.next();
  const MapIndex index(test::corridorMap(), {});
  HealthObservation observation(index, ofMemory());
  observation.set(update);
  EXPECT_NEAR(observation.health(world.truth()), 1.0, 1e-9);
  const Pose2 beside{world.truth().x, world.truth().y, world.truth().theta + 0.3};
  EXPECT_LT(observation.health(beside), 0.9);
}

TEST(ImageHealth, HandWorkedDistances) {
  // The camera at 1 m over the origin looks straight down the world's x by 45 degrees; an edge of the floor
  // across its view at x = 1 lies on the image's middle row.
  SegmentMap map;
  map.segments = {wall(1, -3, 1, 3, "line")};
  const MapIndex index(map, {});
  CameraMount mount;
  mount.T_robot_pantilt = poseFromXyzRpy(0, 0, 1, 0, 0, 0);
  const Pose3 T = cameraPose(mount, 0.0, degToRad(-45));
  const CameraIntrinsics camera = intrinsicsFromFieldOfView(320, 240, degToRad(60));
  // Distances 0, 10 and 20 px: mean 10, H = 1 - 10 / 50 = 0.8.
  const std::vector<ImagePoint> points = {{{100, 119.5}, 0}, {{150, 129.5}, 0}, {{200, 99.5}, 0}};
  std::vector<Segment2> room;
  EXPECT_NEAR(imageHealth(points, camera, T, index, 50.0, room), 0.8, 1e-6);
  EXPECT_NEAR(imageHealth({points[0]}, camera, T, index, 50.0, room), 1.0, 1e-6);
  // Turned away no line is in view: each point counts M.
  const Pose3 away = toPose3({0, 0, degToRad(180)}) * T;
  EXPECT_DOUBLE_EQ(imageHealth(points, camera, away, index, 50.0, room), 0.0);
}

TEST(ImageHealth, AFalseLabelCostsItsShareOfThePoints) {
  // As HandWorkedDistances, and a second label whose line lies behind the camera.
  SegmentMap map;
  map.segments = {wall(1, -3, 1, 3, "line"), wall(-5, -3, -5, 3, "edge")};
  const MapIndex index(map, {});
  CameraMount mount;
  mount.T_robot_pantilt = poseFromXyzRpy(0, 0, 1, 0, 0, 0);
  const Pose3 T = cameraPose(mount, 0.0, degToRad(-45));
  const CameraIntrinsics camera = intrinsicsFromFieldOfView(320, 240, degToRad(60));
  std::vector<ImagePoint> points(3, {{100, 119.5}, *index.labelId("line")});
  points.push_back({{200, 60}, *index.labelId("edge")});
  // Three points at distance 0, one at M: H = 1 - (50 / 4) / 50.
  std::vector<Segment2> room;
  EXPECT_NEAR(imageHealth(points, camera, T, index, 50.0, room), 0.75, 1e-6);
}

TEST(HealthObservation, BothIsTheMeanOfImageAndMemory) {
  // The world line across the view at x = 1 (see ImageHealth) seen 5 px too low: H = 1 - 5 / 50 = 0.9; the
  // memory has it where it is: H = 1; both: the mean.
  SegmentMap map;
  map.segments = {wall(1, -3, 1, 3, "line")};
  const MapIndex index(map, {});
  CameraMount mount;
  mount.T_robot_pantilt = poseFromXyzRpy(0, 0, 1, 0, 0, 0);
  auto analysis = std::make_shared<ImageAnalysis>();
  analysis->intrinsics = intrinsicsFromFieldOfView(320, 240, degToRad(60));
  analysis->T_robot_camera = cameraPose(mount, 0.0, degToRad(-45));
  analysis->observed = {{{{20.5, 124.5}, {300.5, 124.5}}, "line", 30.0},
                        {{{5, 5}, {90, 90}}, kUnknownLabel, 30.0}};
  auto snapshot = std::make_shared<MemorySnapshot>();
  MemorySegment segment;
  segment.odom = {{1, -1, 0}, {1, 1, 0}};
  segment.label = "line";
  snapshot->segments.push_back(segment);
  HealthParams params;
  for (const auto& [source, expected] : {std::pair(ObservationSource::kImage, 0.9),
                                         {ObservationSource::kMemory, 1.0},
                                         {ObservationSource::kBoth, 0.95}}) {
    params.source = source;
    HealthObservation observation(index, params);
    observation.set({snapshot, analysis});
    EXPECT_NEAR(observation.health({0, 0, 0}), expected, 1e-6);
  }
}

TEST(ImageHealth, ALabelCountsItsOwnLinesOnly) {
  // As HandWorkedDistances, with a second label whose line lies nearer to the camera.
  SegmentMap map;
  map.segments = {wall(1, -3, 1, 3, "line"), wall(0.5, -3, 0.5, 3, "edge")};
  const MapIndex index(map, {});
  CameraMount mount;
  mount.T_robot_pantilt = poseFromXyzRpy(0, 0, 1, 0, 0, 0);
  const Pose3 T = cameraPose(mount, 0.0, degToRad(-45));
  const CameraIntrinsics camera = intrinsicsFromFieldOfView(320, 240, degToRad(60));
  // The point lies on "line": distance 0. "edge" at x = 0.5 m is seen at atan(0.5 / 1) - 45 degrees = -18.4
  // degrees from the axis: f tan(18.4 degrees) = 277.1 * 0.3333 = 92.4 px away.
  std::vector<Segment2> room;
  EXPECT_NEAR(imageHealth({{{150, 119.5}, *index.labelId("line")}}, camera, T, index, 200.0, room), 1.0,
              1e-6);
  EXPECT_NEAR(imageHealth({{{150, 119.5}, *index.labelId("edge")}}, camera, T, index, 200.0, room),
              1.0 - 92.376 / 200.0, 1e-4);
}

TEST(HealthObservation, UnknownLabelsAreLeftOut) {
  const MapIndex index(test::corridorMap(), {});
  auto snapshot = std::make_shared<MemorySnapshot>();
  MemorySegment segment;
  segment.odom = {{1, 0, 0}, {2, 0, 0}};
  segment.label = kUnknownLabel;
  snapshot->segments.push_back(segment);
  HealthObservation observation(index, ofMemory());
  observation.set({snapshot, nullptr});
  EXPECT_TRUE(observation.isEmpty());
}

}  // namespace
}  // namespace vismem
