// Colour classes and the labels of their pairs.
// Tests V3.
#include "common/vision/palette.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <random>
#include <sstream>

#include "common/config/config_error.h"

namespace vismem {
namespace {

using testing::ElementsAre;
using testing::Pair;

constexpr const char* kField = R"(# a field
class.grass = hue 70..170 saturation 25..100 value 8..100
class.line  = saturation 0..25 value 45..100   # any hue
class.red   = hue 340..20 saturation 50..100 value 20..100
pair.stripe_edge = grass line
stripe.line = stripe_edge
)";

std::vector<std::string> problemsOf(const std::string& text) {
  try {
    Palette::parse(text, "p.palette");
  } catch (const ConfigError& error) {
    return error.problems();
  }
  return {};
}

TEST(Palette, FindsTheClassOfAColour) {
  const Palette palette = Palette::parse(kField, "field.palette");
  EXPECT_EQ(palette.className(palette.classOf(40, 160, 60)), "grass");
  EXPECT_EQ(palette.className(palette.classOf(230, 235, 225)), "line");
  EXPECT_EQ(palette.className(palette.classOf(128, 128, 128)), "line");  // a pure grey has no hue
  EXPECT_EQ(palette.className(palette.classOf(20, 20, 20)), "none");     // too dark for anything
}

TEST(Palette, HueWrapsOverRed) {
  const Palette palette = Palette::parse(kField, "field.palette");
  EXPECT_EQ(palette.className(palette.classOf(200, 30, 10)), "red");    // hue 6
  EXPECT_EQ(palette.className(palette.classOf(200, 10, 40)), "red");    // hue 351
  EXPECT_EQ(palette.className(palette.classOf(200, 160, 10)), "none");  // hue 47
}

TEST(Palette, TheFirstClassThatMatchesWins) {
  const Palette palette =
      Palette::parse("class.dark = value 0..50\nclass.everything = value 0..100\n", "two.palette");
  EXPECT_EQ(palette.className(palette.classOf(100, 0, 0)), "dark");
  EXPECT_EQ(palette.className(palette.classOf(200, 0, 0)), "everything");
  EXPECT_EQ(palette.className(palette.classOf(255, 255, 255)), "everything");
  EXPECT_EQ(palette.className(palette.classOf(0, 0, 0)), "dark");
}

// The table has cells of 4x4x4 colours; borders of classes pass through them anywhere.
TEST(Palette, ClassesOfDrawnPalettesAreExact) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int trial = 0; trial < 6; ++trial) {
    std::ostringstream text;
    for (int i = 0; i < 8; ++i) {
      const double from = 360.0 * unit(random);
      const double to = std::fmod(from + 10.0 + 170.0 * unit(random), 360.0);
      const double saturation = 60.0 * unit(random);
      const double value = 60.0 * unit(random);
      text << "class.c" << i << " = saturation " << saturation << ".." << saturation + 25.0 << " value "
           << value << ".." << value + 30.0;
      if (i % 3 != 0) text << " hue " << from << ".." << to;
      text << '\n';
    }
    const Palette palette = Palette::parse(text.str(), "drawn.palette");
    for (int i = 0; i < 100'000; ++i) {
      const auto level = [&] { return static_cast<std::uint8_t>(random() % 256); };
      const std::uint8_t red = level();
      const std::uint8_t green = level();
      const std::uint8_t blue = i % 2 == 0 ? level() : static_cast<std::uint8_t>((red + green) / 2);
      const std::vector<ColorClass> all = palette.allClassesOf(red, green, blue);
      ASSERT_EQ(palette.classOf(red, green, blue), all.empty() ? kNoColorClass : all.front())
          << int{red} << ' ' << int{green} << ' ' << int{blue} << '\n'
          << text.str();
    }
  }
}

TEST(Palette, LabelsAPairInEitherOrderAndNothingElse) {
  const Palette palette = Palette::parse(kField, "field.palette");
  const ColorClass grass = palette.classNamed("grass");
  const ColorClass line = palette.classNamed("line");
  EXPECT_EQ(palette.label(grass, line), "stripe_edge");
  EXPECT_EQ(palette.label(line, grass), "stripe_edge");
  EXPECT_EQ(palette.label(grass, grass), kUnknownLabel);
  EXPECT_EQ(palette.label(kNoColorClass, line), kUnknownLabel);
  EXPECT_EQ(palette.classNamed("sky"), kNoColorClass);
  EXPECT_THAT(palette.labels(), ElementsAre("stripe_edge"));
  EXPECT_THAT(palette.stripes(), ElementsAre(Pair("line", "stripe_edge")));
}

