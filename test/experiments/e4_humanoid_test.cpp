// Tests E4.
#include "experiments/experiment_program.h"

namespace vismem {
namespace {

TEST_F(ExperimentProgram, E4RemembersAsAHumanoidAndSaysWhichRecordingIsAbsent) {
  const std::string out = (folder_ / "e4").string();
  ASSERT_EQ(run("E4 --seed 1 --variant corridor --out " + out), 0) << content("stderr");
  const auto corridor = lastLine()["corridor"]["drive"];
  EXPECT_GT(corridor["right"].get<int>() + corridor["unconfirmed_on_edges"].get<int>(), 3) << corridor;
  EXPECT_LT(corridor["duplicates"].get<double>(), 1.5) << corridor;
  EXPECT_FALSE(cv::imread(out + "/figure19_corridor.png").empty());
  ASSERT_EQ(run("E4 --variant nao --data /nowhere --out " + out), 0) << content("stderr");
  EXPECT_THAT(lastLine()["absent"].dump(), HasSubstr("/nowhere/nao_field_2009: not there"));
  EXPECT_EQ(run("E4 --variant nobody --out " + out), 2);
}

TEST_F(ExperimentProgram, E4MeasuresTheRecordingOfTheNao) {
  const char* data = std::getenv("AVM_DATA");
  if (data == nullptr || !fs::exists(fs::path(data) / "nao_field_2009")) {
    GTEST_SKIP() << "AVM_DATA does not name a folder with nao_field_2009";
  }
  const std::string out = (folder_ / "e4").string();
  ASSERT_EQ(run("E4 --variant nao --out " + out), 0) << content("stderr");
  const auto nao = lastLine()["nao"];
  EXPECT_GT(nao["images"].get<int>(), 100);
  EXPECT_EQ(nao["images_without_pose"], 0);
  // The circle of 0.6 m, and the field's lines within 6 cm.
  EXPECT_GT(nao["images_with_circle"].get<int>(), 60) << nao;
  EXPECT_GT(nao["circle_radius_m"]["median"].get<double>(), 0.55) << nao;
  EXPECT_LT(nao["circle_radius_m"]["median"].get<double>(), 0.62) << nao;
  EXPECT_LT(nao["distance_to_map_m"].get<double>(), 0.06) << nao;
  EXPECT_LT(nao["elements_per_edge"]["median"].get<double>(), 1.5) << nao;
  EXPECT_FALSE(cv::imread(out + "/figure19_nao.png").empty());
}

}  // namespace
}  // namespace vismem
