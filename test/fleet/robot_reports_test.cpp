// The report of a robot out of the answers of its components. Tests C3.
#include "fleet/app/robot_reports.h"

#include <gtest/gtest.h>

namespace vismem {
namespace {

using namespace std::chrono_literals;

avm::PoseEstimate estimateOf(std::int64_t revision) {
  avm::PoseEstimate estimate;
  estimate.revision = revision;
  estimate.stampUs = 1000 * revision;
  estimate.hasPose = true;
  estimate.robotInWorld = {1.0, 2.0, 0.5};
  estimate.reliability = 0.8;
  return estimate;
}

TEST(RobotReports, CountUpAndCarryThePose) {
  RobotReports reports("robot7");
  const std::chrono::steady_clock::time_point now{1h};
  const auto first = reports.next(estimateOf(4), {}, 77, now);
  EXPECT_EQ(first.robot, "robot7");
  EXPECT_EQ(first.number, 1);
  EXPECT_EQ(first.stampUs, 77);
  ASSERT_TRUE(first.hasPose);
  EXPECT_EQ(first.poseStampUs, 4000);
  EXPECT_EQ(first.robotInWorld.y, 2.0);
  EXPECT_EQ(first.reliability, 0.8);
  EXPECT_EQ(reports.next(estimateOf(5), {}, 78, now).number, 2);
}

TEST(RobotReports, AnEstimateThatDoesNotChangeIsNoPoseAfterASecond) {
  RobotReports reports("robot7");
  const std::chrono::steady_clock::time_point now{1h};
  EXPECT_TRUE(reports.next(estimateOf(4), {}, 0, now).hasPose);
  EXPECT_TRUE(reports.next(estimateOf(4), {}, 0, now + 900ms).hasPose);
  EXPECT_FALSE(reports.next(estimateOf(4), {}, 0, now + 1100ms).hasPose);
  // A restarted localization counts from the beginning.
  EXPECT_TRUE(reports.next(estimateOf(1), {}, 0, now + 1200ms).hasPose);
  EXPECT_FALSE(reports.next(std::nullopt, {}, 0, now + 1300ms).hasPose);
}

TEST(RobotReports, NamePartsThatDoNotAnswer) {
  RobotReports reports("robot7");
  std::map<std::string, StatusAnswer> parts;
  parts["memory"].report.emplace();
  parts["memory"].report->state = RunState::kDegraded;
  parts["memory"].report->reason = "Camera is lost";
  parts["base"].failure = "connection refused";
  const auto report = reports.next(std::nullopt, parts, 0, {});
  ASSERT_EQ(report.parts.size(), 2U);
  EXPECT_EQ(report.parts[0].name, "base");
  EXPECT_EQ(report.parts[0].state, avm::ComponentState::Stopping);
  EXPECT_EQ(report.parts[0].reason, "connection refused");
  EXPECT_EQ(report.parts[1].state, avm::ComponentState::Degraded);
  EXPECT_EQ(report.parts[1].reason, "Camera is lost");
}

}  // namespace
}  // namespace vismem
