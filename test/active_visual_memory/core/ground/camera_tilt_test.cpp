// Tests M1.
#include "active_visual_memory/core/ground/camera_tilt.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <vector>

#include "active_visual_memory/core/ground/floor_line.h"
#include "active_visual_memory/core/ground/ground_projector.h"
#include "active_visual_memory/core/tilted_camera.h"
#include "common/geometry/angles.h"
#include "common/geometry/projection.h"

namespace vismem {
namespace {

const CameraTilt kTilt{0.006, -0.009, 0.008, -0.005};

TEST(CameraTilt, TurnsTheCameraAboutItsOwnCentre) {
  const Pose3 T = cameraPose(mount(), 0.7, -0.3);
  EXPECT_TRUE(tilted(T, CameraTilt::Zero()).isApprox(T));
  const Pose3 there = tilted(T, kTilt);
  EXPECT_EQ(there.translation(), T.translation());
  // Looking ahead, a camera that sits 0.01 rad too high on its head looks up by as much.
  const Pose3 ahead = tilted(cameraPose(mount(), 0.0, 0.0), {0.0, 0.0, 0.01, 0.0});
  EXPECT_NEAR(ahead.linear().col(2).z(), std::sin(0.01), 1e-12);
  // A robot that pitches forward (about its y axis, to the left) looks down, and a camera that looks left
  // rolls.
  EXPECT_NEAR(tilted(cameraPose(mount(), 0.0, 0.0), {0.0, 0.01, 0.0, 0.0}).linear().col(2).z(),
              -std::sin(0.01), 1e-12);
  EXPECT_NEAR(tilted(cameraPose(mount(), degToRad(90.0), 0.0), {0.0, 0.01, 0.0, 0.0}).linear().col(2).z(),
              0.0, 1e-12);
}

TEST(CameraTilt, DerivativesAreThoseOfTheProjection) {
  const auto k = intrinsicsFromFieldOfView(320, 240, degToRad(60.0));
  const Pose2 robot{1.0, -2.0, 0.8};
  for (const double pan : {-1.2, 0.0, 0.6}) {
    const Pose3 T_robot_camera = cameraPose(mount(), pan, -0.3);
    const Pose3 T = toPose3(robot) * T_robot_camera;
    const TiltView view(T, robot.theta);
    for (const Eigen::Vector2d& px :
         {Eigen::Vector2d(20, 150), Eigen::Vector2d(160, 120), Eigen::Vector2d(300, 200)}) {
      const Eigen::Vector2d p = backProjectToGround(k, T, px, 100.0)->head<2>();
      const TiltJacobian D = view.derivativeAt(p);
      for (int i = 0; i < 4; ++i) {
        const double step = 1e-5;
        const Pose3 turned = toPose3(robot) * tilted(T_robot_camera, step * CameraTilt::Unit(i));
        const Eigen::Vector2d q = backProjectToGround(k, turned, px, 100.0)->head<2>();
        EXPECT_NEAR(((q - p) / step - D.col(i)).norm(), 0.0, 1e-3 * (1.0 + D.col(i).norm())) << i;
        // And a place is carried there exactly.
        const Eigen::Matrix3d R = turned.linear() * T.linear().transpose();
        EXPECT_NEAR((reprojectOnFloor(p, T.translation(), R) - q).norm(), 0.0, 1e-9);
      }
    }
  }
}

TEST(CameraTilt, ALineSeenFromManyPlacesFollowsALaterTiltEstimate) {
  // The same images under a wrong and the right camera tilt; the wrong line, corrected by the change of the
  // tilt, is the right line.
  const auto k = intrinsicsFromFieldOfView(320, 240, degToRad(60.0));
  const CameraTilt camera_tilt = 0.3 * kTilt;
  GroundProjector::Params exact;
  exact.border_margin_px = 0.0;
  const GroundProjector projector(exact);
  const FloorLine::Params params;
  const Segment3 edge{{2.2, -0.3, 0.0}, {2.5, 0.4, 0.0}};
  std::optional<FloorLine> wrong;
  std::optional<FloorLine> right;
  for (int i = 0; i < 12; ++i) {
    const Pose2 robot{0.06 * i, 0.02 * i, 0.03 * i};
    const Pose3 T_robot_camera = cameraPose(mount(), -0.02 * i, -0.25);
    const Pose3 believed = toPose3(robot) * T_robot_camera;
    const Pose3 truth = toPose3(robot) * tilted(T_robot_camera, camera_tilt);
    const auto px = projectSegment(k, truth, edge);
    ASSERT_TRUE(px);
    const auto take = [&](std::optional<FloorLine>& line, const Pose3& T) {
      const auto floor = projector.project(k, T, {{*px, "edge", 40.0}}, 0.0, robot.theta);
      ASSERT_EQ(floor.size(), 1u);
      if (line) {
        line->fuse(floor.front(), params);
      } else {
        line = FloorLine(floor.front(), params);
      }
    };
    take(wrong, believed);
    take(right, truth);
  }
  const auto off = [&](const FloorLine& line) {
    const Segment2 s = line.segment();
    return std::max((s.a - edge.a.head<2>()).norm(), (s.b - edge.b.head<2>()).norm());
  };
  EXPECT_LT(off(*right), 1e-6);
  const double before = off(*wrong);
  EXPECT_GT(before, 0.03);
  wrong->applyTiltChange(camera_tilt);
  EXPECT_LT(off(*wrong), 0.1 * before);  // second order remains
}

TEST(CameraTilt, ItsCovarianceWidensTheGate) {
  FloorSegment seen;
  seen.place({{2.0, -0.5}, {2.0, 0.5}});
  seen.a.P = seen.b.P = 1e-4 * Eigen::Matrix2d::Identity();
  const FloorLine line(seen, {});
  FloorSegment again = seen;
  again.a.p.x() = again.b.p.x() = 2.1;
  again.a.D(0, 2) = again.b.D(0, 2) = 10.0;  // seen from where the camera tilt matters
  CameraTiltCovariance P = CameraTiltCovariance::Zero();
  EXPECT_GT(line.disagreement(again, 0.0, P), 9.0);
  P(2, 2) = std::pow(degToRad(0.5), 2);  // 8.7 cm
  EXPECT_LT(line.disagreement(again, 0.0, P), 2.0);
  // Both seen alike: a camera tilt would have moved both.
  FloorSegment first = seen;
  first.a.D = again.a.D;
  first.b.D = again.b.D;
  EXPECT_GT(FloorLine(first, {}).disagreement(again, 0.0, P), 9.0);
}

}  // namespace
}  // namespace vismem
