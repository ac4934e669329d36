#include "application/app/status_line.h"

#include <gmock/gmock.h>

#include <numbers>
#include <sstream>

namespace vismem {
namespace {

TEST(StatusText, SaysWhatTheRobotKnows) {
  LiveState live;
  live.first_us = kSecondUs;
  live.now_us = 3'500'000;
  live.memory_segments = 42;
  EXPECT_THAT(statusText(live, std::nullopt),
              testing::AllOf(testing::HasSubstr("2.5 s"), testing::HasSubstr("no pose"),
                             testing::HasSubstr("42 segments")));
  PoseEstimate estimate;
  estimate.T_world_robot = Pose2{1.25, -0.5, std::numbers::pi / 2};
  estimate.stamp_us = live.now_us;
  estimate.reliability = 0.75;
  live.estimate = estimate;
  live.error = PoseError{0, 0.1, 0.0, 0.75};
  GazeStatus gaze;
  gaze.state = GazeState::kTrack;
  gaze.target.emplace();
  const std::string text = statusText(live, gaze);
  EXPECT_THAT(text, testing::EndsWith("gaze tracks segment"));
  EXPECT_THAT(text,
              testing::HasSubstr("| pose 1.25 -0.50 m 90 deg, reliability 0.75 | error 0.10 m 0.0 deg |"));
}

// As the first images show it, before anything was localized.
TEST(StatusText, AGuessIsNotCalledAPose) {
  LiveState live;
  PoseEstimate estimate;
  estimate.T_world_robot = Pose2{4.32, -1.64, 0.0};
  estimate.reliability = 0.5;
  live.estimate = estimate;
  EXPECT_THAT(statusText(live, std::nullopt),
              testing::StartsWith("   0.0 s | not sure, best guess 4.32 -1.64 m 0 deg, reliability 0.50 |"));
}

TEST(StatusText, APausedRobotHasNoRates) {
  LiveState live;
  live.camera_hz = 30.0;
  live.memory_hz = 29.5;
  EXPECT_THAT(statusText(live, std::nullopt), testing::HasSubstr("| camera 30.0 Hz | memory 29.5 Hz, "));
  live.is_paused = true;
  EXPECT_THAT(statusText(live, std::nullopt),
              testing::AllOf(testing::StartsWith("   0.0 s, paused | no pose |"),
                             testing::HasSubstr("| camera  0.0 Hz | memory  0.0 Hz, ")));
}

// As of a localization that hangs.
TEST(StatusText, AnOldPoseHasItsAge) {
  LiveState live;
  live.first_us = 0;
  live.now_us = 12 * kSecondUs;
  PoseEstimate estimate;
  estimate.T_world_robot = Pose2{1.25, -0.5, 0.0};
  estimate.reliability = 0.75;
  estimate.stamp_us = 11 * kSecondUs;
  live.estimate = estimate;
  EXPECT_THAT(statusText(live, std::nullopt), testing::HasSubstr("reliability 0.75 | camera"));
  live.estimate->stamp_us = 5 * kSecondUs;
  EXPECT_THAT(statusText(live, std::nullopt), testing::HasSubstr("reliability 0.75 7 s ago | camera"));
}

TEST(StatusText, ZeroHasNoSign) {
  LiveState live;
  PoseEstimate estimate;
  estimate.T_world_robot = Pose2{-0.004, -0.001, -0.001};
  estimate.reliability = 1.0;
  live.estimate = estimate;
  EXPECT_THAT(statusText(live, std::nullopt), testing::HasSubstr("pose 0.00 0.00 m 0 deg"));
}

TEST(StatusText, SaysThatThePoseIsATwinsOfTheTrueOne) {
  // A map that looks the same after half a turn about the origin.
  const std::vector<Pose2> half_turn{{0.0, 0.0, std::numbers::pi}};
  PoseEstimate estimate;
  estimate.T_world_robot = Pose2{-2.0, 1.1, 0.1 - std::numbers::pi};
  const Pose2 truth{2.0, -1.0, 0.0};
  const TwinError twin = errorToNearestTwin(estimate, truth, half_turn);
  EXPECT_TRUE(twin.is_twin);
  EXPECT_NEAR(*twin.error.position_m, 0.1, 1e-9);
  EXPECT_NEAR(*twin.error.heading_rad, 0.1, 1e-9);
  EXPECT_FALSE(errorToNearestTwin(estimate, truth, {}).is_twin);
  LiveState live;
  live.estimate = estimate;
  live.error = twin.error;
  live.is_twin = twin.is_twin;
  EXPECT_THAT(
      statusText(live, std::nullopt),
      testing::HasSubstr("error 0.10 m 5.7 deg of the twin place, from which the map looks the same |"));
  estimate.T_world_robot = Pose2{2.0, -1.1, 0.0};
  EXPECT_FALSE(errorToNearestTwin(estimate, truth, half_turn).is_twin);
}

TEST(StatusLine, RewritesATerminalsLineAndEndsIt) {
  std::ostringstream terminal;
  StatusLine line(terminal, true);
  line.show("one");
  line.show("two");
  line.end();
  EXPECT_EQ(terminal.str(), "\r\033[K\033[?7lone\033[?7h\r\033[K\033[?7ltwo\033[?7h\n");
  std::ostringstream file;
  StatusLine plain(file, false);
  plain.show("one");
  plain.end();
  EXPECT_EQ(file.str(), "one\n");
  const auto now = std::chrono::steady_clock::now();
  EXPECT_TRUE(plain.due(now));
  EXPECT_FALSE(plain.due(now + std::chrono::milliseconds(900)));
  EXPECT_TRUE(plain.due(now + std::chrono::milliseconds(1000)));
}

}  // namespace
}  // namespace vismem
