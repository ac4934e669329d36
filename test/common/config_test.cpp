// Units of common/config: the strict reader of property files.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <limits>

#include "common/config/config_error.h"
#include "common/config/config_reader.h"
#include "common/config/nearest_name.h"
#include "common/config/properties.h"

namespace vismem {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::string valueOf(const Properties& properties, const std::string& key) {
  const auto* entry = properties.find(key);
  return entry == nullptr ? "(absent)" : entry->value;
}

std::vector<std::string> problemsOf(const ConfigReader& config) {
  try {
    config.finish();
  } catch (const ConfigError& error) {
    return error.problems();
  }
  return {};
}

TEST(Properties, KeepsValueFileAndLine) {
  const auto properties = Properties::parse(
      "# The robot.\n"
      "\n"
      "Camera.Name=cameraA   # served under this name\r\n"
      "  Camera.Proxy  =  cameraA:tcp -h 127.0.0.1 -p 9999  \n"
      "Camera.Note=",
      "cfg/a.cfg");
  EXPECT_EQ(valueOf(properties, "Camera.Name"), "cameraA");
  EXPECT_EQ(valueOf(properties, "Camera.Proxy"), "cameraA:tcp -h 127.0.0.1 -p 9999");
  EXPECT_EQ(valueOf(properties, "Camera.Note"), "") << "empty values are allowed";
  EXPECT_EQ(properties.find("Camera.Proxy")->origin.text(), "cfg/a.cfg:4");
  EXPECT_EQ(properties.entries().size(), 3u);
  EXPECT_THAT(properties.problems(), IsEmpty());
}

TEST(Properties, UnderstandsTheEscapesOfIce) {
  const auto properties = Properties::parse(
      "Hash=a\\#b # comment\n"
      "Equals=a\\=b=c\n"
      "Backslash=a\\\\b\n"
      "Blanks=\\ a  b\\ \n"
      "Other=C:\\tools\\new\n"
      "Key\\=with\\ signs=1\n"
      "Last=a\\",
      "a.cfg");
  EXPECT_EQ(valueOf(properties, "Hash"), "a#b");
  EXPECT_EQ(valueOf(properties, "Equals"), "a=b=c");
  EXPECT_EQ(valueOf(properties, "Backslash"), "a\\b");
  EXPECT_EQ(valueOf(properties, "Blanks"), " a  b ");
  EXPECT_EQ(valueOf(properties, "Other"), "C:\\tools\\new");
  EXPECT_EQ(valueOf(properties, "Key=with signs"), "1");
  EXPECT_EQ(valueOf(properties, "Last"), "a\\");
}

TEST(Properties, SkipsAByteOrderMark) {
  EXPECT_EQ(valueOf(Properties::parse("\xEF\xBB\xBF"
                                      "A=1\n",
                                      "a.cfg"),
                    "A"),
            "1");
}

TEST(Properties, ReportsJunkAndDuplicatesTogether) {
  const auto properties = Properties::parse(
      "Camera.Name=a\n"
      "what is this\n"
      "= 5\n"
      "Camera.Name=b\n",
      "cfg/a.cfg");
  try {
    properties.throwIfBad();
    FAIL() << "accepted";
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.problems(),
                ElementsAre("cfg/a.cfg:2: \"what is this\" (must be KEY = VALUE)",
                            "cfg/a.cfg:3: \"= 5\" has no key (must be KEY = VALUE)",
                            "cfg/a.cfg:4: key \"Camera.Name\" is set twice (first in line 1)"));
  }
  EXPECT_EQ(valueOf(properties, "Camera.Name"), "a");
}

TEST(Properties, CommandLineReplacesKeysOfTheFile) {
  auto properties = Properties::parse("Camera.Name=a\nCamera.Rate=5\n", "a.cfg");
  properties.addArgument("--Camera.Name=b=c");
  properties.addArgument("--Camera.Name=d");
  EXPECT_EQ(valueOf(properties, "Camera.Name"), "d");
  EXPECT_EQ(properties.find("Camera.Name")->origin.text(), "command line");
  EXPECT_THAT(properties.problems(), IsEmpty());
  for (const char* argument : {"--Camera.Name", "camera", "--=3"}) properties.addArgument(argument);
  EXPECT_THAT(problemLines(properties.problems()),
              ElementsAre("command line: \"--Camera.Name\" (must be --Key=Value)",
                          "command line: \"camera\" (must be --Key=Value)",
                          "command line: \"--=3\" (must be --Key=Value)"));
}

