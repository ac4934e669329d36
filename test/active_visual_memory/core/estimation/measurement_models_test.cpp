// Tests M6.
#include "active_visual_memory/core/estimation/measurement_models.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <random>
#include <vector>

#include "active_visual_memory/core/ground/ground_projector.h"
#include "active_visual_memory/core/tilted_camera.h"
#include "common/geometry/angles.h"
#include "common/geometry/projection.h"

namespace vismem {
namespace {

/// The camera pitch that a standing robot estimates from 100 images with a frame tilt each.
double estimatedPitch(const std::vector<Segment3>& lines, double true_pitch_rad) {
  TiltPrior params;
  params.mount_rad = 0.0;
  params.per_frame_rad = degToRad(1.0);
  DriftFilter alignment(params);
  std::mt19937_64 random(5);
  std::normal_distribution<double> frame_tilt(0.0, degToRad(0.7));
  const Pose3 T_robot_camera = cameraPose(mount(), 0.0, -0.3);
  for (int i = 0; i < 100; ++i) {
    const CameraTilt really{frame_tilt(random), frame_tilt(random), true_pitch_rad, 0.0};
    const Pose3 believed = tilted(T_robot_camera, alignment.cameraTilt());
    auto floor = seenTilted(lines, T_robot_camera, really, random);
    // Reprojected with the present estimate of the tilt.
    const Eigen::Matrix3d R = believed.linear() * T_robot_camera.linear().transpose();
    for (FloorSegment& s : floor) {
      s.odom.a = reprojectOnFloor(s.odom.a, believed.translation(), R);
      s.odom.b = reprojectOnFloor(s.odom.b, believed.translation(), R);
    }
    std::vector<DriftResidual> residuals;
    addDirectionResiduals(floor, TiltView(believed, 0.0), CameraTilt::Zero(), {}, std::nullopt, residuals);
    alignment.update({0.0, 0.0}, residuals, {});
  }
  return alignment.cameraTilt()[2];
}

TEST(MeasurementModels, ConvergingLinesMeasureTheCameraPitch) {
  const double pitch = degToRad(0.5);
  const std::vector<Segment3> corridor{{{1.0, 0.75, 0.0}, {3.5, 0.75, 0.0}},
                                       {{3.0, -0.75, 0.0}, {1.2, -0.75, 0.0}}};
  EXPECT_NEAR(estimatedPitch(corridor, pitch), pitch, degToRad(0.15));
  EXPECT_NEAR(estimatedPitch(corridor, -pitch), -pitch, degToRad(0.15));
  EXPECT_NEAR(estimatedPitch(corridor, 0.0), 0.0, degToRad(0.15));
  // One line alone, or lines that were never meant to be parallel, are not informative.
  EXPECT_EQ(estimatedPitch({corridor[0]}, pitch), 0.0);
  EXPECT_EQ(estimatedPitch({corridor[0], {{3.0, -0.7, 0.0}, {1.5, 0.3, 0.0}}}, pitch), 0.0);
  // Nor do short ones, of which a circle is made.
  EXPECT_EQ(estimatedPitch({{{1.0, 0.5, 0.0}, {1.3, 0.5, 0.0}}, {{1.0, -0.5, 0.0}, {1.3, -0.5, 0.0}}}, pitch),
            0.0);
}

TEST(MeasurementModels, OneLineMeasuresTheHeadingAgainstAKnownDirection) {
  // Odometry counted two degrees too much: what is seen lies so far to the left of what is remembered.
  const double turned = degToRad(2.0);
  const Eigen::Rotation2Dd R(turned);
  Segment3 line{{1.2, 0.6, 0.0}, {2.2, 0.6, 0.0}};
  std::mt19937_64 random(3);
  const Pose3 T_robot_camera = cameraPose(mount(), degToRad(20.0), -0.35);
  auto floor = seenTilted({line}, T_robot_camera, CameraTilt::Zero(), random);
  ASSERT_EQ(floor.size(), 1u);
  for (Eigen::Vector2d* p : {&floor[0].odom.a, &floor[0].odom.b}) *p = R * *p;
  const TiltView view(toPose3(Pose2{0.0, 0.0, turned}) * T_robot_camera, turned);
  DriftFilter::Params feet;
  feet.turn_per_rad = 0.2;
  const auto estimatedTurn = [&](const std::optional<double>& known_rad) {
    DriftFilter alignment;
    alignment.predict({}, {0.0, 0.0, 1.0}, feet);
    std::vector<DriftResidual> residuals;
    addDirectionResiduals(floor, view, CameraTilt::Zero(), {}, known_rad, residuals);
    const auto found = alignment.update({0.0, 0.0}, residuals, feet);
    return found ? found->motion.turn_rad : 0.0;
  };
  EXPECT_NEAR(estimatedTurn(0.0), turned, degToRad(0.7));
  EXPECT_EQ(estimatedTurn(std::nullopt), 0.0) << "one line has no direction of its own";
}

}  // namespace
}  // namespace vismem
