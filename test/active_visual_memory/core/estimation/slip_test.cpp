// Tests M6.
#include "active_visual_memory/core/estimation/slip.h"

#include <gtest/gtest.h>

#include <random>

#include "common/geometry/angles.h"

namespace vismem {
namespace {

constexpr StampUs kImage_us = 100'000;

TEST(SlipDetector, NeedsSeveralImagesThatAgree) {
  const SlipDetector::Params params;
  const double sigma = degToRad(2.5);
  std::mt19937_64 random(3);
  std::normal_distribution<double> noise(0.0, sigma);
  SlipDetector detector;
  for (int i = 0; i < 400; ++i) {
    EXPECT_FALSE(detector.add(i * kImage_us, noise(random), sigma * sigma, params)) << i;
  }
  const double slip = degToRad(6.0);
  for (int i = 400;; ++i) {
    ASSERT_LT(i, 412) << "a slip of 6 degrees is found within 12 images";
    const auto found = detector.add(i * kImage_us, slip + noise(random), sigma * sigma, params);
    if (!found) continue;
    EXPECT_GE(i, 402);
    EXPECT_NEAR(found->turn_rad, slip, 3.0 * found->sigma_rad);
    EXPECT_NEAR(static_cast<double>(found->since_us), 400.0 * kImage_us, 3.0 * kImage_us);
    break;
  }
}

}  // namespace
}  // namespace vismem
