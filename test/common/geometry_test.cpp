// Units of common/geometry: angles, poses, segments, camera, projection.
// Tests G1, G2.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "common/geometry/angles.h"
#include "common/geometry/camera.h"
#include "common/geometry/plane.h"
#include "common/geometry/pose.h"
#include "common/geometry/projection.h"
#include "common/geometry/rounding.h"
#include "common/geometry/segment.h"

namespace vismem {
namespace {

constexpr double kPi = std::numbers::pi;

CameraIntrinsics testCamera() {
  return intrinsicsFromFieldOfView(320, 240, degToRad(60));
}

CameraMount mountAt(double height_m) {
  CameraMount mount;
  mount.T_robot_pantilt = poseFromXyzRpy(0.1, 0.0, height_m, 0, 0, 0);
  return mount;
}

TEST(Rounding, ZeroHasNoSign) {
  EXPECT_EQ(rounded(1.2345, 1e3), 1.235);
  EXPECT_EQ(rounded(-0.5, 1), -1.0);
  EXPECT_FALSE(std::signbit(rounded(-0.004, 100)));
}

TEST(Angles, WrapsIntoHalfOpenInterval) {
  EXPECT_NEAR(wrapAngle(3 * kPi), kPi, 1e-12);
  EXPECT_NEAR(wrapAngle(-kPi), kPi, 1e-12);
  EXPECT_NEAR(wrapAngle(-0.5), -0.5, 1e-12);
  EXPECT_NEAR(wrapAngle(2 * kPi + 0.25), 0.25, 1e-12);
}

/// The reference: std::remainder, whatever the angle.
void expectRemainders(double a, double b) {
  const double turn = std::remainder(a - b, 2 * kPi);
  EXPECT_EQ(angleDifference(a, b), turn <= -kPi ? kPi : turn) << a << " - " << b;
  EXPECT_EQ(lineAngleDifference(a, b), std::abs(std::remainder(a - b, kPi))) << a << " - " << b;
}

TEST(Angles, WrapExactlyAsRemaindersDo) {
  std::mt19937_64 engine(1);
  std::uniform_real_distribution<double> angle(-12.0, 12.0);
  for (int i = 0; i < 10'000; ++i) expectRemainders(angle(engine), angle(engine));
  for (int quarter = -8; quarter <= 8; ++quarter) {
    const double edge = 0.5 * kPi * quarter;
    expectRemainders(edge, 0.0);
    expectRemainders(std::nextafter(edge, -100.0), 0.0);
    expectRemainders(std::nextafter(edge, 100.0), 0.0);
  }
}

TEST(Angles, CircularMeanCrossesTheWrap) {
  const double angles[] = {degToRad(170), degToRad(-170)};
  EXPECT_NEAR(std::abs(circularMean(angles)), kPi, 1e-9);
}

TEST(Angles, LineDifferenceIgnoresDirection) {
  EXPECT_NEAR(lineAngleDifference(0.1, 0.1 + kPi), 0.0, 1e-12);
  EXPECT_NEAR(lineAngleDifference(degToRad(10), degToRad(-170)), 0.0, 1e-12);
  EXPECT_NEAR(lineAngleDifference(0.0, degToRad(135)), degToRad(45), 1e-12);
}

TEST(Pose, ComposesWithItsInverseToIdentity) {
  const Pose2 pose{1.0, -2.0, 2.5};
  const Pose2 identity = inverse(pose) * pose;
  EXPECT_NEAR(identity.x, 0.0, 1e-12);
  EXPECT_NEAR(identity.y, 0.0, 1e-12);
  EXPECT_NEAR(identity.theta, 0.0, 1e-12);
}

TEST(Pose, PlanarAndSpatialFormsAgree) {
  const Pose2 a{1.0, 2.0, 0.7};
  const Pose2 b{-0.5, 0.25, -2.9};
  const Pose2 planar = a * b;
  const Pose2 spatial = toPose2(toPose3(a) * toPose3(b));
  EXPECT_NEAR(planar.x, spatial.x, 1e-12);
  EXPECT_NEAR(planar.y, spatial.y, 1e-12);
  EXPECT_NEAR(angleDifference(planar.theta, spatial.theta), 0.0, 1e-12);
}

TEST(Plane, TheQuarterTurnIsCounterClockwiseAndKeepsTheLength) {
  EXPECT_EQ(turned90(Eigen::Vector2d(1, 0)), Eigen::Vector2d(0, 1));
  EXPECT_EQ(turned90(Eigen::Vector2d(0, 2)), Eigen::Vector2d(-2, 0));
}

TEST(Plane, TheCrossProductIsPositiveToTheLeftAndTheAreaOfTheParallelogram) {
  const Eigen::Vector2d a(2, 1);
  EXPECT_EQ(cross2(a, turned90(a)), a.squaredNorm());
  EXPECT_EQ(cross2(a, -turned90(a)), -a.squaredNorm());
  EXPECT_EQ(cross2(a, 3.0 * a), 0.0);
  EXPECT_EQ(cross2({3, 0}, {5, 4}), 12.0);
}

TEST(Segment, ClipsToBoxAndKeepsDirection) {
  // From (-1, 1) to (3, 1) through the unit-2 box: x from 0 to 2.
  const auto clipped = clipToBox({{-1, 1}, {3, 1}}, {0, 0}, {2, 2});
  ASSERT_TRUE(clipped);
  EXPECT_NEAR(clipped->a.x(), 0.0, 1e-12);
  EXPECT_NEAR(clipped->b.x(), 2.0, 1e-12);
  EXPECT_FALSE(clipToBox({{-1, 3}, {3, 3}}, {0, 0}, {2, 2}));
}

TEST(Segment, ClipsToADisc) {
  // The line y = 3 meets a circle of 5 about the origin at x = -4 and x = 4.
  const auto inside = clipToDisc({{-10.0, 3.0}, {10.0, 3.0}}, {0.0, 0.0}, 5.0);
  ASSERT_TRUE(inside);
  EXPECT_NEAR(inside->first, 0.3, 1e-12);
  EXPECT_NEAR(inside->second, 0.7, 1e-12);
  EXPECT_NEAR(clipToDisc({{0.0, 3.0}, {10.0, 3.0}}, {0.0, 0.0}, 5.0)->first, 0.0, 1e-12) << "begins inside";
  EXPECT_FALSE(clipToDisc({{5.0, 3.0}, {10.0, 3.0}}, {0.0, 0.0}, 5.0));
  EXPECT_FALSE(clipToDisc({{-10.0, 6.0}, {10.0, 6.0}}, {0.0, 0.0}, 5.0));
  EXPECT_EQ(clipToDisc({{1.0, 1.0}, {1.0, 1.0}}, {0.0, 0.0}, 5.0), std::pair(0.0, 1.0)) << "a point";
  EXPECT_FALSE(clipToDisc({{6.0, 1.0}, {6.0, 1.0}}, {0.0, 0.0}, 5.0));
}

TEST(Segment, DistancesToSegmentAndLineDifferBeyondTheEnds) {
  const Segment2 segment{{0, 0}, {1, 0}};
  EXPECT_NEAR(distanceToSegment(Eigen::Vector2d(4, 4), segment), 5.0, 1e-12);  // 3-4-5 from (1, 0)
  EXPECT_NEAR(distanceToLine({4, 4}, segment), 4.0, 1e-12);
}

TEST(Camera, LooksAlongRobotXAtZeroPanAndTilt) {
  const Pose3 T = cameraPose(mountAt(0.45), 0.0, 0.0);
  EXPECT_TRUE(T.linear().col(2).isApprox(Eigen::Vector3d::UnitX(), 1e-12));
  EXPECT_TRUE(T.linear().col(0).isApprox(-Eigen::Vector3d::UnitY(), 1e-12));
}

TEST(Camera, PositivePanLooksLeftAndPositiveTiltUp) {
  const Pose3 T = cameraPose(mountAt(0.45), degToRad(90), degToRad(30));
  const Eigen::Vector3d axis = T.linear().col(2);
  EXPECT_NEAR(axis.y(), std::cos(degToRad(30)), 1e-12);
  EXPECT_NEAR(axis.z(), std::sin(degToRad(30)), 1e-12);
}

TEST(Camera, PanTiltTowardsCentresThePoint) {
  const CameraMount mount = mountAt(0.45);
  const Eigen::Vector3d p(1.0, 0.8, 0.0);
  const PanTilt angles = panTiltTowards(mount, p);
  const Eigen::Vector3d p_camera = cameraPose(mount, angles.pan_rad, angles.tilt_rad).inverse() * p;
  const auto px = projectToIdeal(testCamera(), p_camera);
  ASSERT_TRUE(px);
  EXPECT_NEAR(px->x(), 159.5, 1e-9);
  EXPECT_NEAR(px->y(), 119.5, 1e-9);
}

TEST(Camera, FieldOfViewSpansTheImageBorders) {
  // The ray through the right border (319.5) makes 30 degrees with the axis.
  const Eigen::Vector3d ray = idealPixelRay(testCamera(), {319.5, 119.5});
  EXPECT_NEAR(std::atan(ray.x()), degToRad(30), 1e-12);
}

TEST(CameraProperty, UndistortionInvertsDistortion) {
  CameraIntrinsics camera = testCamera();
  camera.k1 = -0.28;
  camera.k2 = 0.09;
  camera.p1 = 0.001;
  camera.p2 = -0.0007;
  std::mt19937_64 engine(7);
  std::uniform_real_distribution<double> u(0, 319);
  std::uniform_real_distribution<double> v(0, 239);
  for (int i = 0; i < 500; ++i) {
    const Eigen::Vector2d raw(u(engine), v(engine));
    EXPECT_LT((distortPixel(camera, undistortPixel(camera, raw)) - raw).norm(), 1e-5) << raw.transpose();
  }
}

// Lenses near what the model can do at all: a fixed-point iteration creeps or oscillates there.
TEST(CameraProperty, UndistortionInvertsStrongDistortionOverTheWholeImage) {
  struct Lens {
    const char* name;
    double fov_deg, k1, k2, p1, p2, k3;
  };
  for (const Lens& lens :
       {Lens{"barrel", 90, -0.19, 0.02, 0.002, -0.001, 0.0}, Lens{"wide", 110, -0.14, 0.012, 0, 0, 0},
        Lens{"narrow barrel", 60, -0.55, 0.2, 0, 0, 0}, Lens{"pincushion", 80, 0.6, 0.3, 0.01, 0.01, 0.1},
        Lens{"moustache", 80, -0.4, 0.4, 0, 0, -0.1}, Lens{"tangential", 70, 0, 0, 0.05, -0.04, 0}}) {
    CameraIntrinsics camera = intrinsicsFromFieldOfView(320, 240, degToRad(lens.fov_deg));
    camera.k1 = lens.k1;
    camera.k2 = lens.k2;
    camera.p1 = lens.p1;
    camera.p2 = lens.p2;
    camera.k3 = lens.k3;
    for (double v = 0; v < 240; v += 7) {
      for (double u = 0; u < 320; u += 7) {
        const Eigen::Vector2d ideal(u, v);
        const Eigen::Vector2d found = undistortPixel(camera, distortPixel(camera, ideal));
        EXPECT_LT((found - ideal).norm(), 1e-5) << lens.name << " at " << ideal.transpose();
      }
    }
  }
}

// Beyond the fold of a lens there is no answer; what comes back is finite and no worse than the pixel itself.
TEST(CameraProperty, UndistortionStaysFiniteWhereThereIsNoInverse) {
  CameraIntrinsics camera = intrinsicsFromFieldOfView(320, 240, degToRad(100));
  camera.k1 = -0.6;
  for (double v = -50; v < 290; v += 10) {
    for (double u = -50; u < 370; u += 10) {
      const Eigen::Vector2d raw(u, v);
      const Eigen::Vector2d found = undistortPixel(camera, raw);
      ASSERT_TRUE(found.allFinite());
      EXPECT_LE((distortPixel(camera, found) - raw).norm(), (distortPixel(camera, raw) - raw).norm() + 1e-9);
    }
  }
}

TEST(Camera, ReportsUnusableIntrinsics) {
  CameraIntrinsics camera = testCamera();
  camera.fx = -1;
  EXPECT_THAT(checkIntrinsics(camera), testing::StartsWith("focal length"));
  EXPECT_EQ(checkIntrinsics(testCamera()), "");
}

TEST(ProjectionProperty, BackProjectionInvertsProjectionOnTheFloor) {
  std::mt19937_64 engine(11);
  std::uniform_real_distribution<double> pan(-2.7, 2.7);
  std::uniform_real_distribution<double> tilt(-0.54, -0.1);
  std::uniform_real_distribution<double> u(0, 319);
  std::uniform_real_distribution<double> v(0, 239);
  int checked = 0;
  for (int i = 0; i < 1000; ++i) {
    const Pose3 T = toPose3({1.0, -2.0, 0.3}) * cameraPose(mountAt(0.45), pan(engine), tilt(engine));
    const Eigen::Vector2d px(u(engine), v(engine));
    const auto p = backProjectToGround(testCamera(), T, px, 20.0);
    if (!p) continue;
    const auto back = projectToIdeal(testCamera(), T.inverse() * *p);
    ASSERT_TRUE(back);
    EXPECT_LT((*back - px).norm(), 1e-6);
    ++checked;
  }
  EXPECT_GT(checked, 500);
}

TEST(Projection, ReturnsEmptyAboveTheHorizon) {
  const Pose3 T = cameraPose(mountAt(0.45), 0.0, 0.0);
  EXPECT_FALSE(backProjectToGround(testCamera(), T, {160, 100}, 100.0));
  EXPECT_TRUE(backProjectToGround(testCamera(), T, {160, 200}, 100.0));
}

TEST(Projection, HorizonSeparatesFloorFromSky) {
  const Pose3 T = cameraPose(mountAt(0.45), 0.4, degToRad(-10));
  const HorizonLine horizon = horizonLine(testCamera(), T);
  // Looking 10 degrees down, the horizon lies f tan(10 deg) = 277.13 * 0.17633 = 48.87 px above the centre.
  EXPECT_NEAR(horizon.signedDistance({159.5, 119.5}), 48.87, 0.01);
  EXPECT_LT(horizon.signedDistance({159.5, 60.0}), 0.0);
}

TEST(Projection, ClipsAtTheNearPlaneAndTheBorder) {
  const Pose3 T = cameraPose(mountAt(0.45), 0.0, degToRad(-20));
  // A line along x from behind the robot to 3 m ahead: only the part in view remains.
  const auto px = projectSegment(testCamera(), T, {{-2.0, 0.0, 0.0}, {3.0, 0.0, 0.0}});
  ASSERT_TRUE(px);
  EXPECT_NEAR(px->a.x(), 159.5, 1e-9);
  EXPECT_NEAR(px->a.y(), 239.5, 1e-9);
  EXPECT_FALSE(projectSegment(testCamera(), T, {{-2.0, 0.0, 0.0}, {-1.0, 0.0, 0.0}}));
}

TEST(PanTilt, AngleBetweenDirectionsOfAHead) {
  EXPECT_NEAR(angleBetween({0.3, 0.0}, {-0.2, 0.0}), 0.5, 1e-12);
  EXPECT_NEAR(angleBetween({1.0, 0.4}, {1.0, -0.1}), 0.5, 1e-12);
  // Looking straight up, pan turns about the axis of view.
  EXPECT_NEAR(angleBetween({0.0, 0.5 * std::numbers::pi}, {2.0, 0.5 * std::numbers::pi}), 0.0, 1e-7);
  EXPECT_NEAR(angleBetween({0.0, 0.0}, {std::numbers::pi, 0.0}), std::numbers::pi, 1e-7);
}

}  // namespace
}  // namespace vismem
