// Tests M1.
#include "active_visual_memory/core/ground/ground_projector.h"

#include <gtest/gtest.h>

#include <random>

#include "common/geometry/angles.h"
#include "common/geometry/projection.h"

namespace vismem {
namespace {

// 60 degrees over 320 px: f = 160 / tan 30 = 277.13 px. Camera 0.45 m up, 20 degrees down.
CameraIntrinsics camera() {
  return intrinsicsFromFieldOfView(320, 240, degToRad(60.0));
}
Pose3 pose(double tilt_deg = -20.0) {
  CameraMount mount;
  mount.T_robot_pantilt = poseFromXyzRpy(0, 0, 0.45, 0, 0, 0);
  return cameraPose(mount, 0.0, degToRad(tilt_deg));
}
ImageSegment imageOf(const Segment3& s, const Pose3& T) {
  return {*projectSegment(camera(), T, s), "edge", 40.0};
}

TEST(GroundProjector, PlacesASegmentWhereItLies) {
  const Segment3 truth{{1.0, 0.3, 0.0}, {1.4, -0.2, 0.0}};
  const auto floor = GroundProjector({}).project(camera(), pose(), {imageOf(truth, pose())});
  ASSERT_EQ(floor.size(), 1u);
  EXPECT_NEAR((floor[0].a.p - truth.a.head<2>()).norm(), 0.0, 1e-9);
  EXPECT_NEAR((floor[0].b.p - truth.b.head<2>()).norm(), 0.0, 1e-9);
  EXPECT_FALSE(floor[0].a.censored);
  EXPECT_FALSE(floor[0].b.censored);
  EXPECT_EQ(floor[0].observed, 0);
}

TEST(GroundProjector, EndsAtTheImageBorderAreCensored) {
  const Segment3 wide{{1.0, 5.0, 0.0}, {1.0, -0.2, 0.0}};
  const auto floor = GroundProjector({}).project(camera(), pose(), {imageOf(wide, pose())});
  ASSERT_EQ(floor.size(), 1u);
  EXPECT_TRUE(floor[0].a.censored);
  EXPECT_FALSE(floor[0].b.censored);
}

TEST(GroundProjector, MovesEndsToWhereTheyAreButForThoseAtTheBorder) {
  const Segment3 truth{{1.0, 0.3, 0.0}, {1.4, -0.2, 0.0}};
  ImageSegment found = imageOf(truth, pose());
  const Eigen::Vector2d along = (found.px.b - found.px.a).normalized();
  found.px = {found.px.a + 0.8 * along, found.px.b - 0.8 * along};
  GroundProjector::Params params;
  params.end_short_px = 0.8;
  const auto floor = GroundProjector(params).project(camera(), pose(), {found});
  ASSERT_EQ(floor.size(), 1u);
  EXPECT_NEAR((floor[0].a.p - truth.a.head<2>()).norm(), 0.0, 1e-9);
  EXPECT_NEAR((floor[0].b.p - truth.b.head<2>()).norm(), 0.0, 1e-9);
  // What the border cut ends nowhere near.
  const ImageSegment cut = imageOf({{1.0, 5.0, 0.0}, {1.0, -0.2, 0.0}}, pose());
  const auto plain = GroundProjector({}).project(camera(), pose(), {cut});
  const auto moved = GroundProjector(params).project(camera(), pose(), {cut});
  ASSERT_EQ(moved.size(), 1u);
  EXPECT_NEAR((moved[0].a.p - plain[0].a.p).norm(), 0.0, 1e-9);
}

TEST(GroundProjector, CutsAtTheMaximumRange) {
  const Segment3 away{{1.0, 0.0, 0.0}, {9.0, 0.0, 0.0}};
  GroundProjector::Params params;
  params.max_range_m = 3.0;
  const auto floor = GroundProjector(params).project(camera(), pose(), {imageOf(away, pose())});
  ASSERT_EQ(floor.size(), 1u);
  EXPECT_NEAR(floor[0].b.p.x(), 3.0, 1e-6);
  EXPECT_TRUE(floor[0].b.censored);
  EXPECT_FALSE(floor[0].a.censored);
}

TEST(GroundProjector, CutsWhatIsFoundToLieBeyondTheRange) {
  // From (1, 0): 3 m ahead is x = 4; the derivatives of an end go with its place.
  FloorSegment segment;
  segment.place({{2.0, 0.0}, {6.0, 0.0}});
  segment.b.D = TiltJacobian::Constant(8.0);
  ASSERT_TRUE(cutToRange(segment, {1.0, 0.0}, 3.0));
  EXPECT_NEAR((segment.b.p - Eigen::Vector2d(4.0, 0.0)).norm(), 0.0, 1e-12);
  EXPECT_NEAR(segment.b.D(0, 0), 4.0, 1e-12);
  EXPECT_TRUE(segment.b.censored);
  EXPECT_FALSE(segment.a.censored);
  EXPECT_EQ(segment.a.p.x(), 2.0);
  segment.place({{5.0, 0.0}, {6.0, 0.0}});
  EXPECT_FALSE(cutToRange(segment, {1.0, 0.0}, 3.0));
  EXPECT_EQ(segment.b.p.x(), 6.0) << "left as it is";
}

TEST(GroundProjector, DropsWhatIsAboveTheHorizonAndClipsWhatCrossesIt) {
  // Level camera: the horizon is the image's middle row, 119.5.
  const ImageSegment above{{{50, 20}, {150, 60}}, "edge", 40.0};
  const ImageSegment crossing{{{150, 60}, {160, 230}}, "edge", 40.0};
  const auto floor = GroundProjector({}).project(camera(), pose(0.0), {above, crossing});
  ASSERT_EQ(floor.size(), 1u);
  EXPECT_EQ(floor[0].observed, 1);
  EXPECT_TRUE(floor[0].a.censored);
  EXPECT_LE(floor[0].a.p.norm(), 4.0 + 1e-9);
}

TEST(GroundProjector, CovarianceIsThatOfNoisyPixels) {
  // With pixel noise only, the spread of back-projected points must be what the covariance says.
  GroundProjector::Params params;
  params.pitch_sigma_rad = 0.0;
  params.along_sigma_px = 1.0;
  params.across_sigma_px = 0.4;
  const Eigen::Vector2d px{200, 150};
  const Eigen::Vector2d along = Eigen::Vector2d(3, 1).normalized();
  const Eigen::Vector2d across{-along.y(), along.x()};
  const auto P = GroundProjector(params).floorCovariance(camera(), pose(), px, along, 0.0);
  ASSERT_TRUE(P);
  std::mt19937_64 random(3);
  std::normal_distribution<double> gauss;
  const Eigen::Vector2d mean = backProjectToGround(camera(), pose(), px, 100.0)->head<2>();
  Eigen::Matrix2d sum = Eigen::Matrix2d::Zero();
  const int n = 20000;
  for (int i = 0; i < n; ++i) {
    const Eigen::Vector2d noisy = px + gauss(random) * along + 0.4 * gauss(random) * across;
    const Eigen::Vector2d d = backProjectToGround(camera(), pose(), noisy, 100.0)->head<2>() - mean;
    sum += d * d.transpose();
  }
  // 20000 samples know a variance to 1 %; the linearisation adds little at 1 px.
  EXPECT_NEAR(((sum / n - *P).norm()) / P->norm(), 0.0, 0.05);
}

TEST(GroundProjector, UncertaintyGrowsWithRangeAndTurnRate) {
  const GroundProjector projector({});
  const Eigen::Vector2d u = Eigen::Vector2d::UnitX();
  const auto near = projector.floorCovariance(camera(), pose(), {160, 200}, u, 0.0);
  const auto far = projector.floorCovariance(camera(), pose(), {160, 60}, u, 0.0);
  const auto turning = projector.floorCovariance(camera(), pose(), {160, 60}, u, 2.0);
  EXPECT_GT(far->trace(), 4.0 * near->trace());
  EXPECT_GT(turning->trace(), far->trace());
}

}  // namespace
}  // namespace vismem
