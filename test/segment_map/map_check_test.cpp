// Tests of common/segment_map/map_check: a map and a palette that do not belong together.
#include "common/segment_map/map_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/config/config_error.h"

namespace vismem {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const std::string kHeader = "x1_m,y1_m,z1_m,x2_m,y2_m,z2_m,label,width_m\n";
const PaletteLabels kLabels{{"skirting", "door_foot", "line_edge"}, {{"line", "line_edge"}}, {}};

std::vector<std::string> warningsOf(const std::string& rows) {
  const auto map = parseSegmentMap(kHeader + rows, "m.csv");
  return checkMap(map, "m.csv", kLabels, "m.palette");
}

const std::string kSound = "0,0,0,1,0,0,skirting\n1,0,0,2,0,0,door_foot\n0,1,0,2,1,0,line,0.05\n";

TEST(CheckMap, ASoundMapGivesNoWarning) {
  EXPECT_THAT(warningsOf(kSound), IsEmpty());
}

TEST(CheckMap, ALabelThatNoPairNamesIsReportedOnceWithTheNearestName) {
  EXPECT_THAT(warningsOf(kSound + "0,2,0,1,2,0,skirtnig\n1,2,0,2,2,0,skirtnig\n"),
              ElementsAre("m.csv:5: label \"skirtnig\" is named by no pair of m.palette (did you mean "
                          "\"skirting\"?): its segments are never observed"));
}

TEST(CheckMap, APairThatNoRowHasIsReported) {
  EXPECT_THAT(warningsOf("0,0,0,1,0,0,skirting\n0,1,0,2,1,0,line,0.05\n"),
              ElementsAre("m.palette: label \"door_foot\" stands in no row of m.csv: its observations match "
                          "nothing"));
}

TEST(CheckMap, PairsThatNoRowHasShareAWarning) {
  EXPECT_THAT(warningsOf("0,1,0,2,1,0,line,0.05\n"),
              ElementsAre("m.palette: labels \"door_foot\" and \"skirting\" stand in no row of m.csv: their "
                          "observations match nothing"));
}

TEST(CheckMap, AMapMayLackUprightEdgesButNotMisspellThem) {
  const PaletteLabels labels{{"skirting", "door_jamb"}, {}, {"door_jamb"}};
  const auto warnings = [&](const std::string& more) {
    return checkMap(parseSegmentMap(kHeader + "0,0,0,1,0,0,skirting\n" + more, "m.csv"), "m.csv", labels,
                    "m.palette");
  };
  EXPECT_THAT(warnings(""), IsEmpty());
  EXPECT_THAT(warnings("1,0,0,1,0,2,door_jam\n"),
              Contains(HasSubstr("label \"door_jamb\" stands in no row of m.csv (did you mean")));
}

TEST(CheckMap, AnyMatchesEveryLabel) {
  EXPECT_THAT(warningsOf("0,0,0,1,0,0,any\n"), IsEmpty());
}

TEST(CheckMap, RepeatedRowsAreReportedInEitherDirection) {
  EXPECT_THAT(warningsOf(kSound + "1,0,0,0,0,0,skirting\n"),
              ElementsAre("m.csv:5: the segment of line 2 again (it counts twice)"));
}

TEST(CheckMap, ALastRowWithoutALineBreakMayBeCutOff) {
  EXPECT_THAT(warningsOf(kSound + "3,0,0,4,0,0,skirting"),
              ElementsAre("m.csv:5: the file ends without a line break: this row may be cut off"));
}

TEST(CheckMap, NothingLeftToLocalizeByIsAnError) {
  try {
    warningsOf("0,0,0,1,0,0,wall\n1,0,0,2,0,0,floor\n");
    FAIL() << "accepted";
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.problems(),
                ElementsAre("m.csv: no label of the map is named by a pair of m.palette (map: floor, wall; "
                            "palette: door_foot, line_edge, skirting)"));
  }
}

}  // namespace
}  // namespace vismem
