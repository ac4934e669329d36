#include "evaluation/core/truth_file.h"

#include <gmock/gmock.h>

#include "common/config/config_error.h"

namespace vismem {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::vector<std::string> problemsOf(std::string_view text) {
  try {
    parseTruth(text, "truth.csv");
  } catch (const ConfigError& error) {
    return error.problems();
  }
  return {};
}

TEST(TruthFile, ReadsTheFirstFourColumnsWithoutAHeader) {
  const Trajectory truth = parseTruth("# by hand\n0,1,2,0.5\n\n0.5,1.5,2,0.6,fast,7\r\n", "truth.csv");
  ASSERT_EQ(truth.size(), 2u);
  EXPECT_EQ(truth[1].stamp_us, 500'000);
  EXPECT_DOUBLE_EQ(truth[1].pose.x, 1.5);
  EXPECT_DOUBLE_EQ(truth[1].pose.theta, 0.6);
}

TEST(TruthFile, FindsItsColumnsAmongOthers) {
  const Trajectory truth = parseTruth(
      "frame,t_s,z_m,y_m,x_m,theta_rad,note\n1,10,0,2,1,0.5,start\n2,11,0,4,3,-0.5,\n", "truth.csv");
  ASSERT_EQ(truth.size(), 2u);
  EXPECT_DOUBLE_EQ(truth[0].pose.x, 1.0);
  EXPECT_DOUBLE_EQ(truth[0].pose.y, 2.0);
  EXPECT_DOUBLE_EQ(truth[1].pose.theta, -0.5);
}

TEST(TruthFile, NamesWhatIsWrong) {
  EXPECT_THAT(problemsOf("t_s,x_m,y_m\n0,1,2\n"),
              ElementsAre("truth.csv:1: \"t_s,x_m,y_m\" lacks the columns theta_rad"));
  EXPECT_THAT(problemsOf("0,1,2,3\n1,1,two,3\n2,1,2\n0.5,1,2,3\n3,1,2,3\n2.5,1,2,3\n"),
              ElementsAre(HasSubstr("truth.csv:2: \"1,1,two,3\" (expected numbers t_s,x_m,y_m,theta_rad"),
                          HasSubstr("truth.csv:3:"), HasSubstr("truth.csv:6:")));
  EXPECT_THAT(problemsOf("0,1,2,3\n"), ElementsAre("truth.csv: 1 poses (expected at least two)"));
}

}  // namespace
}  // namespace vismem
