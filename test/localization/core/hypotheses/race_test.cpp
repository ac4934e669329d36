// Tests L7.
#include "localization/core/hypotheses/race.h"

#include <gtest/gtest.h>

#include <numbers>

#include "common/geometry/angles.h"

namespace vismem {
namespace {

constexpr double kPi = std::numbers::pi;

TEST(SamePlace, NeedsPositionAndHeading) {
  const RaceParams params;  // 20 cm, 30 degrees
  EXPECT_TRUE(samePlace({1.0, 1.0, 0.0}, {1.19, 0.81, degToRad(29)}, params));
  EXPECT_FALSE(samePlace({1.0, 1.0, 0.0}, {1.21, 1.0, 0.0}, params));
  EXPECT_FALSE(samePlace({1.0, 1.0, 0.0}, {1.0, 1.0, degToRad(31)}, params));
}

TEST(SamePlace, HeadingsMeetAcrossTheWrap) {
  const RaceParams params;
  EXPECT_TRUE(samePlace({0, 0, kPi - 0.1}, {0, 0, -kPi + 0.1}, params));
  EXPECT_FALSE(samePlace({0, 0, kPi - 0.3}, {0, 0, -kPi + 0.3}, params));
}

}  // namespace
}  // namespace vismem
