// Tests E5, E6. Variants of trials from configurations.
#include "experiments/app/trial_variants.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/config/config_error.h"
#include "common/config/project_file.h"
#include "support/build_paths.h"

namespace vismem {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::IsSupersetOf;

std::vector<std::string> namesOf(const std::vector<TrialVariant>& variants) {
  std::vector<std::string> names;
  for (const TrialVariant& variant : variants) names.push_back(variant.name);
  return names;
}
std::vector<std::string> methodsOf(const TrialSeries& series) {
  std::vector<std::string> names;
  for (const MethodMaker& method : series.methods({})) names.push_back(method.name);
  return names;
}
std::string problemOf(const std::string& text) {
  try {
    readTrialVariants(Properties::parse(text, "e.cfg"), "E6");
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "no error";
}

TEST(TrialVariants, OfTheShippedFilesAreRead) {
  ExperimentOptions options;
  options.seed = 9;
  const auto travel = chosenTrialVariants("E5", options);
  ASSERT_THAT(namesOf(travel), ElementsAre("rendered"));
  const TrialSeries& series = travel[0].series;
  EXPECT_EQ(series.title, "E5 rendered: humanoid in the corridor; from a known start unless said");
  EXPECT_EQ(series.trial.setup, "humanoid");
  EXPECT_EQ(series.trial.events, 1);
  EXPECT_EQ(series.trial.event_s, 120.0);
  EXPECT_EQ(series.summary.within_s, 120.0);
  EXPECT_FALSE(series.summary.kidnaps_only);
  EXPECT_FALSE(series.published->recovery_s);
  EXPECT_EQ(series.trials, 10);
  EXPECT_EQ(series.seed, 9U);
  EXPECT_THAT(methodsOf(series),
              ElementsAre("default", "default_unknown_start", "chapter", "mcl_stock", "mcl_tuned"));
  EXPECT_THAT(series.known_start, ElementsAre("default", "chapter", "mcl_stock", "mcl_tuned"));

  EXPECT_THAT(namesOf(chosenTrialVariants("E6", options)),
              IsSupersetOf({"rendered", "rendered_aliased", "rendered_false30", "rendered_blackout"}));
  for (const TrialVariant& variant : chosenTrialVariants("E6_gaze", options)) {
    EXPECT_EQ(variant.series.trial.event_s, 30.0) << variant.name;
    EXPECT_FALSE(variant.series.published) << variant.name;
  }
}

TEST(TrialVariants, TheOptionsChooseVariantTrialsAndMethods) {
  ExperimentOptions options;
  options.variant = "rendered_blackout";
  options.trials = 3;
  options.methods = {"default"};
  const auto chosen = chosenTrialVariants("E6", options);
  ASSERT_EQ(chosen.size(), 1U);
  const TrialSeries& series = chosen[0].series;
  EXPECT_EQ(series.trials, 3);
  EXPECT_THAT(series.only, ElementsAre("default"));
  EXPECT_EQ(series.trial.blackout_from_s, 30.0);
  EXPECT_EQ(series.trial.blackout_s, 10.0);
  EXPECT_TRUE(series.summary.kidnaps_only);
  options.variant = "aliased";
  try {
    chosenTrialVariants("E6", options);
    ADD_FAILURE() << "no such variant";
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(),
                HasSubstr("E6 has no variant \"aliased\" (there are rendered, rendered_ablation"));
  }
}

TEST(TrialVariants, AblationsAreAMethodForEachPart) {
  const auto variants = readTrialVariants(
      Properties::parse("E6.Variant.a.Title=x\nE6.Variant.a.Methods=default ablations\n", "e.cfg"), "E6");
  EXPECT_GT(methodsOf(variants[0].series).size(), 5U);
  EXPECT_THAT(readTrialVariants(Properties::parse("", "e.cfg"), "E6"), IsEmpty());
}

TEST(TrialVariants, WrongKeysAreNamedWithTheirLine) {
  EXPECT_EQ(
      problemOf("E6.Variant.a.Title = x\nE6.Variant.a.Wrld = room\nE6.Variant.a.FalseShare = 1\n"
                "E6.Variant.a.Methods = default amcl\nE6.Variant.a.Published = figure\nE5.x = 1\n"),
      "e.cfg:2: unknown key \"E6.Variant.a.Wrld\" (did you mean \"E6.Variant.a.World\"?)\n"
      "e.cfg:3: E6.Variant.a.FalseShare = 1 (must be 0..0.95)\n"
      "e.cfg:4: E6.Variant.a.Methods = default amcl (must be some of default default_unknown_start chapter "
      "mcl_stock mcl_tuned ablations)\n"
      "e.cfg:5: E6.Variant.a.Published = figure (must be one of: none, travel, kidnapping)\n"
      "e.cfg:6: unknown key \"E5.x\" (must begin with E6.)");
  EXPECT_THAT(problemOf("E6.Variant.a.Trials = 3\n"), HasSubstr("missing key \"E6.Variant.a.Title\""));
}

}  // namespace
}  // namespace vismem
