#include "localization/core/likelihood/tilt_mixture.h"

#include <gtest/gtest.h>

#include "common/geometry/angles.h"

namespace vismem {
namespace {

const TiltMixture kPrior(degToRad(0.1), degToRad(1.0));

Eigen::Vector2d tilt(double pitch_deg, double roll_deg) {
  return {degToRad(pitch_deg), degToRad(roll_deg)};
}

TEST(TiltMixture, PaysTheOddsOfAnUncalibratedCameraOnce) {
  EXPECT_EQ(kPrior.logDensity(tilt(0.0, 0.0)), 0.0);
  // 1 to 20, and ten times as wide.
  EXPECT_NEAR(kPrior.logDensity(tilt(1.0, 0.0)), std::log(0.05 * 0.1) - 0.5, 1e-9);
  EXPECT_NEAR(kPrior.logDensity(tilt(std::sqrt(0.5), -std::sqrt(0.5))), std::log(0.05 * 0.1) - 0.5, 1e-9);
  EXPECT_NEAR(kPrior.logDensity(tilt(-0.1, 0.0)), -0.5, 1e-9);
}

// A tilt takes the component that makes it likelier, so that the density has no step.
TEST(TiltMixture, BothComponentsMeetWhereTheInformationChanges) {
  const double calibrated = 1.0 / std::pow(degToRad(0.1), 2);
  const double wide = 1.0 / std::pow(degToRad(1.0), 2);
  double before = 0.0;
  for (double pitch_deg = 0.0; pitch_deg < 2.0; pitch_deg += 0.001) {
    const double density = kPrior.logDensity(tilt(pitch_deg, 0.0));
    EXPECT_LE(density, before);
    EXPECT_LT(before - density, 0.05) << pitch_deg;
    before = density;
    EXPECT_DOUBLE_EQ(kPrior.information(tilt(pitch_deg, 0.0)), pitch_deg < 0.3272 ? calibrated : wide)
        << pitch_deg;
  }
}

TEST(TiltMixture, IsFlatWithoutStandardDeviations) {
  EXPECT_EQ(TiltMixture().logDensity(tilt(3.0, -3.0)), 0.0);
  EXPECT_EQ(TiltMixture().information(tilt(3.0, -3.0)), 0.0);
  EXPECT_EQ(TiltMixture().wideInformation(), 0.0);
}

}  // namespace
}  // namespace vismem
