// Tests L11. The whole pipeline in lock-step: it localizes, and one seed gives the same bytes twice.
#include "evaluation/app/evaluation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "common/config/config_error.h"
#include "common/recording/bag_file.h"
#include "support/build_paths.h"

namespace vismem {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

const fs::path kSource = VISMEM_SOURCE_DIR;
const std::vector<std::string> kFiles{"trajectory.tum", "odometry.tum", "races.csv", "memory.csv"};

std::string contents(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

class EvaluateTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    out_ = fs::temp_directory_path() / ("evaluate_" + std::to_string(::getpid()) + "_" + info->name());
  }
  void TearDown() override { fs::remove_all(out_); }

  /// @param run names the folder of its files.
  EvaluationOptions corridor(const std::string& run, std::uint64_t seed) const {
    EvaluationOptions options;
    options.world = kSource / "cfg/worlds/corridor.world";
    options.map = kSource / "cfg/maps/corridor.csv";
    options.out = out_ / run;
    options.seed = seed;
    options.seconds = 8.0;
    return options;
  }

  void expectSameFiles(const std::string& a, const std::string& b) const {
    for (const std::string& name : kFiles) {
      const std::string first = contents(out_ / a / name);
      EXPECT_GT(first.size(), 50u) << name;
      EXPECT_EQ(first, contents(out_ / b / name)) << name;
    }
  }

  fs::path out_;
};

TEST_F(EvaluateTest, SimulationGivesTheSameBytesTwiceForOneSeed) {
  const auto first = evaluate(corridor("a", 3));
  const auto second = evaluate(corridor("b", 3));
  EXPECT_EQ(first.dump(), second.dump());
  expectSameFiles("a", "b");
  EXPECT_GT(first.at("memory_segments").get<int>(), 2) << "what is in view at the end";
  EXPECT_GT(first.at("gaze_visits").get<int>(), 2) << "the gaze is at work";
  EXPECT_GT(first.at("path_m").get<double>(), 1.0) << "the route is driven";
  evaluate(corridor("c", 4));
  EXPECT_NE(contents(out_ / "a/odometry.tum"), contents(out_ / "c/odometry.tum"));
}

TEST_F(EvaluateTest, TheDriveInASecondWorldDiffersByThatWorldAlone) {
  EvaluationOptions options = corridor("drive", 3);
  options.seconds = 4.0;
  options.record = out_ / "first";
  options.second_world = options.world;
  options.second_record = out_ / "second";
  evaluate(options);
  const std::string first = contents(out_ / "first/first_0000.bag");
  EXPECT_GT(first.size(), 1'000'000u);
  EXPECT_TRUE(first == contents(out_ / "second/second_0000.bag")) << "the same world";
}

TEST_F(EvaluateTest, SeparatesEdgesOfThingsThatWalkFromThoseThatRest) {
  fs::create_directories(out_);
  EvaluationOptions options = corridor("walk", 1);
  options.start = Pose2{0.0, 2.25, 0.0};
  options.scenario = out_ / "walk.scenario";
  // A red box goes ahead of the robot, which stands, over plain floor.
  std::ofstream(options.scenario) << "scenario 1\nobject box shape=box size_m=0.4,0.4,0.3 color=0.9,0.1,0.1\n"
                                  << "at 0 walk box way=open speed_mps=0.1 points_m=1.2,2.0;1.2,2.5\n"
                                  << "at 0 drive points_m=0,2.25;0.1,2.25 speed_mps=0.05\n";
  const auto with = evaluate(options);
  ASSERT_TRUE(with.contains("moving")) << with;
  EXPECT_GT(with.at("moving").at("seen_of_moving").get<int>(), 0);
  std::ofstream(options.scenario) << "scenario 1\n";
  EXPECT_FALSE(evaluate(options).contains("moving")) << "nothing walks";
}

TEST_F(EvaluateTest, KeepsAKnownStart) {
  EvaluationOptions options = corridor("known", 1);
  options.start = Pose2{0.0, 2.25, 0.0};
  const auto json = evaluate(options);
  ASSERT_TRUE(json.at("settled_after_s").is_number()) << json;
  EXPECT_LT(json.at("settled_after_s").get<double>(), 1.0);
  // Half of what the whole application must reach from an unknown start (L11).
  EXPECT_LT(json.at("position_error_m").get<double>(), 0.075);
  EXPECT_LT(json.at("heading_error_deg").get<double>(), 2.5);
}

