// Tests C2.
#include "localization/app/config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "common/config/config_error.h"
#include "common/geometry/angles.h"
#include "support/build_paths.h"

namespace vismem {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

const std::string kSource = VISMEM_SOURCE_DIR;
const std::string kNeeded =
    "Localization.VisualMemory.Proxy = VisualMemory:tcp -p 9970\n"
    "Localization.Map = " +
    kSource + "/cfg/maps/corridor.csv\n";

LocalizationConfig parse(const std::string& text) {
  const Properties properties = Properties::parse(text, "test.cfg");
  ConfigReader root(properties);
  ConfigReader reader = root.group("Localization");
  LocalizationConfig config = readLocalizationConfig(reader);
  reader.finish();
  return config;
}

std::vector<std::string> problemsOf(const std::string& text) {
  try {
    parse(text);
  } catch (const ConfigError& error) {
    return error.problems();
  }
  return {};
}

TEST(LocalizationConfig, DefaultsAreThePresets) {
  const LocalizationConfig ours = parse(kNeeded);
  EXPECT_EQ(ours.params.mode, LocalizationMode::kDefault);
  EXPECT_FALSE(ours.start);
  EXPECT_EQ(ours.params.explorers.count_lost,
            localizerPreset(LocalizationMode::kDefault).explorers.count_lost);
  const LocalizationConfig chapter = parse(kNeeded + "Localization.Mode = chapter\n");
  EXPECT_EQ(chapter.params.mode, LocalizationMode::kChapter);
  EXPECT_EQ(chapter.params.explorers.count_lost, 1000);
  EXPECT_DOUBLE_EQ(chapter.params.races.delete_health, 0.6);
}

TEST(LocalizationConfig, GazeIsRequestedOnlyWithAProxy) {
  EXPECT_TRUE(parse(kNeeded).gaze_proxy.empty());
  const LocalizationConfig config = parse(kNeeded +
                                          "Localization.Gaze.Proxy = Gaze:tcp -p 9970\n"
                                          "Localization.Gaze.UncertaintyAbove = 0.4\n");
  EXPECT_EQ(config.gaze_proxy, "Gaze:tcp -p 9970");
  EXPECT_DOUBLE_EQ(config.gaze.uncertainty_above, 0.4);
  EXPECT_THAT(problemsOf(kNeeded + "Localization.Gaze.UncertaintyAbove = 2\n"),
              ElementsAre(HasSubstr("Localization.Gaze.UncertaintyAbove")));
}

TEST(LocalizationConfig, AKeyOverridesThePreset) {
  const LocalizationConfig config = parse(kNeeded +
                                          "Localization.Robust.CameraSigma_deg = 2\n"
                                          "Localization.Health.Source = memory\n"
                                          "Localization.Start.Position_m = 1.5 -2\n"
                                          "Localization.Start.Heading_deg = 90\n");
  EXPECT_NEAR(config.params.robust.observation.camera_sigma_rad, degToRad(2), 1e-12);
  EXPECT_EQ(config.params.health.source, ObservationSource::kMemory);
  ASSERT_TRUE(config.start);
  EXPECT_DOUBLE_EQ(config.start->y, -2.0);
  EXPECT_NEAR(config.start->theta, degToRad(90), 1e-12);
}

/// A renamed key with a value in its range, and where it arrives.
struct Renamed {
  const char* old_name;
  const char* new_name;
  double value;
  double (*read)(const LocalizationConfig& config);
};

Renamed alias(const char* old_name, const char* new_name, double value,
              double (*read)(const LocalizationConfig& config)) {
  return {old_name, new_name, value, read};
}

const Renamed kRenamed[] = {
    alias("Robust.LeanSway_deg", "Robust.CameraTilt.PerFrame_deg", 1.25,
          [](const auto& c) { return radToDeg(c.params.robust.likelihood.frame_tilt_rad); }),
    alias("Robust.BirthPenalty", "Robust.JumpLogPrior", 3.5,
          [](const auto& c) { return c.params.robust.history.jump_log_prior; }),
    alias("Gaze.DoubtAbove", "Gaze.UncertaintyAbove", 0.4,
          [](const auto& c) { return c.gaze.uncertainty_above; }),
};

TEST(LocalizationConfig, TakesRenamedKeysUnderBothNamesAndWarnsOfTheOldOne) {
  for (const Renamed& key : kRenamed) {
    for (const char* name : {key.old_name, key.new_name}) {
      const std::string text = std::string("Localization.") + name + " = " + std::to_string(key.value) + "\n";
      const bool is_switch = std::string(key.old_name) == "Odometry.Learn";
      const std::string line = is_switch ? std::string("Localization.") + name + " = no\n" : text;
      const Properties properties = Properties::parse(kNeeded + line, "test.cfg");
      ConfigReader root(properties);
      ConfigReader reader = root.group("Localization");
      const LocalizationConfig config = readLocalizationConfig(reader);
      reader.finish();
      EXPECT_NEAR(key.read(config), key.value, 1e-9) << name;
      const auto warnings = reader.renamedKeys();
      if (name == key.new_name) {
        EXPECT_TRUE(warnings.empty()) << name;
        continue;
      }
      ASSERT_EQ(warnings.size(), 1u) << name;
      EXPECT_THAT(warnings[0].message,
                  HasSubstr(std::string("is now called \"Localization.") + key.new_name));
    }
  }
}

TEST(LocalizationConfig, RemovedKeysAreAcceptedWithAWarningAndHaveNoEffect) {
  const Properties properties = Properties::parse(kNeeded +
                                                      "Localization.Races.SamePlace_m = 5\n"
                                                      "Localization.Robust.Kalman = no\n"
                                                      "Localization.Cell_m = 4\n",
                                                  "test.cfg");
  ConfigReader root(properties);
  ConfigReader reader = root.group("Localization");
  const LocalizationConfig config = readLocalizationConfig(reader);
  EXPECT_NO_THROW(reader.finish());
  const LocalizerParams preset = localizerPreset(LocalizationMode::kDefault);
  EXPECT_EQ(config.params.races.same_place_m, preset.races.same_place_m);
  const auto warnings = reader.renamedKeys();
  ASSERT_EQ(warnings.size(), 3u);
  for (const Problem& warning : warnings)
    EXPECT_THAT(warning.message, HasSubstr("its value is fixed by the mode"));
}

TEST(LocalizationConfig, KeysOfPartsThatAreGoneSaySo) {
  for (const std::string key : {"Robust.KldError", "SuspectTick_s", "SuspectTime_s",
                                "DoubtTick_s", "Doubt_s"}) {  // old names
    const Properties properties = Properties::parse(kNeeded + "Localization." + key + " = 0\n", "test.cfg");
    ConfigReader root(properties);
    ConfigReader reader = root.group("Localization");
    readLocalizationConfig(reader);
    const auto warnings = reader.renamedKeys();
    ASSERT_EQ(warnings.size(), 1u) << key;
    EXPECT_THAT(warnings[0].message, HasSubstr("the part that it belonged to is gone")) << key;
  }
}

TEST(LocalizationConfig, TheSimulatorsSetupShowsEveryBasicKeyWithItsValue) {
  const Properties properties = Properties::load(kSource + "/cfg/sim/localization.cfg");
  ConfigReader root(properties);
  ConfigReader reader = root.group("Localization");
  readLocalizationConfig(reader);
  int basic_keys = 0;
  for (const KeyDescription& one : reader.keys()) {
    EXPECT_FALSE(one.meaning.empty()) << one.key << " says nothing of itself";
    if (!one.is_basic) continue;
    ++basic_keys;
    EXPECT_NE(properties.find(one.key), nullptr) << one.key << " is not in cfg/sim";
  }
  EXPECT_GT(basic_keys, 5);
}

TEST(LocalizationConfig, AllProblemsAreReportedWithTheirLines) {
  const std::vector<std::string> problems = problemsOf(
      "Localization.Races.Maximum = 0\n"
      "Localization.Mode = best\n"
      "Localization.Robust.Foretting = 0.2\n"
      "Localization.Robust.OutlierShare = 0.95\n");
  EXPECT_THAT(problems, Contains(HasSubstr("test.cfg:1: Localization.Races.Maximum = 0")));
  EXPECT_THAT(problems, Contains(HasSubstr("test.cfg:2: Localization.Mode = best")));
  EXPECT_THAT(problems, Contains(HasSubstr("Localization.Robust.Foretting")));
  EXPECT_THAT(problems, Contains(HasSubstr("Localization.Robust.OutlierShare")));
  EXPECT_THAT(problems, Contains(HasSubstr("Localization.VisualMemory.Proxy")));
  EXPECT_THAT(problems, Contains(HasSubstr("Localization.Map")));
}

TEST(LocalizationConfig, TheShippedSetupOfTheSimulatorLoads) {
  const Properties properties = Properties::load(kSource + "/cfg/sim/localization.cfg");
  ConfigReader root(properties);
  ConfigReader reader = root.group("Localization");
  const LocalizationConfig config = readLocalizationConfig(reader);
  EXPECT_TRUE(reader.good());
  const LoadedMap loaded = loadMapEdges(config.map, config.palette);
  EXPECT_GT(loaded.edges.segments.size(), 10u);
}

TEST(LocalizationConfig, AMapOfTheFloorMayLackTheUprightEdgesOfItsPalette) {
  const std::string file = testing::TempDir() + "floor_only.csv";
  std::ofstream(file) << "x1_m,y1_m,z1_m,x2_m,y2_m,z2_m,label\n0,0,0,1,0,0,skirting\n1,0,0,2,0,0,door_foot\n";
  // Of the labels that no row has, door_jamb and door2_jamb lie between wall and doors.
  EXPECT_THAT(loadMapEdges(file, kSource + "/cfg/maps/corridor.palette").warnings,
              ElementsAre(HasSubstr("label \"door2_foot\" stands in no row of " + file)));
}

TEST(LocalizationConfig, TheShippedSetupOfARecordingLacksOnlyTheMap) {
  const std::string file = kSource + "/cfg/replay/localization.cfg";
  Properties properties = Properties::load(file);
  {
    ConfigReader root(properties);
    ConfigReader reader = root.group("Localization");
    reader.known("Endpoints");
    reader.known("WebEndpoints");
    readLocalizationConfig(reader);
    try {
      root.finish();
      ADD_FAILURE() << "accepted without a map";
    } catch (const ConfigError& error) {
      EXPECT_THAT(error.problems(), ElementsAre(HasSubstr(file + ": missing key \"Localization.Map\"")));
    }
  }
  properties.set("Localization.Map", kSource + "/cfg/maps/room.csv");
  ConfigReader root(properties);
  ConfigReader reader = root.group("Localization");
  reader.known("Endpoints");
  reader.known("WebEndpoints");
  readLocalizationConfig(reader);
  EXPECT_NO_THROW(root.finish());
}

TEST(LocalizationConfig, StripesOfTheFieldBecomeTheirEdges) {
  const std::filesystem::path map = std::filesystem::temp_directory_path() / "vismem_config_test_map.csv";
  std::ofstream(map) << "x1_m,y1_m,z1_m,x2_m,y2_m,z2_m,label,width_m\n0,0,0,2,0,0,line,0.05\n";
  const SegmentMap edges = loadMapEdges(map, kSource + "/cfg/maps/field.palette").edges;
  std::filesystem::remove(map);
  ASSERT_EQ(edges.segments.size(), 2u);
  EXPECT_EQ(edges.segments[0].label, "stripe_edge");
}

TEST(LocalizationConfig, AMapThatThePaletteCannotNameIsRefused) {
  EXPECT_THROW(loadMapEdges(kSource + "/cfg/maps/corridor.csv", kSource + "/cfg/maps/field.palette"),
               ConfigError);
}

}  // namespace
}  // namespace vismem