TEST(Properties, SaysWhyAFileCannotBeRead) {
  EXPECT_THAT(problemLines(Properties::load("no/such.cfg").problems()),
              ElementsAre("no/such.cfg: cannot be read (No such file or directory; must be a configuration "
                          "of lines KEY = VALUE)"));
  EXPECT_THAT(
      problemLines(Properties::load("/tmp").problems()),
      ElementsAre("/tmp: cannot be read (is a folder; must be a configuration of lines KEY = VALUE)"));
}

TEST(Properties, LoadsAFile) {
  const auto file = testing::TempDir() + "config_test_loads.cfg";
  std::ofstream(file) << "A=1\n";
  const auto properties = Properties::load(file);
  std::remove(file.c_str());
  EXPECT_EQ(properties.find("A")->origin.text(), file + ":1");
}

TEST(ConfigReader, ReadsEveryType) {
  const auto properties = Properties::parse(
      "P.Real=-1.5e2\nP.Integer=+7\nP.Yes=yes\nP.Text=some words\nP.Mode=chapter\nP.Angle_deg=90\nP.List=1, "
      "2 3\n",
      "a.cfg");
  ConfigReader config(properties, "P");
  EXPECT_EQ(config.real("Real", 0, -1000, 1000), -150.0);
  EXPECT_EQ(config.integer("Integer", 0, 0, 10), 7);
  EXPECT_TRUE(config.boolean("Yes", false));
  EXPECT_EQ(config.text("Text", ""), "some words");
  EXPECT_EQ(config.choice("Mode", 1, {{"default", 1}, {"chapter", 2}}), 2);
  EXPECT_NEAR(config.angleDeg("Angle_deg", 0, -180, 180), std::acos(0.0), 1e-15);
  EXPECT_THAT(config.reals("List", {0, 0, 0}, 0, 5), ElementsAre(1, 2, 3));
  EXPECT_EQ(config.optionalReal("Unset", 0, 1), std::nullopt);
  EXPECT_TRUE(config.good());
  EXPECT_THAT(problemsOf(config), IsEmpty());
}

TEST(ConfigReader, ReportsAllProblemsInOrderOfTheirLines) {
  const auto properties = Properties::parse(
      "Localization.Races.Maximum = 0\n"
      "junk\n"
      "Localization.Mutaton.Heading_deg = 15\n"
      "Localization.Noise.Position_m = 10cm\n"
      "Localization.Mode = Chapter\n"
      "Localization.Robust = perhaps\n"
      "Localization.Start = 1 2\n",
      "cfg/sim/localization.cfg");
  ConfigReader root(properties);
  auto config = root.group("Localization");
  config.requiredText("Camera.Proxy", "the proxy of a camera");
  EXPECT_EQ(config.reals("Start", {0, 0, 0}, -kInfinity, kInfinity), (std::vector<double>{0, 0, 0}));
  EXPECT_EQ(config.integer("Races.Maximum", 10, 1, 64), 10) << "reading goes on with the default";
  config.angleDeg("Mutation.Heading_deg", 15, 0, 180);
  config.real("Noise.Position_m", 0.1, 0, 5);
  config.choice("Mode", 1, {{"default", 1}, {"chapter", 2}});
  config.boolean("Robust", true);
  EXPECT_FALSE(root.good()) << "a group shares the problems of its reader";
  EXPECT_THAT(
      problemsOf(root),
      ElementsAre(
          "cfg/sim/localization.cfg: missing key \"Localization.Camera.Proxy\" (must be the proxy of a "
          "camera)",
          "cfg/sim/localization.cfg:1: Localization.Races.Maximum = 0 (must be 1..64)",
          "cfg/sim/localization.cfg:2: \"junk\" (must be KEY = VALUE)",
          "cfg/sim/localization.cfg:3: unknown key \"Localization.Mutaton.Heading_deg\" (did you mean "
          "\"Localization.Mutation.Heading_deg\"?)",
          "cfg/sim/localization.cfg:4: Localization.Noise.Position_m = 10cm (must be a number, 0..5)",
          "cfg/sim/localization.cfg:5: Localization.Mode = Chapter (must be one of: default, chapter)",
          "cfg/sim/localization.cfg:6: Localization.Robust = perhaps (must be yes or no)",
          "cfg/sim/localization.cfg:7: Localization.Start = 1 2 (must be 3 numbers)"));
}

