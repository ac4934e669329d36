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

TEST(JointPath, InterpolatesAndGoesOnBeyondItsEnds) {
  const JointPath path(upAndDown());
  EXPECT_NEAR(path.at(0.55).x(), 0.275, 1e-12);
  EXPECT_NEAR(path.at(-0.1).x(), -0.05, 1e-12);
  EXPECT_NEAR(path.at(2.1).x(), -0.05, 1e-12);
  EXPECT_NEAR(path.spread(0.1, 0.9), 0.45, 1e-9) << "the samples around it";
}

TEST(JointPath, KnowsTheLastDirectionOfEachJoint) {
  const JointPath path(upAndDown());
  EXPECT_EQ(path.directionAt(0.5).x(), 1.0);
  EXPECT_EQ(path.directionAt(1.5).x(), -1.0);
  EXPECT_EQ(path.directionAt(1.5).y(), 0.0) << "it never moved";
}

TEST(JointPath, RefusesStampsThatDoNotRise) {
  std::vector<PanTiltSample> samples = upAndDown();
  samples[3].stamp_us = samples[2].stamp_us;
  EXPECT_THROW(JointPath{samples}, std::invalid_argument);
}

}  // namespace
}  // namespace vismem
