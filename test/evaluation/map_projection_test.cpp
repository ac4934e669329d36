#include "evaluation/core/map_projection.h"

#include <gmock/gmock.h>

#include "common/geometry/angles.h"
#include "common/geometry/projection.h"

namespace vismem {
namespace {

/// A camera 1 m over the floor that looks straight down: with f = 100 px one metre on the floor is 100 px.
JudgedImage lookDown() {
  JudgedImage image;
  image.intrinsics = {.width = 320, .height = 240, .fx = 100, .fy = 100, .cx = 160, .cy = 120};
  // Camera axes in robot: x right = -y, y down = -x, z forward = -z.
  Eigen::Matrix3d R;
  R << 0, -1, 0, -1, 0, 0, 0, 0, -1;
  image.T_robot_camera.linear() = R;
  image.T_robot_camera.translation() << 0.0, 0.0, 1.0;
  image.T_world_robot = Pose2{};
  return image;
}

MapSegment edge(double x1, double y1, double x2, double y2) {
  return {{{x1, y1, 0.0}, {x2, y2, 0.0}}, "stripe_edge", 0.0};
}

/// The image of an edge when the robot's true pose is `truth`.
ImageSegment seen(const JudgedImage& image, const MapSegment& segment, const Pose2& truth = {}) {
  const auto px = projectSegment(image.intrinsics, toPose3(truth) * image.T_robot_camera, segment.world);
  return {px.value(), segment.label, 50.0};
}

const MapSegment kLine = edge(-5.0, 0.2, 5.0, 0.2);

TEST(MapProjection, IsZeroAtTheTruePose) {
  JudgedImage image = lookDown();
  image.observed.push_back(seen(image, kLine));
  const auto distance = mapProjectionDistance(image, {kLine});
  ASSERT_TRUE(distance);
  EXPECT_NEAR(distance->detected_to_map_px, 0.0, 1e-9);
  EXPECT_NEAR(distance->map_to_detected_px, 0.0, 1e-9);
}

TEST(MapProjection, AShiftOfFiveCentimetresIsFivePixelsHere) {
  JudgedImage image = lookDown();
  image.observed.push_back(seen(image, kLine));
  image.T_world_robot = Pose2{0.0, 0.05, 0.0};
  const auto distance = mapProjectionDistance(image, {kLine});
  ASSERT_TRUE(distance);
  EXPECT_NEAR(distance->detected_to_map_px, 5.0, 1e-6);
  EXPECT_NEAR(distance->map_to_detected_px, 5.0, 1e-6);
}

TEST(MapProjection, AnUndetectedLineRaisesOnlyTheOtherDirection) {
  // The second line, 100 px beside the first, was not detected: half the map's points lie 100 px away.
  JudgedImage image = lookDown();
  image.observed.push_back(seen(image, kLine));
  const MapSegment other = edge(-5.0, -0.8, 5.0, -0.8);
  const auto distance = mapProjectionDistance(image, {kLine, other});
  ASSERT_TRUE(distance);
  EXPECT_NEAR(distance->detected_to_map_px, 0.0, 1e-9);
  EXPECT_NEAR(distance->map_to_detected_px, 50.0, 1e-6) << "the two middle values are 0 and 100";
}

TEST(MapProjection, OtherLabelsSayNothing) {
  JudgedImage image = lookDown();
  ImageSegment door = seen(image, kLine);
  door.label = "door";
  image.observed.push_back(door);
  EXPECT_FALSE(mapProjectionDistance(image, {kLine}));
}

TEST(MapProjection, AMissingPoseCountsAsTheDiagonal) {
  JudgedImage image = lookDown();
  image.observed.push_back(seen(image, kLine));
  image.T_world_robot.reset();
  EXPECT_DOUBLE_EQ(mapProjectionDistance(image, {kLine})->detected_to_map_px, 400.0);
  image.T_world_robot = Pose2{100.0, 100.0, 0.0};
  EXPECT_DOUBLE_EQ(mapProjectionDistance(image, {kLine})->detected_to_map_px, 400.0)
      << "nothing projects there";
}

TEST(MapProjection, FloorBeyondTheRangeSaysNothing) {
  // A camera at 0.5 m that looks 10 degrees down; a line across at 6 m, range 4 m.
  JudgedImage image = lookDown();
  image.T_robot_camera =
      cameraPose({poseFromXyzRpy(0, 0, 0.5, 0, 0, 0), Pose3::Identity()}, 0.0, degToRad(-10.0));
  const MapSegment far = edge(6.0, -3.0, 6.0, 3.0);
  image.observed.push_back(seen(image, far));
  EXPECT_FALSE(mapProjectionDistance(image, {far}));
  EXPECT_TRUE(mapProjectionDistance(image, {far}, {.max_range_m = 8.0, .step_px = 4.0}));
}

TEST(MapProjection, ScoresTheMedianOfTheImagesAndCountsTheRest) {
  std::vector<JudgedImage> images;
  for (const double shift : {0.01, 0.02, 0.06}) {
    JudgedImage image = lookDown();
    image.observed.push_back(seen(image, kLine));
    image.T_world_robot = Pose2{0.0, shift, 0.0};
    images.push_back(image);
  }
  images.push_back(lookDown());  // no lines
  SegmentMap map;
  map.segments.push_back(kLine);
  const MapProjectionScore score = scoreMapProjection(images, map);
  EXPECT_EQ(score.images, 3);
  EXPECT_EQ(score.images_without_lines, 1);
  EXPECT_NEAR(score.detected_to_map_px.value(), 2.0, 1e-6);

  images[0].T_world_robot.reset();
  images[1].T_world_robot.reset();
  const MapProjectionScore lost = scoreMapProjection(images, map);
  EXPECT_EQ(lost.images_without_pose, 2);
  EXPECT_DOUBLE_EQ(lost.detected_to_map_px.value(), 400.0) << "two of three have no pose";
}

TEST(CarriedPose, FollowsOdometryFromTheNewestEstimate) {
  PoseEstimate estimate;
  estimate.stamp_us = kSecondUs;
  estimate.T_world_robot = Pose2{2.0, 3.0, degToRad(90.0)};
  estimate.T_odom_robot = Pose2{10.0, 0.0, 0.0};
  // Half a metre forward in odometry is half a metre along world's y.
  const auto pose = carriedPose({estimate}, kSecondUs + 200'000, Pose2{10.5, 0.0, 0.0});
  ASSERT_TRUE(pose);
  EXPECT_NEAR(pose->x, 2.0, 1e-12);
  EXPECT_NEAR(pose->y, 3.5, 1e-12);
  EXPECT_FALSE(carriedPose({estimate}, kSecondUs - 1, Pose2{}));
  EXPECT_FALSE(carriedPose({estimate}, 3 * kSecondUs, Pose2{})) << "too old";
}

}  // namespace
}  // namespace vismem
