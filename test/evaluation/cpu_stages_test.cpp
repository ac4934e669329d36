#include "evaluation/app/cpu_stages.h"

#include <gtest/gtest.h>

namespace vismem {
namespace {

void compute(double seconds) {
  const double end = CpuStages::now_s() + seconds;
  while (CpuStages::now_s() < end) {
  }
}

TEST(CpuStages, AddsUpTheTimeOfEachStage) {
  CpuStages stages;
  EXPECT_TRUE(stages.seconds().empty());
  stages.enter("a");
  compute(0.02);
  stages.enter("b");
  compute(0.01);
  stages.enter("a");
  compute(0.02);
  const auto seconds = stages.seconds();
  ASSERT_EQ(seconds.size(), 2u);
  // CPU time: a busy machine does not change it.
  EXPECT_NEAR(seconds.at("a"), 0.04, 0.005);
  EXPECT_NEAR(seconds.at("b"), 0.01, 0.005);
}

}  // namespace
}  // namespace vismem
