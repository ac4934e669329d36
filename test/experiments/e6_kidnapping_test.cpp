// Tests E6, L11.
#include "experiments/experiment_program.h"

namespace vismem {
namespace {

TEST_F(ExperimentProgram, E6GivesTheRecordToTheMethodsThatWereAskedForAlone) {
  const std::string out = (folder_ / "e6").string();
  ASSERT_EQ(run("E6 --variant rendered_room --trials 1 --methods default --out " + out), 0)
      << content("stderr");
  const auto room = lastLine()["rendered_room"];
  EXPECT_EQ(room["default"]["events"], 4) << room;
  EXPECT_FALSE(room.contains("mcl_stock")) << room;
  // Beside the chapter's figures.
  EXPECT_DOUBLE_EQ(room["published"]["position_error_m"].get<double>(), 0.149);
  EXPECT_DOUBLE_EQ(room["published"]["median_s"].get<double>(), 29.6);
  EXPECT_LT(room["default"]["position_error_m"]["value"].get<double>(), 0.149);
  EXPECT_EQ(room["default"]["better_than_published"], true);
}

TEST_F(ExperimentProgram, E6NamesTheMethodsAndVariantsThatItLacks) {
  const std::string out = (folder_ / "e6").string();
  EXPECT_EQ(run("E6 --variant rendered_room --trials 1 --methods default,mcl --out " + out), 2);
  EXPECT_THAT(content("stderr"),
              HasSubstr("no method \"mcl\" here (there are default, mcl_stock, mcl_tuned)"));
  EXPECT_EQ(run("E6 --variant aliased --out " + out), 2);
  EXPECT_THAT(content("stderr"), HasSubstr("E6 has no variant \"aliased\""));
  const std::string file = (folder_ / "own.variants").string();
  std::ofstream(file) << "E6.Variant.own.Title = mine\nE6.Variant.own.World = nowhere\n";
  EXPECT_EQ(run("E6 --variant other --variants " + file + " --out " + out), 2);
  EXPECT_THAT(content("stderr"), HasSubstr("E6 has no variant \"other\" (there are own)"));
  std::ofstream(file) << "E6.Variant.own.Titel = mine\n";
  EXPECT_EQ(run("E6 --variants " + file + " --out " + out), 2);
  EXPECT_THAT(content("stderr"), HasSubstr(file + ":1: unknown key \"E6.Variant.own.Titel\""));
}

}  // namespace
}  // namespace vismem