// Without correction these lights leave hardly a label.
TEST_F(EvaluateTest, KeepsAKnownStartInOtherLight) {
  for (const char* light : {"brightness=0.45", "brightness=1.8,white=3000"}) {
    EvaluationOptions options = corridor("light", 1);
    options.start = Pose2{0.0, 2.25, 0.0};
    options.perturbation = parsePerturbation(light).perturbation;
    const auto json = evaluate(options);
    EXPECT_GT(json.at("calibration").at("light").at("named_share").get<double>(), 0.6) << light;
    ASSERT_TRUE(json.at("settled_after_s").is_number()) << light << json;
    EXPECT_LT(json.at("position_error_m").get<double>(), 0.075) << light;
    EXPECT_LT(json.at("heading_error_deg").get<double>(), 2.5) << light;
  }
}

TEST_F(EvaluateTest, RunsInChapterMode) {
  EvaluationOptions options = corridor("chapter", 1);
  options.mode = "chapter";
  options.start = Pose2{0.0, 2.25, 0.0};
  const auto json = evaluate(options);
  EXPECT_EQ(json.at("mode"), "chapter");
  EXPECT_GT(json.at("memory_segments").get<int>(), 5);
}

TEST_F(EvaluateTest, ReadsTheKeysOfBothComponentsFromOneFile) {
  fs::create_directories(out_);
  EvaluationOptions options = corridor("config", 1);
  options.config = out_ / "both.cfg";
  std::ofstream(options.config) << "ActiveVisualMemory.Gaze.Mode = off\nLocalization.Races.Maximum = 2\n"
                                << "Localization.Mode = chapter\n";
  const auto json = evaluate(options);
  EXPECT_EQ(json.at("gaze_visits"), 0);
  EXPECT_EQ(json.at("mode"), "chapter");
  EXPECT_LE(json.at("races").get<int>(), 2);
  std::ofstream(options.config) << "ActiveVisualMemory.Gaze.Mode = off\nLocalization.Races.Maximun = 2\n";
  EXPECT_THAT([&] { evaluate(options); }, ::testing::ThrowsMessage<ConfigError>(HasSubstr(
                                              "both.cfg:2: unknown key \"Localization.Races.Maximun")));
}

