// Tests A1, A6.
#include "active_visual_memory/core/gaze/gaze_requests.h"

#include <gtest/gtest.h>

#include <cmath>

namespace vismem {
namespace {

TEST(GazeRequestQueue, RejectsInvalidRequestsWithTheReason) {
  GazeRequestQueue queue;
  GazeRequest request;
  EXPECT_EQ(queue.request(request).message, "client is empty");
  request.client = "test";
  EXPECT_EQ(queue.request(request).message, "neither a place nor a direction to look at");
  request.direction = PanTilt{};
  request.priority = 0.0;
  EXPECT_NE(queue.request(request).message.find("must be > 0"), std::string::npos);
  request.priority = 1.0;
  EXPECT_TRUE(queue.request(request).ok());
  EXPECT_FALSE(queue.fixate({NAN, 0, 0}).ok());
  EXPECT_FALSE(queue.setMode(GazeMode::kFixate).ok()) << "nothing was fixated so far";
  EXPECT_EQ(queue.take().size(), 1u);
  EXPECT_TRUE(queue.take().empty());
}

TEST(GazeRequestQueue, RejectsADeadlineThatHasPassed) {
  GazeRequestQueue queue;
  GazeRequest request;
  request.client = "test";
  request.direction = PanTilt{};
  EXPECT_TRUE(queue.request(request).ok()) << "no image yet: nothing is past";
  GazeStatus status;
  status.stamp_us = 2'000'000;
  queue.publish(status, {0, 0});
  request.deadline_us = 1'999'999;
  EXPECT_EQ(queue.request(request).message, "deadlineUs = 1999999 has passed (the newest image has 2000000)");
  request.deadline_us = 2'000'000;
  EXPECT_TRUE(queue.request(request).ok());
}

TEST(GazeRequestQueue, RejectsPlacesThatAreFarFromTheRobot) {
  GazeRequestQueue queue;
  EXPECT_EQ(queue.fixate({1500, 0, 0}).message,
            "place 1500 0 0 is 1500 m from the robot (must be within 1000 m)");
  EXPECT_EQ(queue.fixate({0, 0, -2000}).message,
            "place 0 0 -2000 is 2000 m from the robot (must be within 1000 m)");
  queue.publish({}, {1200, 0});
  EXPECT_TRUE(queue.fixate({1500, 0, 0}).ok()) << "the robot has come nearer";
  GazeRequest request;
  request.client = "test";
  request.p_odom = Eigen::Vector3d(0, 0, 0);
  EXPECT_EQ(queue.request(request).message, "place 0 0 0 is 1200 m from the robot (must be within 1000 m)");
}

}  // namespace
}  // namespace vismem
