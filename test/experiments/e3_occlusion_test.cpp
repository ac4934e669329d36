// Tests E3.
#include "experiments/experiment_program.h"

namespace vismem {
namespace {

TEST_F(ExperimentProgram, E3ARobotThatDrivesAheadDoesNotDragTheMemoryAlong) {
  const std::string out = (folder_ / "e3").string();
  ASSERT_EQ(run("E3 --seed 3 --variant drive --out " + out), 0) << content("stderr");
  const auto drive = lastLine()["drive"];
  EXPECT_GT(drive["view_occluded_share"].get<double>(), 0.8) << drive;
  EXPECT_GT(drive["survived"].get<double>(), 0.9) << drive;
  EXPECT_GT(drive["survived_in_place"].get<double>(), 0.85) << drive;
  EXPECT_LT(drive["after"]["duplicates"].get<double>(), 1.1) << drive;
  EXPECT_FALSE(cv::imread(out + "/figure16_18_drive.png").empty());
}

}  // namespace
}  // namespace vismem