TEST(ConfigReader, RefusesWhatIsNoFiniteNumber) {
  for (const char* value :
       {"nan", "inf", "-inf", "1e999", "", "1.5.2", "0x10", "3 m", "++3", "+-3", "--3", "1,5"}) {
    const auto properties = Properties::parse(std::string("P.X = ") + value + "\nP.N = " + value, "a.cfg");
    ConfigReader config(properties, "P");
    config.real("X", 0.5, -kInfinity, kInfinity);
    config.integer("N", 1, 0, 100);
    const std::string shown = *value == '\0' ? "(empty)" : value;
    EXPECT_THAT(problemsOf(config),
                ElementsAre("a.cfg:1: P.X = " + shown + " (must be a number)",
                            "a.cfg:2: P.N = " + shown + " (must be a whole number, 0..100)"));
  }
}

TEST(ConfigReader, NamesOpenRanges) {
  const auto properties = Properties::parse("P.A=-1\nP.B=2\nP.C=x\nP.D=3.5\n", "a.cfg");
  ConfigReader config(properties, "P");
  config.real("A", 0, 0, kInfinity);
  config.real("B", 0, -kInfinity, 1.5);
  config.real("C", 0, 0, kInfinity);
  config.integer("D", 3, 1, 5);
  EXPECT_THAT(problemsOf(config),
              ElementsAre("a.cfg:1: P.A = -1 (must be at least 0)", "a.cfg:2: P.B = 2 (must be at most 1.5)",
                          "a.cfg:3: P.C = x (must be a number, at least 0)",
                          "a.cfg:4: P.D = 3.5 (must be a whole number, 1..5)"));
}

TEST(ConfigReader, TakesProblemsOfItsCaller) {
  const auto properties = Properties::parse("P.Low=3\n", "a.cfg");
  ConfigReader config(properties, "P");
  config.real("Low", 0, 0, 10);
  config.real("High", 2, 0, 10);
  config.problem("Low", "must be less than P.High");
  config.problem("High", "must be more than P.Low");
  config.problem("High", "must be more than P.Low");  // said once
  EXPECT_THAT(problemsOf(config), ElementsAre("a.cfg: P.High = 2 (the default; must be more than P.Low)",
                                              "a.cfg:1: P.Low = 3 (must be less than P.High)"));
}

TEST(ConfigReader, ProblemsOfTheCommandLineComeLast) {
  auto properties = Properties::parse("P.A=-1\n", "z.cfg");
  properties.addArgument("--P.B=-1");
  ConfigReader config(properties, "P");
  config.real("B", 0, 0, 1);
  config.real("A", 0, 0, 1);
  EXPECT_THAT(problemsOf(config),
              ElementsAre("z.cfg:1: P.A = -1 (must be 0..1)", "command line: P.B = -1 (must be 0..1)"));
}

TEST(ConfigReader, UnknownKeysAreThoseOfThePrefixOrAllButThoseOfIce) {
  const auto properties =
      Properties::parse("P.A=1\nQ.A=1\nIce.MessageSizeMax=1\nIceSSL.CAs=x\nP.Extra.X=1\n", "a.cfg");
  ConfigReader config(properties, "P");
  config.integer("A", 0, 0, 1);
  EXPECT_THAT(problemsOf(config), ElementsAre("a.cfg:5: unknown key \"P.Extra.X\""));
  config.known("Extra.*");
  EXPECT_THAT(problemsOf(config), IsEmpty());
  ConfigReader whole(properties);
  whole.known("P.A");
  whole.known("P.Extra.X");
  EXPECT_THAT(problemsOf(whole), ElementsAre("a.cfg:2: unknown key \"Q.A\" (did you mean \"P.A\"?)"));
}

