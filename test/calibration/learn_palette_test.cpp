// The program learn_palette as a user calls it, on a recording of a rendered world. Tests V3, B5.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "calibration/calibrate_run.h"
#include "common/vision/palette.h"
#include "support/temporary_folder.h"

namespace vismem {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// Share of the length of all edges of a map that have their own label in the images.
double rightShare(const nlohmann::json& summary) {
  const nlohmann::json& labels = summary.at("labels");
  double all = 0.0;
  double right = 0.0;
  for (const auto& [label, seen] : labels.items()) {
    all += seen["length_px"].get<double>();
    right += seen["length_px"].get<double>() * seen["right_share"].get<double>();
  }
  return right / all;
}

class LearnPalette : public testing::Test {
 protected:
  std::string file(const std::string& name) const { return folder_ / name; }
  static std::string shipped(const std::string& name) {
    return std::string(VISMEM_SOURCE_DIR) + "/cfg/" + name;
  }

  ToolRun evaluate(const std::string& palette) {
    return runTool("evaluate", {"--bag", file("drive"), "--map", shipped("maps/corridor.csv"), "--survey",
                                shipped("maps/corridor.csv"), "--palette", palette, "--setup", "sim", "--out",
                                file("evaluated")});
  }

  TemporaryFolder folder_;
};

TEST_F(LearnPalette, FromADriveNamesTheEdgesOfTheMapAsWellAsTheHandMadeOne) {
  const ToolRun drive =
      runTool("evaluate", {"--world", shipped("worlds/corridor.world"), "--map", shipped("maps/corridor.csv"),
                           "--seconds", "12", "--record", file("drive"), "--out", file("simulated")});
  ASSERT_EQ(drive.code, 0) << drive.error;
  const Palette truth = loadPalette(shipped("maps/corridor.palette"));
  const ToolRun learnt = runTool(
      "learn_palette", {"--bag", file("drive"), "--out", file("own.palette"), "--picture", file("own.png")});
  ASSERT_EQ(learnt.code, 0) << learnt.error;
  const nlohmann::json summary = learnt.summary();
  EXPECT_GT(summary["named_share"], 0.5) << summary;
  for (const char* light : {"brightness", "white", "gamma"}) {
    const double neutral = std::string(light) == "white" ? 6500.0 : 1.0;
    EXPECT_LT(summary["holds"][light][0], 0.95 * neutral) << summary;
    EXPECT_GT(summary["holds"][light][1], 1.05 * neutral) << summary;
  }
  EXPECT_THAT(learnt.error, HasSubstr("nine of ten edges keep their names while images are 0."));
  EXPECT_FALSE(cv::imread(file("own.png")).empty());

  // Guessed names are others than those of the map: each is renamed to the hand-made class that holds its
  // middle.
  std::ifstream written(file("own.palette"));
  std::string text((std::istreambuf_iterator<char>(written)), {});
  const Palette own = Palette::parse(text, "own.palette");
  std::map<std::string, std::string> names;
  for (ColorClass k = 1; k <= own.classCount(); ++k) {
    const ColorClassDefinition& region = own.definition(k);
    const auto middle = [](const ColorRange& range) { return 0.5 * (range.low + range.high); };
    for (ColorClass hand = 1; hand <= truth.classCount(); ++hand) {
      const ColorClassDefinition& one = truth.definition(hand);
      const auto holds = [&](const ColorRange& range, double value) {
        return value >= range.low && value <= range.high;
      };
      const bool is_same = holds(one.hue_deg, middle(region.hue_deg)) &&
                           holds(one.saturation_percent, middle(region.saturation_percent)) &&
                           holds(one.value_percent, middle(region.value_percent));
      if (is_same) names.try_emplace(region.name, one.name);
    }
  }
  std::ofstream renamed(file("renamed.palette"));
  for (ColorClass k = 1; k <= own.classCount(); ++k) {
    const ColorClassDefinition& one = own.definition(k);
    ASSERT_TRUE(names.contains(one.name)) << one.name << " is no class of the hand-made palette\n" << text;
    renamed << "class." << names.at(one.name) << " = hue " << one.hue_deg.low << ".." << one.hue_deg.high
            << " saturation " << one.saturation_percent.low << ".." << one.saturation_percent.high
            << " value " << one.value_percent.low << ".." << one.value_percent.high << "\n";
  }
  for (const auto& pair : summary["pairs"]) {
    const auto a = truth.classNamed(names.at(pair["classes"][0]));
    const auto b = truth.classNamed(names.at(pair["classes"][1]));
    if (truth.label(a, b) == kUnknownLabel) continue;
    renamed << "pair." << truth.label(a, b) << " = " << truth.className(a) << " " << truth.className(b)
            << "\n";
  }
  renamed.close();

  const ToolRun by_hand = evaluate(shipped("maps/corridor.palette"));
  const ToolRun by_learning = evaluate(file("renamed.palette"));
  ASSERT_EQ(by_hand.code, 0) << by_hand.error;
  ASSERT_EQ(by_learning.code, 0) << by_learning.error;
  EXPECT_GE(rightShare(by_learning.summary()), 0.95 * rightShare(by_hand.summary()));
}

TEST_F(LearnPalette, NamesWhatWasClickedAndSaysWhatIsWrongWithClicks) {
  std::filesystem::create_directories(file("images"));
  for (int i = 0; i < 4; ++i) {
    cv::Mat image(240, 320, CV_8UC3, cv::Scalar::all(60));
    cv::rectangle(image, {0, 0, 320, 100 + 5 * i}, cv::Scalar(90, 200, 220), cv::FILLED);  // B, G, R
    cv::imwrite(file("images/" + std::to_string(i) + ".png"), image);
  }
  std::ofstream(file("good")) << "wall 0.png 100 50   # the yellow one\nground 2.png 100 200\n";
  const ToolRun learnt = runTool(
      "learn_palette", {"--images", file("images"), "--clicks", file("good"), "--out", file("own.palette")});
  ASSERT_EQ(learnt.code, 0) << learnt.error;
  const Palette palette = loadPalette(file("own.palette"));
  EXPECT_EQ(palette.className(palette.classOf(220, 200, 90)), "wall");
  EXPECT_EQ(palette.className(palette.classOf(60, 60, 60)), "ground");
  EXPECT_EQ(palette.label(palette.classNamed("wall"), palette.classNamed("ground")), "ground_wall");

  std::ofstream(file("bad")) << "wall 0.png 100\n";
  const ToolRun bad =
      runTool("learn_palette", {"--images", file("images"), "--clicks", file("bad"), "--out", file("x")});
  EXPECT_EQ(bad.code, 2);
  EXPECT_THAT(bad.error, AllOf(HasSubstr("bad:1: \"wall 0.png 100\""), HasSubstr("NAME IMAGE U V")));
  std::ofstream(file("name")) << "wall/x 0.png 100 50\n";
  const ToolRun name =
      runTool("learn_palette", {"--images", file("images"), "--clicks", file("name"), "--out", file("x")});
  EXPECT_EQ(name.code, 2);
  EXPECT_THAT(name.error,
              HasSubstr("name:1: \"wall/x\" (must be letters, digits and _, and begin with a letter)"));
  std::ofstream(file("far")) << "wall 9.png 1 1\nwall 0.png 320 1\n";
  const ToolRun far =
      runTool("learn_palette", {"--images", file("images"), "--clicks", file("far"), "--out", file("x")});
  EXPECT_EQ(far.code, 2);
  EXPECT_THAT(far.error, HasSubstr("far:2: pixel 320 1 (must be within 0..319 and 0..239)"));
  EXPECT_FALSE(std::filesystem::exists(file("x")));
}

TEST_F(LearnPalette, LearnsPairsOfEqualBrightnessWhichTheMemorySeesToo) {
  std::filesystem::create_directories(file("images"));
  for (int i = 0; i < 8; ++i) {
    cv::Mat image(240, 320, CV_8UC3, cv::Scalar::all(120));
    // Brightness 0.299 * 200 + 0.587 * 70 + 0.114 * 167 = 120.
    cv::rectangle(image, {0, 0, 320, 100 + 5 * i}, cv::Scalar(167, 70, 200), cv::FILLED);  // B, G, R
    cv::imwrite(file("images/" + std::to_string(i) + ".png"), image);
  }
  std::ofstream(file("clicks")) << "door 0.png 100 50\nfloor 0.png 100 200\n";
  const ToolRun learnt = runTool("learn_palette", {"--images", file("images"), "--clicks", file("clicks"),
                                                   "--out", file("own.palette")});
  ASSERT_EQ(learnt.code, 0) << learnt.error;
  EXPECT_EQ(learnt.summary()["named_share"], 1.0);
  const Palette palette = loadPalette(file("own.palette"));
  EXPECT_EQ(palette.label(palette.classNamed("door"), palette.classNamed("floor")), "door_foot");
}

TEST_F(LearnPalette, ShowsAPageForClicksAlsoWhenNothingCanBeLearnt) {
  std::filesystem::create_directories(file("images"));
  for (int i = 0; i < 30; ++i)
    cv::imwrite(file("images/" + std::to_string(i) + ".png"), cv::Mat(24, 32, CV_8UC3, cv::Scalar::all(60)));
  const ToolRun even = runTool(
      "learn_palette", {"--images", file("images"), "--show", file("shown"), "--out", file("own.palette")});
  EXPECT_EQ(even.code, 1) << even.out;
  std::ifstream page(file("shown/clicks.html"));
  const std::string text((std::istreambuf_iterator<char>(page)), {});
  EXPECT_THAT(text, HasSubstr("27.png"));
  EXPECT_LE(std::distance(std::filesystem::directory_iterator(file("shown")), {}), 12 + 1);
}

TEST_F(LearnPalette, GreyImagesAndFoldersWithoutImagesAreErrors) {
  std::filesystem::create_directories(file("none"));
  EXPECT_EQ(runTool("learn_palette", {"--images", file("none"), "--out", file("x")}).code, 2);
  EXPECT_EQ(runTool("learn_palette", {"--out", file("x")}).code, 2);
  const ToolRun missing = runTool("learn_palette", {"--bag", file("none.bag"), "--out", file("x")});
  EXPECT_NE(missing.code, 0);
  EXPECT_THAT(missing.error, HasSubstr("none.bag"));
}

}  // namespace
}  // namespace vismem
