// Tests E1.
#include "experiments/experiment_program.h"

namespace vismem {
namespace {

TEST_F(ExperimentProgram, E1RemembersTheRoomBetterThanOneImageShowsIt) {
  const std::string out = (folder_ / "e1").string();
  ASSERT_EQ(run("E1 --seeds 2..2 --variant room --out " + out), 0) << content("stderr");
  const nlohmann::json json = lastLine();
  EXPECT_EQ(json["seeds"], (nlohmann::json{2, 2}));
  const auto& after = json["over_seeds"]["room"]["drive"];
  // Below the figures of docs/results/E1.md, because of other machines.
  EXPECT_GT(after["precision"]["mean"], 0.8) << after;
  EXPECT_GT(after["recall"]["mean"], 0.6) << after;
  EXPECT_LT(after["duplicates"]["max"], 1.15) << after;
  EXPECT_GT(after["memory_over_image"]["min"], 4.0) << after;
  // From one place a marking and the top of a low box look alike.
  EXPECT_EQ(json["over_seeds"]["room"]["turn"]["right"]["max"], 0.0);
  for (const char* file : {"seed2/figure13.png", "seed2/plan_room.png"}) {
    EXPECT_FALSE(cv::imread(out + "/" + file).empty()) << file;
  }
  EXPECT_THAT(content("e1/seed2/elements.csv"), HasSubstr("\nroom,drive,"));
  EXPECT_EQ(run("E1 --variant nowhere --out " + out), 2);
  EXPECT_THAT(content("stderr"), HasSubstr("nowhere"));
  EXPECT_EQ(run("E1 --seeds 3..1 --out " + out), 2);
  EXPECT_EQ(run("E1 --seeds 1..2 --seed 1 --out " + out), 2);
}

}  // namespace
}  // namespace vismem
