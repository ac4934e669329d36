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

}  // namespace
}  // namespace vismem
