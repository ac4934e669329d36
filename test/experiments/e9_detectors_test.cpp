// Tests E9.
#include "experiments/experiment_program.h"

namespace vismem {
namespace {

TEST_F(ExperimentProgram, E9ComparesTheDetectorsOnSimulatedImagesWithoutAnyData) {
  const std::string out = (folder_ / "e9").string();
  ASSERT_EQ(run("E9 --seed 3 --data /nowhere --out " + out), 0) << content("stderr");
  const nlohmann::json json = lastLine();
  EXPECT_EQ(json["experiment"], "E9");
  EXPECT_EQ(json["seed"], 3);
  EXPECT_THAT(json["absent"].dump(), HasSubstr("/nowhere/york_urban_half: not there"));
  EXPECT_THAT(json["absent"].dump(), HasSubstr("/nowhere/nao_field_2009: not there"));
  ASSERT_GE(json["images"].size(), 2u);
  for (const auto& image : json["images"]) {
    ASSERT_EQ(image["detectors"].size(), 3u) << image;
    if (image["image"] == "texture") continue;
    // As in the chapter's figure 3: Hough finds few of the lines, Solis most.
    EXPECT_GT(image["detectors"]["solis"]["recall_2px"], image["detectors"]["hough"]["recall_2px"]) << image;
    EXPECT_LE(image["detectors"]["solis"]["fragments_per_line"], 1.5) << image;
    // Figure 10: merging leaves fewer.
    EXPECT_LT(image["merging"]["chapter"]["after"]["labelled"],
              image["merging"]["chapter"]["before"]["labelled"]);
  }
  for (const char* picture : {"figure3.png", "figure10.png", "figure3_room.png", "figure3_corridor.png"}) {
    EXPECT_FALSE(cv::imread(out + "/" + picture).empty()) << picture;
  }
  EXPECT_THAT(content("e9/counts.csv"), HasSubstr("\nroom,hough,"));
  EXPECT_THAT(content("e9/merging.csv"), HasSubstr("\ncorridor,chapter,after,"));
  EXPECT_THAT(content("e9/segments.csv"), HasSubstr("\nroom,solis,"));
  EXPECT_EQ(nlohmann::json::parse(content("e9/result.json")), json);

  // The same seed gives the same bytes.
  const std::string first = content("e9/segments.csv");
  ASSERT_EQ(run("E9 --seed 3 --data /nowhere --out " + out), 0);
  EXPECT_EQ(content("e9/segments.csv"), first);
  ASSERT_EQ(run("E9 --seed 4 --data /nowhere --mode chapter --out " + out), 0);
  EXPECT_NE(content("e9/segments.csv"), first);
  EXPECT_FALSE(lastLine()["images"][0]["merging"].contains("solis"));
}

}  // namespace
}  // namespace vismem
