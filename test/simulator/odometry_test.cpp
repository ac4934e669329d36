// Dead reckoning and its errors: definitions of the presets, and growth as documented.
#include "common/kinematics/odometry.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/geometry/angles.h"
#include "common/kinematics/kinematics.h"
#include "common/kinematics/random_stream.h"
#include "support/odometry_error.h"

namespace vismem {
namespace {

constexpr double kBase_m = 0.33;
constexpr double kStep_m = 0.004;

SimulatedOdometry straight(const OdometryErrorParams& errors, std::uint64_t seed, double metres) {
  SimulatedOdometry odometry(errors, kBase_m, seed);
  for (int i = 0; i < std::lround(metres / kStep_m); ++i) odometry.add({kStep_m, kStep_m});
  return odometry;
}

TEST(Odometry, PresetNoneHasNoError) {
  SimulatedOdometry odometry(noOdometryError(), kBase_m, 7);
  Pose2 truth;
  for (int i = 0; i < 5000; ++i) {
    const double v = 0.3, w = 0.5 * std::sin(i * 0.01);
    truth = truth * arcMotion(v, w, 0.01);
    odometry.add({(v - w * kBase_m / 2) * 0.01, (v + w * kBase_m / 2) * 0.01});
  }
  EXPECT_NEAR(odometry.pose().x, truth.x, 1e-9);
  EXPECT_NEAR(odometry.pose().y, truth.y, 1e-9);
  EXPECT_NEAR(angleDifference(odometry.pose().theta, truth.theta), 0.0, 1e-9);
}

TEST(Odometry, DefaultErrorGrowsAsDocumented) {
  // The mean of the squares of 600 runs has a standard deviation of about sqrt(2 / 600) = 6 %, its root 3 %;
  // the formula leaves out second orders: 10 % bounds both.
  constexpr int kRuns = 600;
  for (const double length : {1.0, 3.0, 10.0}) {
    double squares = 0.0;
    for (int run = 0; run < kRuns; ++run) {
      const Pose2 pose = straight(defaultOdometryError(), subStream(run, "odometry"), length).pose();
      squares += (pose.position() - Eigen::Vector2d(length, 0.0)).squaredNorm();
    }
    const double expected = expectedStraightError_m(defaultOdometryError(), kBase_m, length);
    EXPECT_NEAR(std::sqrt(squares / kRuns), expected, 0.1 * expected) << length << " m";
  }
  // By hand: s = n = 1.414 * 0.005 / 0.33 = 0.02143; across 0.01071 and 0.01237 at 1 m, along 0.0035 and
  // 0.0035.
  EXPECT_NEAR(expectedStraightError_m(defaultOdometryError(), kBase_m, 1.0), 0.01711, 2e-5);
}

TEST(Odometry, StageErrsByFixedFactorsWithinTheirWidths) {
  double least = 1e9, most = -1e9;
  for (int run = 0; run < 200; ++run) {
    const Pose2 two = straight(stageOdometryError(), subStream(run, "odometry"), 2.0).pose();
    const Pose2 four = straight(stageOdometryError(), subStream(run, "odometry"), 4.0).pose();
    EXPECT_NEAR(four.x, 2.0 * two.x, 1e-9) << "no noise beside the factor";
    EXPECT_NEAR(two.y, 0.0, 1e-12);
    least = std::min(least, two.x / 2.0);
    most = std::max(most, two.x / 2.0);
  }
  EXPECT_GE(least, 0.985);
  EXPECT_LE(most, 1.015);
  EXPECT_LT(least, 0.987) << "and they use their width";
  EXPECT_GT(most, 1.013);
}

TEST(Odometry, ThrunErrsAsItsAlphasSayWhateverTheStep) {
  // Ten metres straight on are 40 stretches of 0.25 m; each turns by two normal numbers of variance
  // 0.001 * 0.25^2: together sqrt(40 * 2 * 0.001) * 0.25 = 0.0707 rad, and is 0.25 sqrt(0.001) off in length:
  // 0.05 m after all of them (cosines of the heading shorten it by a little).
  constexpr int kRuns = 600;
  for (const double step : {0.002, 0.01}) {
    double headings = 0.0, lengths = 0.0;
    for (int run = 0; run < kRuns; ++run) {
      SimulatedOdometry odometry(thrunOdometryError(), kBase_m, subStream(run, "odometry"));
      double length = 0.0;
      Pose2 before;
      for (int i = 0; i < std::lround(10.0 / step); ++i) {
        odometry.add({step, step});
        length += (odometry.pose().position() - before.position()).norm();
        before = odometry.pose();
      }
      headings += odometry.pose().theta * odometry.pose().theta;
      lengths += (length - 10.0) * (length - 10.0);
    }
    EXPECT_NEAR(std::sqrt(headings / kRuns), 0.0707, 0.1 * 0.0707) << step;
    EXPECT_NEAR(std::sqrt(lengths / kRuns), 0.05, 0.1 * 0.05) << step;
  }
}

TEST(Odometry, SlipsAreAsRareAndAsLargeAsConfigured) {
  auto errors = noOdometryError();
  errors.slips_per_m = 0.1;
  errors.slip_m = 0.04;
  int slips = 0;
  double turned = 0.0;
  constexpr int kRuns = 200;
  for (int run = 0; run < kRuns; ++run) {
    const SimulatedOdometry odometry = straight(errors, subStream(run, "odometry"), 20.0);
    slips += static_cast<int>(odometry.slips());
    turned += odometry.pose().theta * odometry.pose().theta;
  }
  // 200 runs of 20 m: 400 events expected, standard deviation 20.
  EXPECT_NEAR(slips, 400, 80);
  // An event turns by U(0.5, 1.5) * 0.04 / 0.33 rad to either side: mean square (13/12) * 0.1212^2; two
  // events a run. A slip that is not over at a run's end counts less.
  EXPECT_NEAR(turned / kRuns, 2.0 * 13.0 / 12.0 * std::pow(0.04 / 0.33, 2), 0.006);
}

TEST(Odometry, ASlipByCommandIsWhatTheWheelTurnedTooFar) {
  SimulatedOdometry odometry(noOdometryError(), kBase_m, 1);
  odometry.slip({0.05, 0.05});
  odometry.slip({0.0, 0.033});
  for (int i = 0; i < 20; ++i) odometry.add({});
  EXPECT_NEAR(odometry.pose().theta, 0.1, 1e-12);
  EXPECT_NEAR(odometry.pose().position().norm(), 0.0665, 1e-4);
  EXPECT_EQ(odometry.slips(), 2U);
}

TEST(Odometry, SlipsChangeNoOtherChance) {
  auto with = defaultOdometryError();
  with.slips_per_m = 1e-6;  // draws random numbers; events are improbable
  const Pose2 a = straight(with, 5, 5.0).pose();
  const Pose2 b = straight(defaultOdometryError(), 5, 5.0).pose();
  EXPECT_EQ(a, b);
}

}  // namespace
}  // namespace vismem