TEST(ConfigReader, AcceptsTheOldNameOfAKeyAndNamesTheNewOne) {
  const auto properties = Properties::parse("P.Old=3\nP.New2=4\n", "a.cfg");
  ConfigReader config(properties, "P");
  config.alias("Old", "New");
  config.alias("Old2", "New2");
  EXPECT_TRUE(config.isSet("New"));
  EXPECT_EQ(config.integer("New", 1, 0, 9), 3);
  EXPECT_EQ(config.integer("New2", 1, 0, 9), 4);
  EXPECT_THAT(problemsOf(config), IsEmpty());
  ASSERT_EQ(config.renamedKeys().size(), 1u);
  EXPECT_EQ(config.renamedKeys()[0].text(),
            "a.cfg:1: key \"P.Old\" is now called \"P.New\" (the old name ends with release 0.3.0)");
  EXPECT_EQ(config.effective()[0].key, "P.New");
  EXPECT_EQ(config.effective()[0].value, "3");
}

TEST(ConfigReader, AcceptsAKeyWithoutEffectAndSaysWhatBecameOfIt) {
  const auto properties = Properties::parse("P.Gone=3\nP.A=1\n", "a.cfg");
  ConfigReader config(properties, "P");
  config.retired("Gone", "there is one filter");
  config.retired("GoneToo", "so is this");
  config.integer("A", 0, 0, 9);
  EXPECT_THAT(problemsOf(config), IsEmpty());
  ASSERT_EQ(config.renamedKeys().size(), 1u);
  EXPECT_EQ(
      config.renamedKeys()[0].text(),
      "a.cfg:1: key \"P.Gone\" has no effect any more: there is one filter (it ends with release 0.3.0)");
  ASSERT_EQ(config.effective().size(), 1u);
  EXPECT_EQ(config.effective()[0].key, "P.A");
}

TEST(ConfigReader, RefusesABadValueUnderTheNameThatStandsThere) {
  const auto properties = Properties::parse("P.Old=77\n", "a.cfg");
  ConfigReader config(properties, "P");
  config.alias("Old", "New");
  config.integer("New", 1, 0, 9);
  EXPECT_THAT(problemsOf(config), ElementsAre("a.cfg:1: P.Old = 77 (must be 0..9)"));
}

TEST(ConfigReader, RefusesAKeyUnderBothItsNames) {
  const auto properties = Properties::parse("P.New=1\nP.Old=2\n", "a.cfg");
  ConfigReader config(properties, "P");
  config.alias("Old", "New");
  config.integer("New", 1, 0, 9);
  EXPECT_THAT(problemsOf(config),
              ElementsAre("a.cfg:2: key \"P.Old\" is the old name of \"P.New\", which is set too"));
}

TEST(ConfigReader, ListsChildren) {
  const auto properties =
      Properties::parse("P.Obstacle.b.X=1\nP.Obstacle.a.X=1\nP.Obstacle.a.Y=1\nP.Obstacles=1\n", "a.cfg");
  EXPECT_THAT(ConfigReader(properties, "P").children("Obstacle"), ElementsAre("a", "b"));
}

TEST(ConfigReader, ListsTheEffectiveConfiguration) {
  auto properties = Properties::parse("P.B=7\n", "a.cfg");
  properties.addArgument("--P.C=hello");
  ConfigReader config(properties, "P");
  config.text("C", "");
  config.integer("B", 1, 0, 10);
  config.angleDeg("A_deg", 22.5, 0, 90);
  config.choice("D", 2, {{"one", 1}, {"two", 2}});
  std::vector<std::string> lines;
  for (const auto& setting : config.effective()) {
    lines.push_back(setting.key + " = " + setting.value + " [" + setting.origin + "]");
  }
  EXPECT_THAT(lines, ElementsAre("P.A_deg = 22.5 []", "P.B = 7 [a.cfg:1]", "P.C = hello [command line]",
                                 "P.D = two []"));
}

class ConfigPaths : public testing::Test {
 protected:
  ConfigPaths() : folder_(std::filesystem::path(testing::TempDir()) / "config_test_paths") {
    std::filesystem::create_directories(folder_);
    std::ofstream(folder_ / "beside.csv") << "x\n";
  }
  ~ConfigPaths() override { std::filesystem::remove_all(folder_); }

  const std::filesystem::path folder_;
};

