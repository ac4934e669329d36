#include "calibration/core/body/joint_path.h"

#include <gtest/gtest.h>

namespace vismem {
namespace {

std::vector<PanTiltSample> upAndDown() {
  std::vector<PanTiltSample> samples;
  for (int i = 0; i <= 20; ++i) {
    const double pan = 0.05 * (i <= 10 ? i : 20 - i);
    samples.push_back({i * 100'000, static_cast<std::uint64_t>(i), pan, 0.0});
  }
  return samples;
}

/// Of pan (0) or tilt (1), for joints that report true angles.
double leadAt(const JointPath& path, double time_s, const Eigen::Vector2d& backlash_rad, int joint) {
  const MotorLead lead = path.leadAt(time_s, backlash_rad)[static_cast<std::size_t>(joint)];
  return lead.lead(1.0, backlash_rad[joint], backlash_rad[joint], path.at(time_s)[joint]);
}

TEST(JointPath, InterpolatesAndGoesOnBeyondItsEnds) {
  const JointPath path(upAndDown());
  EXPECT_NEAR(path.at(0.55).x(), 0.275, 1e-12);
  EXPECT_NEAR(path.at(-0.1).x(), -0.05, 1e-12);
  EXPECT_NEAR(path.at(2.1).x(), -0.05, 1e-12);
  EXPECT_NEAR(path.spread(0.1, 0.9), 0.45, 1e-9) << "the samples around it";
}

TEST(JointPath, AMotorLeadsItsHeadInTheDirectionOfItsLastMotion) {
  const JointPath path(upAndDown());
  const Eigen::Vector2d backlash(0.02, 0.02);
  EXPECT_EQ(leadAt(path, 0.5, backlash, 0), 1.0);
  EXPECT_EQ(leadAt(path, 1.5, backlash, 0), -1.0);
  EXPECT_EQ(leadAt(path, 1.5, backlash, 1), 0.0) << "it never moved";
  EXPECT_EQ(leadAt(path, 0.0, backlash, 0), 0.0) << "it has not moved yet";
}

// At 1.02 s the pan has turned back by 0.01: half of a backlash of 0.02, a quarter of one of 0.04.
TEST(JointPath, AReversalWithinTheBacklashLeavesTheHeadWhereItWas) {
  const JointPath path(upAndDown());
  EXPECT_NEAR(leadAt(path, 1.02, {0.02, 0.02}, 0), 0.0, 1e-9);
  EXPECT_NEAR(leadAt(path, 1.02, {0.04, 0.02}, 0), 0.5, 1e-9);
  EXPECT_EQ(leadAt(path, 1.02, {0.0, 0.02}, 0), -1.0) << "readings are not better than 0.2 degrees";
  EXPECT_NEAR(leadAt(path, 1.02, {10.0, 0.02}, 0), 0.0, 1e-9) << "it never crossed that";
}

// Whatever the motor does within the backlash, the head stays behind the place where the motor turned.
TEST(JointPath, AHeadRestsWhileItsMotorCrossesTheBacklash) {
  const JointPath path(upAndDown());
  const double scale = 1.02;
  const double backlash = 0.02;
  for (const double t : {1.0, 1.01, 1.03}) {
    const MotorLead pan = path.leadAt(t, {backlash / scale, 0.0})[0];
    EXPECT_NEAR(pan.headAngle(scale, backlash, backlash, path.at(t).x()), scale * 0.5 - 0.5 * backlash, 1e-9)
        << t;
  }
  const MotorLead behind = path.leadAt(1.2, {backlash / scale, 0.0})[0];
  EXPECT_NEAR(behind.headAngle(scale, backlash, backlash, path.at(1.2).x()), scale * 0.4 + 0.5 * backlash,
              1e-9);
}

TEST(JointPath, RefusesStampsThatDoNotRise) {
  std::vector<PanTiltSample> samples = upAndDown();
  samples[3].stamp_us = samples[2].stamp_us;
  EXPECT_THROW(JointPath{samples}, std::invalid_argument);
}

}  // namespace
}  // namespace vismem
