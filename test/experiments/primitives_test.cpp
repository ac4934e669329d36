// Tests M8, M9.
#include "experiments/experiment_program.h"

namespace vismem {
namespace {

TEST_F(ExperimentProgram, PrimitivesFindsTheShapesOfTheRoom) {
  const std::string out = (folder_ / "primitives").string();
  ASSERT_EQ(run("primitives --seed 1 --variant open --out " + out), 0) << content("stderr");
  const auto open = lastLine()["open"];
  EXPECT_EQ(open["circle"]["found"], 1) << open;
  EXPECT_GE(open["all"]["found"].get<int>() + 1, open["all"]["shown"].get<int>()) << open;
  EXPECT_LE(open["all"]["false"].get<int>(), 1) << open;
  EXPECT_THAT(content("primitives/shapes.csv"), HasSubstr("\nopen,circle,circle,right,"));
  EXPECT_FALSE(cv::imread(out + "/shapes_open.png").empty());
  EXPECT_EQ(run("primitives --variant nobody --out " + out), 2);
}

}  // namespace
}  // namespace vismem
