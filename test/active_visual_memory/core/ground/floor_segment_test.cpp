// Tests M1.
#include "active_visual_memory/core/ground/floor_segment.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <random>
#include <vector>

#include "active_visual_memory/core/ground/ground_projector.h"
#include "active_visual_memory/core/tilted_camera.h"
#include "common/geometry/angles.h"
#include "common/geometry/projection.h"

namespace vismem {
namespace {

TEST(FloorSegment, AnEstimatedFrameTiltShrinksTheCovarianceOfItsEnds) {
  std::mt19937_64 random(1);
  const auto floor = seenTilted({{{2.5, 0.3, 0.0}, {2.7, -0.4, 0.0}}}, cameraPose(mount(), 0.2, -0.3),
                                CameraTilt::Zero(), random);
  ASSERT_EQ(floor.size(), 1u);
  const FloorSegment& before = floor.front();
  FloorSegment known = before;
  conditionOnFrameTilt(known, Eigen::Matrix2d::Zero(), 1.0);
  EXPECT_EQ(known.pitch_sigma_rad, 0.0);
  EXPECT_LT(known.a.P.trace(), 0.5 * before.a.P.trace());
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(known.a.P).eigenvalues().minCoeff(), 0.0);
  // An unmeasured frame tilt leaves about the prior covariance.
  FloorSegment unknown = before;
  const double frame_tilt = 0.5 * before.pitch_sigma_rad;
  conditionOnFrameTilt(unknown, frame_tilt * frame_tilt * Eigen::Matrix2d::Identity(), frame_tilt);
  EXPECT_NEAR(unknown.a.P.trace(), before.a.P.trace(), 0.1 * before.a.P.trace());
  EXPECT_GT(unknown.pitch_sigma_rad, 0.0);
}

TEST(FloorSegment, ReversedExchangesTheJacobiansOfItsEnds) {
  FloorSegment s;
  s.place({{1.0, 0.0}, {2.0, 0.0}});
  s.a.D.setConstant(1.0);
  s.b.D.setConstant(2.0);
  EXPECT_EQ(reversed(s).a.D, s.b.D);
  EXPECT_EQ(reversed(s).b.D, s.a.D);
}

}  // namespace
}  // namespace vismem
