// Tests M6.
#include "active_visual_memory/core/estimation/state_limits.h"

#include <gtest/gtest.h>

namespace vismem {
namespace {

TEST(StateLimits, ATiltStaysWithinItsPriorAndItsVarianceAboveTheFloor) {
  TiltPrior prior;
  prior.mount_rad = 0.01;
  prior.camera_rad = 0.02;
  prior.floor_rad = 0.001;
  prior.max_sigmas = 3.0;
  CameraTilt tilt{0.05, -0.05, 0.01, -0.07};
  CameraTiltCovariance P = 1e-8 * CameraTiltCovariance::Identity();
  P(2, 2) = 1e-4;
  limitCameraTilt(prior, tilt, P);
  EXPECT_TRUE(tilt.isApprox(CameraTilt(0.03, -0.03, 0.01, -0.06)));
  EXPECT_DOUBLE_EQ(P(0, 0), 1e-6) << "0.001^2";
  EXPECT_DOUBLE_EQ(P(2, 2), 1e-4) << "larger than the floor: kept";
}

TEST(StateLimits, APriorOfZeroFixesTheTilt) {
  TiltPrior prior;
  prior.mount_rad = prior.camera_rad = 0.0;
  CameraTilt tilt = CameraTilt::Constant(0.1);
  CameraTiltCovariance P = CameraTiltCovariance::Zero();
  limitCameraTilt(prior, tilt, P);
  EXPECT_EQ(tilt, CameraTilt::Zero());
  EXPECT_EQ(P, CameraTiltCovariance::Zero()) << "no floor above a tilt that is known";
}

TEST(StateLimits, RatesStayWithinThreeTimesTheStatedDrift) {
  const Eigen::Vector2d stated{0.02, 0.05};
  Eigen::Vector2d rates{0.07, -0.2};
  Eigen::Matrix2d P = Eigen::Matrix2d::Zero();
  limitRates(stated, rates, P);
  EXPECT_DOUBLE_EQ(rates.x(), 0.06);
  EXPECT_DOUBLE_EQ(rates.y(), -0.15);
  EXPECT_NEAR(P(0, 0), 0.002 * 0.002, 1e-15) << "a tenth of the stated drift";
  EXPECT_NEAR(P(1, 1), 0.005 * 0.005, 1e-15);
}

}  // namespace
}  // namespace vismem
