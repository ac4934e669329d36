#include "calibration/core/body/daily_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace vismem {
namespace {

TEST(DailyCheck, SaysHowFarTheCameraWasKnocked) {
  const DailyReport report =
      checkDaily({{"camera knock", 0.8, 0.03, "deg"}, {"cpu", 40.0, 0.0, "%"}}, DailyCheckParams{});
  ASSERT_EQ(report.findings.size(), 1U) << "cpu is no calibration";
  EXPECT_FALSE(report.isGood());
  EXPECT_THAT(report.findings[0].text, testing::HasSubstr("the camera was knocked by 0.8 degrees"));
}

// 0.15 degrees at 0.05 of the estimate and 0.05 of the calibration: 2.1 standard deviations.
TEST(DailyCheck, CountsTheCalibrationsOwnDeviation) {
  const DailyReport report = checkDaily({{"camera knock", 0.15, 0.05, "deg"}}, DailyCheckParams{});
  EXPECT_TRUE(report.isGood());
  EXPECT_NEAR(report.findings.at(0).sigmas, 2.12, 0.01);
}

TEST(DailyCheck, WatchesTheWheels) {
  const DailyReport report = checkDaily({{"odometry yaw bias", -0.5, 0.1, "deg/m"},
                                         {"odometry yaw scale error", 0.1, 0.3, "%"},
                                         {"odometry distance scale error", -1.5, 0.2, "%"}},
                                        DailyCheckParams{});
  ASSERT_EQ(report.findings.size(), 3U);
  EXPECT_FALSE(report.findings[0].is_good);
  EXPECT_TRUE(report.findings[1].is_good);
  EXPECT_FALSE(report.findings[2].is_good);
}

}  // namespace
}  // namespace vismem
