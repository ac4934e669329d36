// Tests E5, L11.
#include "experiments/experiment_program.h"

namespace vismem {
namespace {

TEST_F(ExperimentProgram, E5TravelsTheCorridorBetterThanPublished) {
  const std::string out = (folder_ / "e5").string();
  ASSERT_EQ(run("E5 --variant rendered --trials 1 --methods default --out " + out), 0) << content("stderr");
  const auto rendered = lastLine()["rendered"];
  EXPECT_EQ(rendered["default"]["events"], 1) << rendered;
  EXPECT_LT(rendered["default"]["position_error_m"]["value"].get<double>(), 0.118) << rendered;
  EXPECT_LT(rendered["default"]["heading_error_deg"]["value"].get<double>(), 2.1) << rendered;
  EXPECT_DOUBLE_EQ(rendered["published"]["position_error_m"].get<double>(), 0.118);
  EXPECT_FALSE(rendered["published"].contains("median_s")) << rendered;
  EXPECT_EQ(rendered["default"]["better_than_published"], true);
  EXPECT_THAT(content("e5/travel_rendered_events.csv"), HasSubstr("\ndefault,1001,0,"));
  EXPECT_FALSE(cv::imread(out + "/travel_rendered_default.png").empty());
}

}  // namespace
}  // namespace vismem
