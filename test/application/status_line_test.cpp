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
  estimate.reliability = 0.75;
  live.estimate = estimate;
  live.error = PoseError{0, 0.1, 0.0, 0.75};
  GazeStatus gaze;
  gaze.state = GazeState::kTrack;
  gaze.target.emplace();
  gaze.target->p_odom = Eigen::Vector3d(1, 2, 0);
  const std::string text = statusText(live, gaze);
  EXPECT_THAT(text, testing::HasSubstr("gaze tracks segment at 1.0 2.0"));
  EXPECT_THAT(text, testing::HasSubstr("pose 1.25 -0.50 m 90 deg, reliability 0.75"));
  EXPECT_THAT(text, testing::HasSubstr("error 0.10 m 0.0 deg"));
}

TEST(StatusLine, RewritesATerminalsLineAndEndsIt) {
  std::ostringstream terminal;
  StatusLine line(terminal, true);
  line.show("one");
  line.show("two");
  line.end();
  EXPECT_EQ(terminal.str(), "\r\033[Kone\r\033[Ktwo\n");
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
