#include "active_visual_memory/core/parallax.h"

#include <gtest/gtest.h>

namespace vismem {
namespace {

using Verdict = ParallaxEstimate::Verdict;
constexpr double kCamera_m = 0.45;

/// What an edge at a height shows: its floor place moves by -b h / (H - h).
ParallaxEstimate watched(ParallaxEstimate::Channel channel, double height_m, double baseline_m) {
  ParallaxEstimate estimate;
  for (int i = 0; i <= 10; ++i) {
    const double b = baseline_m * i / 10;
    estimate.add(channel, b, -b * height_m / (kCamera_m - height_m), 1e-5, {});
  }
  return estimate;
}

TEST(Parallax, ABoxTopMovesAsTheFormulaSays) {
  // h = 0.15: slope 0.15 / 0.30 = 0.5.
  const auto slope = watched(ParallaxEstimate::kOffset, 0.15, 0.5).slope(ParallaxEstimate::kOffset, {});
  ASSERT_TRUE(slope);
  EXPECT_NEAR(slope->value, 0.5, 1e-9);
  EXPECT_EQ(watched(ParallaxEstimate::kOffset, 0.15, 0.5).verdict(kCamera_m, true, {}), Verdict::kOffFloor);
}

TEST(Parallax, AMarkingIsConfirmedOnceTheCameraHasMoved) {
  EXPECT_EQ(watched(ParallaxEstimate::kOffset, 0.0, 0.5).verdict(kCamera_m, false, {}), Verdict::kOnFloor);
  EXPECT_EQ(watched(ParallaxEstimate::kOffset, 0.0, 0.05).verdict(kCamera_m, false, {}), Verdict::kUnknown);
  EXPECT_EQ(watched(ParallaxEstimate::kOffset, 0.0, 0.0).verdict(kCamera_m, false, {}), Verdict::kUnknown);
}

TEST(Parallax, OneRestingEndIsNotEnoughForWhatMayBeVertical) {
  const auto foot = watched(ParallaxEstimate::kEndA, 0.0, 0.5);
  EXPECT_EQ(foot.verdict(kCamera_m, false, {}), Verdict::kUnknown);
  EXPECT_EQ(foot.verdict(kCamera_m, true, {}), Verdict::kOnFloor);
}

TEST(Parallax, StandingStillAddsNothing) {
  ParallaxEstimate estimate;
  for (int i = 0; i < 1000; ++i) estimate.add(ParallaxEstimate::kOffset, 0.0, 0.001 * (i % 3), 1e-6, {});
  EXPECT_FALSE(estimate.slope(ParallaxEstimate::kOffset, {}));
}

}  // namespace
}  // namespace vismem
