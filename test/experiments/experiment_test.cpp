// The program `experiment`: its command line, and the origin of its results.
#include "experiments/experiment_program.h"

namespace vismem {
namespace {

TEST_F(ExperimentProgram, NamesWhatIsWrongWithItsArguments) {
  EXPECT_NE(run("E99"), 0);
  EXPECT_THAT(content("stderr"), HasSubstr("E9"));
  EXPECT_NE(run(""), 0);
  EXPECT_EQ(run("E9 --out /proc/nowhere"), 1);
  EXPECT_THAT(content("stderr"), HasSubstr("/proc/nowhere"));
  EXPECT_EQ(run("--help"), 0);
  EXPECT_THAT(content("stdout"), HasSubstr("E9  Canny+Hough beside Solis"));
}

TEST_F(ExperimentProgram, RefusesOptionsThatTheExperimentDoesNotRead) {
  const auto refusal = [this](const std::string& arguments) {
    EXPECT_EQ(run(arguments), 2) << arguments;
    return content("stderr");
  };
  EXPECT_THAT(refusal("E1 --trials 3"), HasSubstr("--trials: E1 has no trials (must be E5 or E6 or map)"));
  EXPECT_THAT(refusal("E5 --gaze both"), HasSubstr("--gaze: E5 has no gaze policies (must be E6)"));
  EXPECT_THAT(refusal("map --methods default"), HasSubstr("--methods: map has no methods to compare"));
  EXPECT_THAT(refusal("E7 --variants x"), HasSubstr("--variants: E7 has no file of variants"));
  EXPECT_THAT(refusal("E9 --variant room"), HasSubstr("--variant: E9 has no variants"));
}

TEST_F(ExperimentProgram, LeavesNoFolderOfARefusedVariant) {
  const std::filesystem::path out = folder_ / "refused";
  for (const char* name : {"E1", "E5", "E7"}) {
    EXPECT_EQ(run(std::string(name) + " --variant nowhere --out " + out.string()), 2) << name;
    EXPECT_FALSE(std::filesystem::exists(out)) << name;
  }
}

TEST_F(ExperimentProgram, ResultsNameCommitAndCommand) {
  const std::string out = (folder_ / "e9").string();
  ASSERT_EQ(run("E9 --seed 3 --data=/nowhere --out " + out + " --commit abc1234 --mode chapter"), 0);
  EXPECT_EQ(lastLine()["commit"], "abc1234");
  EXPECT_EQ(lastLine()["command"], "experiment E9 --seed 3 --mode chapter");
  EXPECT_EQ(nlohmann::json::parse(content("e9/result.json"))["commit"], "abc1234");
  ASSERT_EQ(run("E9 --seeds 3..3 --data /nowhere --out " + out), 0);
  EXPECT_THAT(lastLine()["commit"].get<std::string>(), testing::MatchesRegex("[0-9a-zA-Z.+-]+"));
  EXPECT_EQ(lastLine()["command"], "experiment E9 --seeds 3..3");
}

}  // namespace
}  // namespace vismem