TEST(Palette, ReportsEveryProblemAtOnceWithItsLine) {
  EXPECT_THAT(
      problemsOf("class.a = hue 10..400\n"
                 "class.b = saturation 60..20\n"
                 "class.c = brightness 0..10\n"
                 "class.d = value 10\n"
                 "class.a = hue 10..400\n"
                 "what is this\n"
                 "colour.x = value 0..1\n"
                 "pair.e = a sky\n"
                 "pair.any = a b\n"
                 "pair.f = a b\n"
                 "pair.g = b a\n"
                 "stripe.line = edge\n"
                 "class.9 = value 0..1\n"),
      ElementsAre(
          "p.palette:1: class.a = hue 10..400 (must be within 0..360 degrees)",
          "p.palette:2: class.b = saturation 60..20 (LO must not be above HI)",
          "p.palette:3: class.c = brightness 0..10 (must be hue, saturation or value)",
          "p.palette:4: class.d = value 10 (must be LO..HI)",
          "p.palette:5: class.a = hue 10..400 (already given in line 1)",
          "p.palette:6: \"what is this\" (must be KEY = VALUE)",
          "p.palette:7: colour.x = value 0..1 (unknown key, must be class.NAME, pair.LABEL or stripe.NAME)",
          "p.palette:9: pair.any = a b (\"any\" is reserved)",
          "p.palette:13: class.9 = value 0..1 (a name is letters, digits and _, and begins with a letter)",
          "p.palette:8: pair.e = a sky (no class \"sky\")",
          "p.palette:11: pair.g = b a (these classes already are \"f\")",
          "p.palette:12: stripe.line = edge (no pair has that label)"));
}

TEST(Palette, AClassHasSeveralRegionsAndALabelSeveralPairs) {
  const auto palette = Palette::parse(
      "class.floor = value 0..20\n"
      "class.paint = hue 200..240 saturation 50..100 value 30..100\n"
      "class.floor = saturation 0..20 value 25..40\n"
      "class.wall  = value 60..100\n"
      "pair.edge = wall floor\n"
      "pair.edge = wall paint\n"
      "pair.mark = floor paint\n",
      "p.palette");
  const ColorClass dark = palette.classOf(30, 30, 30);
  const ColorClass light = palette.classOf(80, 80, 80);
  const ColorClass paint = palette.classOf(20, 40, 140);
  const ColorClass wall = palette.classOf(250, 250, 250);
  EXPECT_NE(dark, light);
  EXPECT_EQ(palette.className(dark), "floor");
  EXPECT_EQ(palette.className(light), "floor");
  for (const ColorClass floor : {dark, light}) {
    EXPECT_EQ(palette.label(floor, wall), "edge");
    EXPECT_EQ(palette.label(floor, paint), "mark");
  }
  EXPECT_EQ(palette.label(wall, paint), "edge");
  EXPECT_EQ(palette.label(dark, light), kUnknownLabel) << "two regions of one class are no pair";
  EXPECT_THAT(palette.labels(), ElementsAre("edge", "mark"));
}

TEST(Palette, LabelsThatNeverBorderTheFloorStandUp) {
  const std::string classes =
      "class.floor = value 0..30\nclass.wall = value 31..60\nclass.door = value 61..80\nclass.lamp = value "
      "81..100\n";
  const Palette palette = Palette::parse(classes +
                                             "pair.skirting = floor wall\npair.frame = wall door\n"
                                             "pair.edge = wall lamp\npair.edge = floor door\n",
                                         "p");
  EXPECT_EQ(palette.labelsOffFloor(), std::set<Label>{"frame"}) << "one of the pairs of edge borders it";
  EXPECT_EQ(Palette::parse("class.grass = value 0..30\n", "p").labelsOffFloor(), std::nullopt);
}

TEST(Palette, WithoutAClassIsAnError) {
  EXPECT_THAT(problemsOf("# nothing\n"),
              ElementsAre("p.palette: no class (at least one \"class.NAME\" is needed)"));
}

TEST(Palette, AFileThatCannotBeReadIsNamed) {
  try {
    loadPalette("/nowhere/at/all.palette");
    FAIL() << "no error";
  } catch (const ConfigError& error) {
    EXPECT_STREQ(error.what(),
                 "/nowhere/at/all.palette: cannot be read (No such file or directory; must be a palette)");
  }
}

}  // namespace
}  // namespace vismem