TEST_F(EvaluateTest, WritesFiguresSnapshotsAndTheEstimatedCalibration) {
  EvaluationOptions options = corridor("figures", 3);
  options.seconds = 4.0;
  options.snapshots = true;
  const auto json = evaluate(options);
  EXPECT_FALSE(json.contains("problems")) << json;
  for (const char* name : {"top_view.png", "error.png", "last_image.png"}) {
    std::error_code absent;
    EXPECT_GT(fs::file_size(options.out / name, absent), 10'000u) << name;
  }
  std::set<std::string> stamps;
  std::istringstream rows(contents(options.out / "memory.csv"));
  std::string line;
  for (std::getline(rows, line); std::getline(rows, line);) stamps.insert(line.substr(0, line.find(',')));
  EXPECT_GE(stamps.size(), 4u) << "one a second and the last";
  const auto& tilt = json.at("calibration").at("camera_tilt");
  for (const char* name : {"mount_roll", "mount_pitch", "camera_pitch", "camera_roll"}) {
    EXPECT_GT(tilt.at(std::string(name) + "_sigma_deg").get<double>(), 0.0) << name;
    EXPECT_LT(tilt.at(std::string(name) + "_sigma_deg").get<double>(), 1.0) << name;
    EXPECT_TRUE(tilt.at(std::string(name) + "_deg").is_number()) << name;
  }
  EXPECT_GT(json.at("images_with_truth").get<int>(), 30);
  EXPECT_GE(json.at("right_share").get<double>(), 0.0);
}

TEST_F(EvaluateTest, IsAFailureWithoutLabels) {
  fs::create_directories(out_);
  EvaluationOptions options = corridor("no_labels", 3);
  options.seconds = 1.0;
  options.palette = out_ / "odd.palette";
  std::ofstream(options.palette) << "class.a = hue 300..301 saturation 99..100\n"
                                 << "class.b = hue 303..304 saturation 99..100\npair.skirting = a b\n";
  const auto json = evaluate(options);
  ASSERT_TRUE(json.contains("problems")) << json;
  EXPECT_THAT(json["problems"][0].get<std::string>(),
              ::testing::AllOf(HasSubstr("no label was found"), HasSubstr("odd.palette")));
}

TEST_F(EvaluateTest, IsAFailureWhenNoRaceEverLived) {
  fs::create_directories(out_);
  EvaluationOptions options = corridor("no_race", 3);
  options.seconds = 1.0;
  options.palette = kSource / "cfg/maps/corridor.palette";
  options.map = out_ / "upright.csv";
  // An upright edge has no place on the floor to find the robot by.
  std::ofstream(options.map) << "x1_m,y1_m,z1_m,x2_m,y2_m,z2_m,label\n0,0,0,0,0,1,skirting\n";
  const auto json = evaluate(options);
  ASSERT_TRUE(json.contains("problems")) << json;
  EXPECT_THAT(json["problems"][0].get<std::string>(),
              ::testing::AllOf(HasSubstr("no race ever lived"), HasSubstr("upright.csv")));
}

TEST_F(EvaluateTest, ChecksMapAndPaletteAgainstEachOther) {
  fs::create_directories(out_);
  EvaluationOptions options = corridor("check", 3);
  options.palette = kSource / "cfg/maps/field.palette";
  EXPECT_THAT([&] { evaluate(options); }, ::testing::Throws<ConfigError>())
      << "nothing is left to localize by";
}

TEST_F(EvaluateTest, ChecksItsFolderBeforeTheRun) {
  EvaluationOptions options = corridor("folder", 3);
  options.out = "/proc/results";
  EXPECT_THAT([&] { evaluate(options); }, ::testing::ThrowsMessage<std::runtime_error>(
                                              HasSubstr("/proc/results: cannot make this folder")));
}

TEST_F(EvaluateTest, FindsItsConfigurationFromAnyFolder) {
  const fs::path before = fs::current_path();
  fs::create_directories(out_);
  EvaluationOptions options = corridor("elsewhere", 3);
  options.seconds = 1.0;
  fs::current_path(out_);
  EXPECT_NO_THROW(evaluate(options));
  fs::current_path(before);
}

TEST_F(EvaluateTest, NeedsNoPaletteOfTheMachineThatRecorded) {
  fs::create_directories(out_);
  EvaluationOptions options = corridor("moved", 3);
  options.seconds = 1.0;
  options.config = out_ / "moved.cfg";
  std::ofstream(options.config) << "ActiveVisualMemory.Palette = /absent/corridor.palette\n";
  EXPECT_NO_THROW(evaluate(options)) << "a palette lies beside the map";
}

TEST_F(EvaluateTest, NamesInputThatIsWrong) {
  EvaluationOptions options = corridor("wrong", 1);
  options.map = out_ / "absent.csv";
  options.palette = kSource / "cfg/maps/corridor.palette";
  EXPECT_THAT([&] { evaluate(options); }, ::testing::ThrowsMessage<ConfigError>(HasSubstr("absent.csv")));
  options = corridor("wrong", 1);
  options.world = out_ / "absent.world";
  EXPECT_THAT([&] { evaluate(options); }, ::testing::ThrowsMessage<ConfigError>(HasSubstr("absent.world")));
  options = EvaluationOptions{};
  options.bag = out_ / "absent.bag";
  EXPECT_THAT([&] { evaluate(options); }, ::testing::ThrowsMessage<ConfigError>(HasSubstr("absent.bag")));
  EXPECT_FALSE(fs::exists(out_)) << "nothing is written before the input is known to be good";
}

TEST_F(EvaluateTest, RecordingOfANaoGivesTheSameBytesTwice) {
  const char* data = std::getenv("AVM_DATA");
  const fs::path folder = (data ? fs::path(data) : kSource / "../shared/data") / "nao_field_2009";
  if (!fs::exists(folder))
    GTEST_SKIP() << folder << " is not here: set AVM_DATA to the folder of the data sets";
  EvaluationOptions options;
  options.bag = folder / "nao_field_2009.bag";
  options.map = folder / "map.csv";
  options.setup = "nao";
  options.judge_first = 40;
  options.judge_last = 138;
  options.out = out_ / "a";
  const auto first = evaluate(options);
  options.out = out_ / "b";
  EXPECT_EQ(first.dump(), evaluate(options).dump());
  expectSameFiles("a", "b");
  EXPECT_EQ(first.at("frames"), 160);
  EXPECT_EQ(first.at("images_judged"), 99);
  EXPECT_EQ(first.at("images_without_pose"), 0);
  EXPECT_TRUE(first.at("map_projection_px").is_number());
}

}  // namespace
}  // namespace vismem
