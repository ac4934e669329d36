// Tests E5, L11.
#include "experiments/experiment_program.h"

namespace vismem {
namespace {

TEST_F(ExperimentProgram, E5TravelsTheCorridorBetterThanPublished) {
  const std::string out = (folder_ / "e5").string();
  ASSERT_EQ(run("E5 --variant synthetic --trials 1 --methods default --out " + out), 0) << content("stderr");
  const auto synthetic = lastLine()["synthetic"];
  EXPECT_EQ(synthetic["default"]["events"], 1) << synthetic;
  EXPECT_LT(synthetic["default"]["position_error_m"]["value"].get<double>(), 0.118) << synthetic;
  EXPECT_LT(synthetic["default"]["heading_error_deg"]["value"].get<double>(), 2.1) << synthetic;
  EXPECT_DOUBLE_EQ(synthetic["published"]["position_error_m"].get<double>(), 0.118);
  EXPECT_FALSE(synthetic["published"].contains("median_s")) << synthetic;
  EXPECT_EQ(synthetic["default"]["better_than_published"], true);
  EXPECT_THAT(content("e5/travel_synthetic_events.csv"), HasSubstr("\ndefault,1001,0,"));
  EXPECT_FALSE(cv::imread(out + "/travel_synthetic_default.png").empty());
}

}  // namespace
}  // namespace vismem
