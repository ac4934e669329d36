// Tests M6.
#include "active_visual_memory/core/estimation/measurement_models.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <random>
#include <vector>

#include "active_visual_memory/core/tilted_camera.h"
#include "common/geometry/angles.h"
#include "common/geometry/projection.h"

namespace vismem {
namespace {

const Pose3 T_robot_camera = cameraPose(mount(), 0.0, -0.35);

/// One image of lines, by a robot that turned by `turned_rad` while its odometry counted nothing, with a
/// frame tilt.
std::pmr::vector<FloorSegment> seenTurned(const std::vector<Segment3>& lines, double turned_rad,
                                          const CameraTilt& tilt) {
  std::mt19937_64 random(3);
  auto floor = seenTilted(lines, T_robot_camera, tilt, random);
  const Eigen::Rotation2Dd R(turned_rad);
  for (FloorSegment& s : floor) {
    s.a.p = R * s.a.p;
    s.b.p = R * s.b.p;
  }
  return floor;
}

std::optional<DirectionDeviation> deviationOf(const std::vector<Segment3>& lines, double turned_rad,
                                              const CameraTilt& tilt, double per_frame_rad) {
  const TiltView view(toPose3(Pose2{0.0, 0.0, turned_rad}) * T_robot_camera, turned_rad);
  return directionDeviation(seenTurned(lines, turned_rad, tilt), view, {}, 0.0, per_frame_rad);
}

TEST(MeasurementModels, OneLineMeasuresTheHeadingAgainstAKnownDirection) {
  const double turned = degToRad(2.0);
  const auto found =
      deviationOf({{{1.2, 0.6, 0.0}, {2.2, 0.6, 0.0}}}, turned, CameraTilt::Zero(), degToRad(0.05));
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->turn_rad, turned, degToRad(0.7));
  EXPECT_LT(std::abs(found->turn_rad - turned), 3.0 * std::sqrt(found->variance));
}

TEST(MeasurementModels, LinesThatConvergeSeparateTheFrameTiltFromTheHeading) {
  const std::vector<Segment3> corridor{{{1.5, 0.75, 0.0}, {3.5, 0.75, 0.0}},
                                       {{3.0, -0.7, 0.0}, {1.5, -0.7, 0.0}}};
  const CameraTilt tilt{0.0, degToRad(1.5), 0.0, 0.0};
  const double turned = degToRad(2.0);
  const auto both = deviationOf(corridor, turned, tilt, degToRad(1.0));
  const auto one = deviationOf({corridor[0]}, turned, tilt, degToRad(1.0));
  ASSERT_TRUE(both && one);
  EXPECT_NEAR(both->turn_rad, turned, degToRad(0.7));
  EXPECT_GT(std::abs(one->turn_rad - turned), std::abs(both->turn_rad - turned));
  EXPECT_LT(both->variance, one->variance);
}

TEST(MeasurementModels, ShortLinesAndLinesOfOtherDirectionsDoNotMeasureTheHeading) {
  const double per_frame = degToRad(0.05);
  // A circle is made of short ones.
  EXPECT_FALSE(deviationOf({{{1.0, 0.5, 0.0}, {1.3, 0.5, 0.0}}}, 0.0, CameraTilt::Zero(), per_frame));
  EXPECT_FALSE(deviationOf({{{1.0, 0.3, 0.0}, {2.0, 1.3, 0.0}}}, 0.0, CameraTilt::Zero(), per_frame));
}

}  // namespace
}  // namespace vismem
