#include "common/tool/progress_line.h"

#include <gtest/gtest.h>

namespace vismem {
namespace {

TEST(ProgressText, SaysHowLongTheRestTakesAsIfItWentOnLikeThis) {
  EXPECT_EQ(progressText("steps", 0, 150, 60.0), "steps: 0 of 150");
  EXPECT_EQ(progressText("steps", 3, 150, 4.0), "steps: 3 of 150") << "too early for an estimate";
  EXPECT_EQ(progressText("steps", 50, 150, 120.0), "steps: 50 of 150, 4 min left");
  EXPECT_EQ(progressText("steps", 75, 150, 95.0), "steps: 75 of 150, 100 s left");
  EXPECT_EQ(progressText("steps", 149, 150, 298.0), "steps: 149 of 150, 10 s left");
  EXPECT_EQ(progressText("steps", 150, 150, 300.0), "steps: 150 of 150, 0 s left");
}

}  // namespace
}  // namespace vismem
