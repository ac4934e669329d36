#include "active_visual_memory/core/camera_lean.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <optional>
#include <random>
#include <vector>

#include "active_visual_memory/core/drift_residuals.h"
#include "active_visual_memory/core/floor_line.h"
#include "active_visual_memory/core/floor_matching.h"
#include "active_visual_memory/core/ground_projector.h"
#include "common/geometry/angles.h"
#include "common/geometry/projection.h"
#include "common/kinematics/kinematics.h"

namespace vismem {
namespace {

CameraMount mount() {
  CameraMount m;
  m.T_robot_pantilt = poseFromXyzRpy(0.05, 0, 0.45, 0, 0, 0);
  return m;
}

const Lean kLean{0.006, -0.009, 0.008, -0.005};

TEST(CameraLean, TurnsTheCameraAboutItsOwnCentre) {
  const Pose3 T = cameraPose(mount(), 0.7, -0.3);
  EXPECT_TRUE(leaned(T, Lean::Zero()).isApprox(T));
  const Pose3 there = leaned(T, kLean);
  EXPECT_EQ(there.translation(), T.translation());
  // Looking ahead, a camera that sits 0.01 rad too high on its head looks up by as much.
  const Pose3 ahead = leaned(cameraPose(mount(), 0.0, 0.0), {0.0, 0.0, 0.01, 0.0});
  EXPECT_NEAR(ahead.linear().col(2).z(), std::sin(0.01), 1e-12);
  // A robot that leans forward (about its y axis, to the left) looks down, and a camera that looks left
  // rolls.
  EXPECT_NEAR(leaned(cameraPose(mount(), 0.0, 0.0), {0.0, 0.01, 0.0, 0.0}).linear().col(2).z(),
              -std::sin(0.01), 1e-12);
  EXPECT_NEAR(leaned(cameraPose(mount(), degToRad(90.0), 0.0), {0.0, 0.01, 0.0, 0.0}).linear().col(2).z(),
              0.0, 1e-12);
}

TEST(CameraLean, DerivativesAreThoseOfTheProjection) {
  const auto k = intrinsicsFromFieldOfView(320, 240, degToRad(60.0));
  const Pose2 robot{1.0, -2.0, 0.8};
  for (const double pan : {-1.2, 0.0, 0.6}) {
    const Pose3 T_robot_camera = cameraPose(mount(), pan, -0.3);
    const Pose3 T = toPose3(robot) * T_robot_camera;
    const LeaningView view(T, robot.theta);
    for (const Eigen::Vector2d& px :
         {Eigen::Vector2d(20, 150), Eigen::Vector2d(160, 120), Eigen::Vector2d(300, 200)}) {
      const Eigen::Vector2d p = backProjectToGround(k, T, px, 100.0)->head<2>();
      const FloorLean D = view.derivativeAt(p);
      for (int i = 0; i < 4; ++i) {
        const double step = 1e-5;
        const Pose3 turned = toPose3(robot) * leaned(T_robot_camera, step * Lean::Unit(i));
        const Eigen::Vector2d q = backProjectToGround(k, turned, px, 100.0)->head<2>();
        EXPECT_NEAR(((q - p) / step - D.col(i)).norm(), 0.0, 1e-3 * (1.0 + D.col(i).norm())) << i;
        // And a place is carried there exactly.
        const Eigen::Matrix3d R = turned.linear() * T.linear().transpose();
        EXPECT_NEAR((turnedOnFloor(p, T.translation(), R) - q).norm(), 0.0, 1e-9);
      }
    }
  }
}

TEST(CameraLean, ALineSeenFromManyPlacesIsCorrectedAsIfTheLeanHadBeenKnown) {
  // The same images under a wrong and the right lean; the wrong line, told of the right lean, is the right
  // line.
  const auto k = intrinsicsFromFieldOfView(320, 240, degToRad(60.0));
  const Lean lean = 0.3 * kLean;
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
    const Pose3 truth = toPose3(robot) * leaned(T_robot_camera, lean);
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
  wrong->lean(lean);
  EXPECT_LT(off(*wrong), 0.1 * before);  // second order remains
}

TEST(CameraLean, WhatIsNotKnownOfTheLeanOpensTheGate) {
  FloorSegment seen;
  seen.odom = {{2.0, -0.5}, {2.0, 0.5}};
  seen.P_a = seen.P_b = 1e-4 * Eigen::Matrix2d::Identity();
  const FloorLine line(seen, {});
  FloorSegment again = seen;
  again.odom.a.x() = again.odom.b.x() = 2.1;
  again.D_a(0, 2) = again.D_b(0, 2) = 10.0;  // seen from where the lean matters
  LeanCovariance P = LeanCovariance::Zero();
  EXPECT_GT(line.disagreement(again, 0.0, P), 9.0);
  P(2, 2) = std::pow(degToRad(0.5), 2);  // 8.7 cm
  EXPECT_LT(line.disagreement(again, 0.0, P), 2.0);
  // Both seen alike: a lean would have moved both.
  FloorSegment first = seen;
  first.D_a = again.D_a;
  first.D_b = again.D_b;
  EXPECT_GT(FloorLine(first, {}).disagreement(again, 0.0, P), 9.0);
}

/// What an image of a camera that leans shows of lines on the floor, with half a pixel of noise.
std::vector<FloorSegment> seenLeaning(const std::vector<Segment3>& lines, const Pose3& T_robot_camera,
                                      const Lean& lean, std::mt19937_64& random) {
  const auto k = intrinsicsFromFieldOfView(320, 240, degToRad(60.0));
  std::normal_distribution<double> noise(0.0, 0.5);
  std::vector<ImageSegment> observed;
  for (const Segment3& line : lines) {
    auto px = projectSegment(k, leaned(T_robot_camera, lean), line);
    if (!px) continue;
    px->a += Eigen::Vector2d(noise(random), noise(random));
    px->b += Eigen::Vector2d(noise(random), noise(random));
    observed.push_back({*px, "edge", 40.0});
  }
  return GroundProjector({}).project(k, T_robot_camera, observed);
}

/// What a standing robot learns of its camera's pitch from 100 images in which its body sways.
double pitchLearnt(const std::vector<Segment3>& lines, double true_pitch_rad) {
  LeanParams params;
  params.mount_rad = 0.0;
  params.sway_rad = degToRad(1.0);
  DriftAlignment alignment(params);
  std::mt19937_64 random(5);
  std::normal_distribution<double> sway(0.0, degToRad(0.7));
  const Pose3 T_robot_camera = cameraPose(mount(), 0.0, -0.3);
  for (int i = 0; i < 100; ++i) {
    const Lean really{sway(random), sway(random), true_pitch_rad, 0.0};
    const Pose3 believed = leaned(T_robot_camera, alignment.lean());
    auto floor = seenLeaning(lines, T_robot_camera, really, random);
    // Placed again where the lean that is believed by now puts it.
    const Eigen::Matrix3d R = believed.linear() * T_robot_camera.linear().transpose();
    for (FloorSegment& s : floor) {
      s.odom.a = turnedOnFloor(s.odom.a, believed.translation(), R);
      s.odom.b = turnedOnFloor(s.odom.b, believed.translation(), R);
    }
    std::vector<DriftResidual> residuals;
    addCourseResiduals(floor, LeaningView(believed, 0.0), Lean::Zero(), {}, std::nullopt, residuals);
    alignment.solve({0.0, 0.0}, residuals, {});
  }
  return alignment.lean()[2];
}

TEST(CameraLean, LinesThatConvergeTellOfIt) {
  const double pitch = degToRad(0.5);
  const std::vector<Segment3> corridor{{{1.0, 0.75, 0.0}, {3.5, 0.75, 0.0}},
                                       {{3.0, -0.75, 0.0}, {1.2, -0.75, 0.0}}};
  EXPECT_NEAR(pitchLearnt(corridor, pitch), pitch, degToRad(0.15));
  EXPECT_NEAR(pitchLearnt(corridor, -pitch), -pitch, degToRad(0.15));
  EXPECT_NEAR(pitchLearnt(corridor, 0.0), 0.0, degToRad(0.15));
  // One line alone, or lines that were never meant to be parallel, tell nothing.
  EXPECT_EQ(pitchLearnt({corridor[0]}, pitch), 0.0);
  EXPECT_EQ(pitchLearnt({corridor[0], {{3.0, -0.7, 0.0}, {1.5, 0.3, 0.0}}}, pitch), 0.0);
  // Nor do short ones, of which a circle is made.
  EXPECT_EQ(pitchLearnt({{{1.0, 0.5, 0.0}, {1.3, 0.5, 0.0}}, {{1.0, -0.5, 0.0}, {1.3, -0.5, 0.0}}}, pitch),
            0.0);
}

TEST(CameraLean, OnlyAPlaceOfRightAnglesHasACourse) {
  const auto holds = [](const std::vector<double>& directions_deg) {
    Rectilinearity place({});
    for (const double d : directions_deg) place.add(degToRad(d), 1.0);
    return place.course().has_value();
  };
  EXPECT_TRUE(holds({30.0, 121.0, -61.0, 210.5, 29.0}));
  EXPECT_TRUE(holds({44.0, -44.0, 45.5, -46.0})) << "across the seam";
  EXPECT_TRUE(holds({0.0, 90.0, 1.0, 91.0, 40.0})) << "one that lies askew";
  EXPECT_FALSE(holds({0.0, 90.0, 1.0})) << "too few";
  EXPECT_FALSE(holds({0.0, 90.0, 1.0, 91.0, 40.0, 55.0}));
  EXPECT_FALSE(holds({0.0, 15.0, 30.0, 45.0, 60.0, 75.0})) << "a round one";
  Rectilinearity chords({});
  for (int i = 0; i < 12; ++i) chords.add(0.0, 0.2);
  EXPECT_FALSE(chords.course().has_value());
}

TEST(CameraLean, TheCourseOfAPlaceIsThatOfMostOfItsLines) {
  Rectilinearity place({});
  for (const double d : {44.0, -44.0, 45.5, -46.0, 10.0}) place.add(degToRad(d), 1.0);
  ASSERT_TRUE(place.course());
  // 44, 46, 45.5 and 44 degrees, modulo 90.
  EXPECT_NEAR(std::remainder(*place.course() - degToRad(44.875), degToRad(90.0)), 0.0, degToRad(0.05));
}

TEST(CameraLean, ACourseThatIsKnownTellsOfATurnByOneLine) {
  // Odometry counted two degrees too much: what is seen lies so far to the left of what is remembered.
  const double turned = degToRad(2.0);
  const Eigen::Rotation2Dd R(turned);
  Segment3 line{{1.2, 0.6, 0.0}, {2.2, 0.6, 0.0}};
  std::mt19937_64 random(3);
  const Pose3 T_robot_camera = cameraPose(mount(), degToRad(20.0), -0.35);
  auto floor = seenLeaning({line}, T_robot_camera, Lean::Zero(), random);
  ASSERT_EQ(floor.size(), 1u);
  for (Eigen::Vector2d* p : {&floor[0].odom.a, &floor[0].odom.b}) *p = R * *p;
  const LeaningView view(toPose3(Pose2{0.0, 0.0, turned}) * T_robot_camera, turned);
  DriftAlignment::Params feet;
  feet.turn_per_rad = 0.2;
  const auto turnTold = [&](const std::optional<double>& known_rad) {
    DriftAlignment alignment;
    alignment.travel({}, {0.0, 0.0, 1.0}, feet);
    std::vector<DriftResidual> residuals;
    addCourseResiduals(floor, view, Lean::Zero(), {}, known_rad, residuals);
    const auto found = alignment.solve({0.0, 0.0}, residuals, feet);
    return found ? found->motion.turn_rad : 0.0;
  };
  EXPECT_NEAR(turnTold(0.0), turned, degToRad(0.7));
  EXPECT_EQ(turnTold(std::nullopt), 0.0) << "one line has no course of its own";
}

TEST(CameraLean, TheCourseIsTheMeanOfTheLinesThatHaveIt) {
  const auto course = [](const std::vector<double>& directions_deg) {
    Rectilinearity place({});
    for (const double d : directions_deg) place.add(degToRad(d), 1.0);
    return place.course();
  };
  // Modulo 90 degrees 30, 31, 29, 30.5, 29: their mean is 29.9.
  EXPECT_NEAR(radToDeg(course({30.0, 121.0, -61.0, 210.5, 29.0}).value()), 29.9, 1e-3);
  // 44, 46, 45.5, 44: 44.875, which is as well -45.125.
  EXPECT_NEAR(radToDeg(offCourse(course({44.0, -44.0, 45.5, -46.0}).value(), degToRad(44.875))), 0.0, 1e-3);
  EXPECT_FALSE(course({0.0, 15.0, 30.0, 45.0, 60.0, 75.0}));
}

TEST(CameraLean, AKnownSwayIsNoUncertaintyOfPlacesAnyMore) {
  std::mt19937_64 random(1);
  const auto floor = seenLeaning({{{2.5, 0.3, 0.0}, {2.7, -0.4, 0.0}}}, cameraPose(mount(), 0.2, -0.3),
                                 Lean::Zero(), random);
  ASSERT_EQ(floor.size(), 1u);
  const FloorSegment& before = floor.front();
  FloorSegment known = before;
  knowSway(known, Eigen::Matrix2d::Zero(), 1.0);
  EXPECT_EQ(known.pitch_sigma_rad, 0.0);
  EXPECT_LT(known.P_a.trace(), 0.5 * before.P_a.trace());
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(known.P_a).eigenvalues().minCoeff(), 0.0);
  // A sway that nothing told of leaves about what there was.
  FloorSegment unknown = before;
  const double sway = 0.5 * before.pitch_sigma_rad;
  knowSway(unknown, sway * sway * Eigen::Matrix2d::Identity(), sway);
  EXPECT_NEAR(unknown.P_a.trace(), before.P_a.trace(), 0.1 * before.P_a.trace());
  EXPECT_GT(unknown.pitch_sigma_rad, 0.0);
}

TEST(CameraLean, ExchangedEndsKeepTheirDerivatives) {
  FloorSegment s;
  s.odom = {{1.0, 0.0}, {2.0, 0.0}};
  s.D_a.setConstant(1.0);
  s.D_b.setConstant(2.0);
  EXPECT_EQ(reversed(s).D_a, s.D_b);
  EXPECT_EQ(reversed(s).D_b, s.D_a);
}

}  // namespace
}  // namespace vismem
