// Tests E7, E8.
#include "experiments/experiment_program.h"

namespace vismem {
namespace {

TEST_F(ExperimentProgram, E7FindsTheDoorAmongSimilarOnes) {
  const std::string out = (folder_ / "e7").string();
  ASSERT_EQ(run("E7 --seed 1 --variant door --out " + out), 0) << content("stderr");
  const auto door = lastLine()["door"];
  for (const char* measure : {"chapter", "likelihood", "explained"}) {
    EXPECT_LT(door[measure]["best_off_m"].get<double>(), 0.1) << measure;
    EXPECT_LT(door[measure]["places_as_good_share"].get<double>(), 0.001) << measure;
  }
  EXPECT_FALSE(cv::imread(out + "/figure22_26.png").empty());
  EXPECT_EQ(run("E7 --variant nowhere --out " + out), 2);
}

TEST_F(ExperimentProgram, E7FalseSegmentsSpreadTheChaptersHealthOverThePlaces) {
  const std::string out = (folder_ / "e7").string();
  ASSERT_EQ(run("E7 --seed 1 --variant false --out " + out), 0) << content("stderr");
  const auto scene = lastLine()["false"];
  for (const char* measure : {"chapter", "likelihood", "explained"}) {
    EXPECT_LE(scene[measure]["at_truth"].get<double>(), scene[measure]["best"].get<double>()) << measure;
  }
  EXPECT_LT(scene["likelihood"]["places_as_good_share"].get<double>(),
            0.1 * scene["chapter"]["places_as_good_share"].get<double>())
      << scene;
}

TEST_F(ExperimentProgram, E8FindsTheTruePlaceFromTheMemoryBehindAnOcclusion) {
  const std::string out = (folder_ / "e8").string();
  ASSERT_EQ(run("E8 --seed 1 --variant occlusion --out " + out), 0) << content("stderr");
  const auto scene = lastLine()["occlusion"];
  EXPECT_FALSE(lastLine().contains("normal"));
  EXPECT_LT(scene["memory_likelihood"]["best_off_m"].get<double>(), 0.2) << scene;
  EXPECT_GT(scene["image_chapter"]["best_off_m"].get<double>(),
            scene["memory_likelihood"]["best_off_m"].get<double>())
      << "one image with a robot in it misleads";
  EXPECT_FALSE(cv::imread(out + "/figure27.png").empty());
  EXPECT_EQ(run("E8 --variant nowhere --out " + out), 2);
  EXPECT_THAT(content("stderr"), HasSubstr("E8 has no variant \"nowhere\""));
}

}  // namespace
}  // namespace vismem
