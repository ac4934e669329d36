// Tests M1.
#include "active_visual_memory/core/memory/parallax.h"

#include <gtest/gtest.h>

#include <numbers>

namespace vismem {
namespace {

using Verdict = ParallaxEstimate::Verdict;
constexpr double kCamera_m = 0.45;
const CameraTiltCovariance kUpright = CameraTiltCovariance::Zero();

/// What an edge at a height shows: its floor place moves by -b h / (H - h).
ParallaxEstimate watched(ParallaxEstimate::Channel channel, double height_m, double baseline_m) {
  ParallaxEstimate estimate;
  for (int i = 0; i <= 10; ++i) {
    const double b = baseline_m * i / 10;
    estimate.add(channel, b, -b * height_m / (kCamera_m - height_m), TiltJacobianRow::Zero(), 1e-5, {});
  }
  return estimate;
}

TEST(Parallax, ABoxTopMovesAsTheFormulaSays) {
  // h = 0.15: slope 0.15 / 0.30 = 0.5.
  const auto slope =
      watched(ParallaxEstimate::kOffset, 0.15, 0.5).slope(ParallaxEstimate::kOffset, kUpright, {});
  ASSERT_TRUE(slope);
  EXPECT_NEAR(slope->value, 0.5, 1e-9);
  EXPECT_EQ(watched(ParallaxEstimate::kOffset, 0.15, 0.5).verdict(kCamera_m, true, kUpright, {}),
            Verdict::kOffFloor);
}

TEST(Parallax, AMarkingIsConfirmedOnceTheCameraHasMoved) {
  EXPECT_EQ(watched(ParallaxEstimate::kOffset, 0.0, 0.5).verdict(kCamera_m, false, kUpright, {}),
            Verdict::kOnFloor);
  EXPECT_EQ(watched(ParallaxEstimate::kOffset, 0.0, 0.05).verdict(kCamera_m, false, kUpright, {}),
            Verdict::kUnknown);
  EXPECT_EQ(watched(ParallaxEstimate::kOffset, 0.0, 0.0).verdict(kCamera_m, false, kUpright, {}),
            Verdict::kUnknown);
}

TEST(Parallax, OneRestingEndIsNotEnoughForAPossiblyVerticalEdge) {
  const auto foot = watched(ParallaxEstimate::kEndA, 0.0, 0.5);
  EXPECT_EQ(foot.verdict(kCamera_m, false, kUpright, {}), Verdict::kUnknown);
  EXPECT_EQ(foot.verdict(kCamera_m, true, kUpright, {}), Verdict::kOnFloor);
}

TEST(Parallax, AnEndThatMovesOutweighsOneThatRests) {
  // The top of a skirting along the camera's way: one end lies behind a cabinet and seems to rest.
  ParallaxEstimate top;
  for (int i = 0; i <= 10; ++i) {
    const double b = 0.05 * i;
    top.add(ParallaxEstimate::kEndA, b, 0.0, TiltJacobianRow::Zero(), 1e-5, {});
    top.add(ParallaxEstimate::kEndB, b, -b * 0.08 / (kCamera_m - 0.08), TiltJacobianRow::Zero(), 1e-5, {});
  }
  EXPECT_EQ(top.verdict(kCamera_m, true, kUpright, {}), Verdict::kOffFloor);
}

TEST(Parallax, AnEndThatRestsIsNotEnoughWhereTheLineMoves) {
  // The top of a skirting, slope 0.08 / 0.37 = 0.216: a sigma of 0.042 is no verdict above 0.154.
  const auto seen = [](double height_m) {
    ParallaxEstimate estimate;
    for (int i = 0; i <= 10; ++i) {
      const double b = 0.05 * i;
      const double shift = -b * height_m / (kCamera_m - height_m);
      estimate.add(ParallaxEstimate::kOffset, b, shift, TiltJacobianRow::Zero(), 4.4e-4, {});
      estimate.add(ParallaxEstimate::kEndA, b, 0.0, TiltJacobianRow::Zero(), 1e-5, {});
    }
    return estimate.verdict(kCamera_m, true, kUpright, {});
  };
  EXPECT_EQ(seen(0.08), Verdict::kUnknown);
  EXPECT_EQ(seen(0.05), Verdict::kOnFloor);
}

TEST(Parallax, ChannelsTooWeakAloneDecideTogether) {
  // 11 samples over 0.5 m: the squares about their mean are 0.275 m^2, so a slope's sigma is 0.09 for a
  // sample's variance of 0.0022; the limit is 0.06 / 0.39 = 0.154. Three together have 0.052.
  const auto seen = [](double at_a) {
    ParallaxEstimate estimate;
    for (int i = 0; i <= 10; ++i) {
      const double b = 0.05 * i;
      estimate.add(ParallaxEstimate::kOffset, b, 0.0, TiltJacobianRow::Zero(), 0.0022, {});
      estimate.add(ParallaxEstimate::kEndA, b, -at_a * b, TiltJacobianRow::Zero(), 0.0022, {});
      estimate.add(ParallaxEstimate::kEndB, b, 0.0, TiltJacobianRow::Zero(), 0.0022, {});
    }
    return estimate;
  };
  EXPECT_EQ(seen(0.0).verdict(kCamera_m, true, kUpright, {}), Verdict::kOnFloor);
  EXPECT_NEAR(seen(0.09).common(kUpright, {})->value, 0.03, 1e-9);
  EXPECT_EQ(seen(0.0).verdict(kCamera_m, false, kUpright, {}), Verdict::kUnknown)
      << "what may be vertical is not as high everywhere";
  EXPECT_EQ(seen(0.3).verdict(kCamera_m, true, kUpright, {}), Verdict::kUnknown) << "they do not agree";
}

TEST(Parallax, StandingStillAddsNothing) {
  ParallaxEstimate estimate;
  for (int i = 0; i < 1000; ++i)
    estimate.add(ParallaxEstimate::kOffset, 0.0, 0.001 * (i % 3), TiltJacobianRow::Zero(), 1e-6, {});
  EXPECT_FALSE(estimate.slope(ParallaxEstimate::kOffset, kUpright, {}));
}

TEST(ParallaxEstimate, AHeightMayBeACameraTiltUntilThatIsKnown) {
  // An edge on the floor 3 m ahead of a camera that looks half a degree too high moves by 3 cm beside its
  // place in the world while the camera drives 0.25 m: as one of 5 cm of height would. d (3 m) = (r^2 + h^2)
  // / h = 20.2 m per radian.
  const double tilt_rad = 0.5 * std::numbers::pi / 180.0;
  const auto reach = [](double r) { return (r * r + kCamera_m * kCamera_m) / kCamera_m; };
  ParallaxEstimate estimate;
  for (double b = 0.0; b <= 0.501; b += 0.05) {
    TiltJacobianRow d = TiltJacobianRow::Zero();
    d[2] = reach(3.0 - b) - reach(3.0);
    estimate.add(ParallaxEstimate::kOffset, b, d[2] * tilt_rad, d, 1e-6, {});
  }
  const double unknown = estimate.slope(ParallaxEstimate::kOffset, kUpright, {})->value;
  EXPECT_GT(unknown, 0.08);
  CameraTiltCovariance P = CameraTiltCovariance::Zero();
  P(2, 2) = tilt_rad * tilt_rad;
  EXPECT_EQ(estimate.verdict(kCamera_m, true, P, {}), Verdict::kUnknown);
  CameraTilt change = CameraTilt::Zero();
  change[2] = -tilt_rad;
  estimate.applyTiltChange(change);
  EXPECT_NEAR(estimate.slope(ParallaxEstimate::kOffset, kUpright, {})->value, 0.0, 1e-9);
  EXPECT_EQ(estimate.verdict(kCamera_m, true, kUpright, {}), Verdict::kOnFloor);
}

}  // namespace
}  // namespace vismem
