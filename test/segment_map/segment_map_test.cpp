// Loading, checking, saving and expanding maps.
// Tests L4, L5.
#include "common/segment_map/segment_map.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "common/config/config_error.h"
#include "support/build_paths.h"

namespace vismem {
namespace {

using testing::ElementsAre;

std::vector<std::string> problemsOf(const std::string& text) {
  try {
    parseSegmentMap(text, "m.csv");
  } catch (const ConfigError& error) {
    return error.problems();
  }
  return {};
}

const std::string kHeader = "x1_m,y1_m,z1_m,x2_m,y2_m,z2_m,label\n";
const std::string kWidthHeader = "x1_m,y1_m,z1_m,x2_m,y2_m,z2_m,label,width_m\n";

TEST(SegmentMap, ReadsRowsCommentsAndWidths) {
  const SegmentMap map = parseSegmentMap(
      "# a map\n" + kWidthHeader +
          "0,0,0, 3,4,0 , line , 0.05 # middle\n\n-1,2,0.5,-1,2,1.5,door,\n1,1,0,2,1,0,any\r\n",
      "m.csv");
  ASSERT_EQ(map.segments.size(), 3u);
  EXPECT_DOUBLE_EQ(map.segments[0].world.length(), 5.0);
  EXPECT_EQ(map.segments[0].label, "line");
  EXPECT_EQ(map.segments[0].width_m, 0.05);
  EXPECT_EQ(map.segments[1].label, "door");
  EXPECT_EQ(map.segments[1].width_m, 0.0);
  EXPECT_EQ(map.segments[2].label, kAnyLabel);
  EXPECT_EQ(map.low(), Eigen::Vector2d(-1, 0));
  EXPECT_EQ(map.high(), Eigen::Vector2d(3, 4));
}

TEST(SegmentMap, ReportsEveryProblemAtOnceWithLineAndColumn) {
  EXPECT_THAT(
      problemsOf(kWidthHeader + "0,0,0,1,x,0,line,0.05\n"
                                "0,0,0,1,nan,0,9line,-1\n"
                                "0,0,0,1\n"
                                "2,2,0,2,2,0,line\n"
                                "2,2,0,2,2,1,line,0.1\n"
                                "0,0,0,1,1,0,unknown\n"
                                "0,0,0,1,1,0,line,0.05,7\n"),
      ElementsAre("m.csv:2:9: y2_m = \"x\" (must be a finite number)",
                  "m.csv:3:9: y2_m = \"nan\" (must be a finite number)",
                  "m.csv:3:15: label = \"9line\" (must be letters, digits and _, beginning with a letter)",
                  "m.csv:3:21: width_m = \"-1\" (must be 0 or more)", "m.csv:4:1: 4 columns (must be 7 or 8)",
                  "m.csv:5:1: both ends are the same point (a segment needs a length)",
                  "m.csv:6:18: width_m = \"0.1\" (an upright segment has no width in plan view)",
                  "m.csv:7:13: label = \"unknown\" (is reserved; a line of every label is \"any\")",
                  "m.csv:8:1: 9 columns (must be 7 or 8)"));
}

TEST(SegmentMap, WantsItsHeaderAndAtLeastOneSegment) {
  EXPECT_THAT(
      problemsOf("a,b\n0,0,0,1,0,0,line\n"),
      ElementsAre("m.csv:1:1: header = \"a,b\" (must be \"x1_m,y1_m,z1_m,x2_m,y2_m,z2_m,label[,width_m]\")"));
  EXPECT_THAT(
      problemsOf("# only a comment\n"),
      ElementsAre("m.csv: no header line, expected \"x1_m,y1_m,z1_m,x2_m,y2_m,z2_m,label[,width_m]\""));
  EXPECT_THAT(problemsOf(kHeader), ElementsAre("m.csv: no segments"));
  EXPECT_THAT(problemsOf(kHeader + "0,0,0,1,0,0,line,0.05\n"),
              ElementsAre("m.csv:2:1: 8 columns (must be 7)"));
}

TEST(SegmentMap, AFileThatCannotBeReadIsNamed) {
  try {
    loadSegmentMap("/nowhere/map.csv");
    FAIL() << "no error";
  } catch (const ConfigError& error) {
    EXPECT_STREQ(
        error.what(),
        "/nowhere/map.csv: cannot be read (No such file or directory; must be a map of labelled segments)");
  }
}

TEST(SegmentMap, SavedAndLoadedAgainIsTheSame) {
  SegmentMap map;
  map.segments.push_back({{{0.1, -1.0 / 3.0, 0}, {1e-9, 2.5, 0}}, "skirting", 0.0});
  map.segments.push_back({{{0, 0, 0}, {1, 0, 0}}, "line", 0.05});
  const auto file =
      std::filesystem::temp_directory_path() / ("vismem_map_" + std::to_string(::getpid()) + ".csv");
  saveSegmentMap(map, file);
  const SegmentMap again = loadSegmentMap(file);
  std::filesystem::remove(file);
  ASSERT_EQ(again.segments.size(), map.segments.size());
  for (std::size_t i = 0; i < map.segments.size(); ++i) {
    EXPECT_EQ(again.segments[i].world.a, map.segments[i].world.a);
    EXPECT_EQ(again.segments[i].world.b, map.segments[i].world.b);
    EXPECT_EQ(again.segments[i].label, map.segments[i].label);
    EXPECT_EQ(again.segments[i].width_m, map.segments[i].width_m);
  }
}

TEST(SegmentMap, SavingWhereNothingCanBeWrittenIsAnError) {
  SegmentMap map;
  map.segments.push_back({{{0, 0, 0}, {1, 0, 0}}, "line", 0.0});
  try {
    saveSegmentMap(map, "/nowhere/map.csv");
    FAIL() << "no error";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "/nowhere/map.csv: cannot be written");
  }
}

// A stripe along x, 0.1 m wide: edges at y = +0.05 (left of a -> b) and -0.05.
TEST(SegmentMap, ExpandsAStripeIntoItsTwoEdges) {
  SegmentMap map;
  map.segments.push_back({{{0, 0, 0}, {2, 0, 0}}, "line", 0.1});
  map.segments.push_back({{{0, 1, 0}, {2, 1, 0}}, "door", 0.0});
  const SegmentMap edges = expandStripes(map, {{"line", "stripe_edge"}});
  ASSERT_EQ(edges.segments.size(), 3u);
  EXPECT_EQ(edges.segments[0].world.a, Eigen::Vector3d(0, 0.05, 0));
  EXPECT_EQ(edges.segments[0].world.b, Eigen::Vector3d(2, 0.05, 0));
  EXPECT_EQ(edges.segments[1].world.b, Eigen::Vector3d(2, -0.05, 0));
  EXPECT_EQ(edges.segments[0].label, "stripe_edge");
  EXPECT_EQ(edges.segments[1].label, "stripe_edge");
  EXPECT_EQ(edges.segments[2].label, "door");
  EXPECT_EQ(edges.segments[0].width_m, 0.0);
  EXPECT_EQ(expandStripes(map, {}).segments[0].label, "line");
}

TEST(SegmentMap, AnyFitsEveryLabelButUnknown) {
  EXPECT_TRUE(labelFitsMap("skirting", "skirting"));
  EXPECT_TRUE(labelFitsMap("skirting", kAnyLabel));
  EXPECT_FALSE(labelFitsMap("skirting", "door"));
  EXPECT_FALSE(labelFitsMap(kUnknownLabel, kAnyLabel));
}

TEST(SegmentMap, ReadsTheFieldOfTheNaoRecording) {
  const char* data = std::getenv("AVM_DATA");
  const std::filesystem::path folder = data != nullptr
                                           ? std::filesystem::path(data)
                                           : std::filesystem::path(VISMEM_SOURCE_DIR) / "../shared/data";
  const auto file = folder / "nao_field_2009/map.csv";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is absent (set AVM_DATA)";
  const SegmentMap map = loadSegmentMap(file);
  EXPECT_NEAR(map.high().x(), 3.0, 0.1);
  EXPECT_NEAR(map.low().y(), -2.0, 0.1);
}

}  // namespace
}  // namespace vismem