TEST_F(ConfigPaths, RelativePathsCountFromTheFileAndTheFoldersAboveIt) {
  std::filesystem::create_directories(folder_ / "cfg/mine");
  std::ofstream(folder_ / "cfg/mine/own.csv") << "x\n";
  const auto properties = Properties::parse(
      "P.Map=beside.csv\nP.Own=own.csv\nP.Out=out/new\nP.Absolute=/usr\n", folder_ / "cfg/mine/a.cfg");
  ConfigReader config(properties, "P");
  EXPECT_EQ(config.requireFile("Map", "a map"), folder_ / "beside.csv");
  EXPECT_EQ(config.requireFile("Own", "a map"), folder_ / "cfg/mine/own.csv");
  EXPECT_EQ(config.outputPath("Out"), "out/new") << "an output belongs to the working directory";
  EXPECT_EQ(config.existingPath("Absolute"), "/usr");
  EXPECT_EQ(config.existingPath("Unset"), "");
  EXPECT_THAT(problemsOf(config), IsEmpty());
}

TEST_F(ConfigPaths, TheWorkingDirectoryIsFirstOnTheCommandLineAndLaterInAFile) {
  const auto before = std::filesystem::current_path();
  std::filesystem::create_directories(folder_ / "cfg");
  std::filesystem::create_directories(folder_ / "work");
  std::ofstream(folder_ / "cfg/same.csv") << "x\n";
  std::ofstream(folder_ / "work/same.csv") << "x\n";
  std::ofstream(folder_ / "work/other.csv") << "x\n";
  std::filesystem::current_path(folder_ / "work");
  auto properties = Properties::parse("P.File=same.csv\nP.Other=other.csv\n", folder_ / "cfg/a.cfg");
  properties.addArgument("--P.Typed=same.csv");
  ConfigReader config(properties, "P");
  EXPECT_EQ(config.existingPath("File"), folder_ / "cfg/same.csv");
  EXPECT_EQ(config.existingPath("Other"), "other.csv");
  EXPECT_EQ(config.existingPath("Typed"), "same.csv");
  std::filesystem::current_path(before);
  EXPECT_THAT(problemsOf(config), IsEmpty());
}

TEST_F(ConfigPaths, AbsentFilesAreNamedWithThePlacesSearched) {
  const auto file = (folder_ / "a.cfg").string();
  const auto properties = Properties::parse("P.Map=other.csv\nP.World=/no/world\nP.Palette=\n", file);
  ConfigReader config(properties, "P");
  config.requireFile("Map", "a map");
  config.existingPath("World");
  config.requireFile("Palette", "a palette file");
  config.requireFile("Robot", "a robot file");
  EXPECT_THAT(problemsOf(config),
              ElementsAre(file + ": missing key \"P.Robot\" (must be a robot file)",
                          file + ":1: P.Map = other.csv (no such file or folder in " + folder_.string() +
                              ", " + std::filesystem::current_path().string() + " or the folders above)",
                          file + ":2: P.World = /no/world (no such file or folder)",
                          file + ":3: P.Palette = (empty) (must be a palette file)"));
}

TEST(CheckIceKeys, ReportsUnknownOnesWithTheNearest) {
  const auto properties = Properties::parse(
      "Ice.MesageSizeMax=1\n"
      "Ice.MessageSizeMax=1\n"
      "Ice.ThreadPool.Server.SizeMax=4\n"
      "Ice.Plugin.IceSSL=IceSSL:createIceSSL\n"
      "IceSSL.CAs=x\n"
      "Localization.Map=a\n",
      "a.cfg");
  EXPECT_THAT(
      problemLines(checkIceKeys(properties)),
      ElementsAre("a.cfg:1: unknown key \"Ice.MesageSizeMax\" (did you mean \"Ice.MessageSizeMax\"?)"));
}

TEST(NearestName, CountsTypingErrors) {
  EXPECT_EQ(typingDistance("Mutation", "Mutation"), 0);
  EXPECT_EQ(typingDistance("Mutaton", "Mutation"), 1) << "a letter missing";
  EXPECT_EQ(typingDistance("Muattion", "Mutation"), 1) << "two letters swapped";
  EXPECT_EQ(typingDistance("mutation", "Mutation"), 1) << "case counts once";
  EXPECT_EQ(typingDistance("", "abc"), 3);
  EXPECT_EQ(typingDistance("kitten", "sitting"), 3);
  EXPECT_EQ(nearestName("Camera.Proxi", {"Camera.Proxy", "Camera.Name"}), "Camera.Proxy");
  EXPECT_EQ(nearestName("Something.Else", {"Camera.Proxy", "Camera.Name"}), "");
}

}  // namespace
}  // namespace vismem
