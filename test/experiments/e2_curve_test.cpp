// Tests E2.
#include "experiments/experiment_program.h"

namespace vismem {
namespace {

TEST_F(ExperimentProgram, E2TakesTheCurveByTheMemoryWhichHoldsMoreThanTheImage) {
  const std::string out = (folder_ / "e2").string();
  ASSERT_EQ(run("E2 --seed 1 --variant memory --out " + out), 0) << content("stderr");
  const auto memory = lastLine()["memory"];
  EXPECT_EQ(memory["taken"], true) << memory;
  EXPECT_EQ(memory["touched"], false) << memory;
  // At the beginning of the curve the image does not show the inner wall; the memory holds it.
  EXPECT_GT(memory["inner_only_remembered_m"].get<double>(), 0.5) << memory;
  EXPECT_GT(memory["inner_only_remembered_m"].get<double>(), memory["inner_in_image_m"].get<double>())
      << memory;
  EXPECT_FALSE(cv::imread(out + "/memory.png").empty());
  EXPECT_EQ(run("E2 --variant nowhere --out " + out), 2);
  EXPECT_THAT(content("stderr"), HasSubstr("E2 has no variant \"nowhere\""));
}

}  // namespace
}  // namespace vismem
