// The files of a map that is brought up to date. Tests B6.
#include "mapper/app/map_updating.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "common/config/config_error.h"
#include "common/config/text_file.h"
#include "common/segment_map/segment_map.h"
#include "evaluation/core/trajectory_io.h"
#include "mapper/core/change_list.h"
#include "support/temporary_folder.h"

namespace vismem {
namespace {

constexpr const char* kMap =
    "x1_m,y1_m,z1_m,x2_m,y2_m,z2_m,label\n"
    "-2,1.5,0,2,1.507,0,skirting\n"
    "0.5,0.5,0,0.8,0.5,0,box_foot\n";
constexpr const char* kPalette =
    "class.floor = value 0..30\nclass.wall = value 38..85\nclass.box = value 86..100\n"
    "pair.skirting = floor wall\npair.box_foot = floor box\n";
constexpr const char* kChanges =
    "changes 1\nframe 0 0 0\nchange 1 open moved box_foot\nwas 0.5 0.5 0.8 0.5\nnow 0.5 -0.5 0.8 -0.5\n"
    "change 2 open removed skirting\nwas -2 1.5 0 1.5035\nadded skirting 2.01 1.5 4 1.5\n";
constexpr const char* kDrive = "history 1\nrow skirting 0 7 1 -2 1.5 2 1.5\nsession\n";

class MapUpdating : public testing::Test {
 protected:
  MapUpdating() {
    write("old.csv", kMap);
    write("old.palette", kPalette);
    write("today.changes", kChanges);
    write("today.history", kDrive);
    options_.map = folder_.path() / "old.csv";
    options_.changes = folder_.path() / "today.changes";
    options_.out = folder_.path() / "new";
  }
  void write(const std::string& name, const std::string& text) { writeTextFile(folder_.path() / name, text); }
  std::string read(const std::string& name) { return readTextFile(options_.out / name, "what was written"); }
  std::string problem() {
    try {
      updateMapFiles(options_);
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "";
  }

  TemporaryFolder folder_;
  MapUpdateOptions options_;
};

TEST_F(MapUpdating, WritesTheMapWithItsHistory) {
  options_.accept = "1";
  options_.reject = "2";
  const nlohmann::json summary = updateMapFiles(options_);
  EXPECT_EQ(summary["accepted"], 1);
  EXPECT_EQ(summary["rejected"], 1);
  EXPECT_EQ(summary["open"], 0);
  EXPECT_EQ(
      read("map.csv"),
      "x1_m,y1_m,z1_m,x2_m,y2_m,z2_m,label\n-2,1.5,0,2,1.507,0,skirting\n0.5,-0.5,0,0.8,-0.5,0,box_foot\n"
      "2,1.507,0,4,1.5,0,skirting\n");
  EXPECT_EQ(read("map.palette"), kPalette);
  const auto segments = nlohmann::json::parse(read("map.json"))["segments"];
  EXPECT_EQ(segments[0]["times_seen"], 7);
  EXPECT_THAT(read("map.history"), testing::HasSubstr("complete 1\n"));  // a drawing showed all of it
  EXPECT_THAT(read("map.history"), testing::HasSubstr("\ngone skirting -2 1.5 0 1.5035\n"));
}

TEST_F(MapUpdating, TakesItsOwnMapFurther) {
  options_.accept = "all";
  updateMapFiles(options_);
  options_.map = options_.out / "map.csv";
  write("today.changes", "changes 1\n");
  const std::string before = read("map.csv");
  const nlohmann::json summary = updateMapFiles(options_);  // into the same folder
  EXPECT_EQ(summary["sessions"], 2);
  EXPECT_EQ(read("map.csv"), before);
}

TEST_F(MapUpdating, TakesAListOnceAndOnlyThatOfItsOwnMap) {
  const std::int64_t rows = checksumOf(loadSegmentMap(options_.map));
  write("today.changes", "changes 1\nmap " + std::to_string(rows) + std::string(kChanges).substr(9));
  options_.accept = "1";
  EXPECT_EQ(updateMapFiles(options_)["rows"]["came"], 1);
  options_.map = options_.out / "map.csv";
  EXPECT_THAT(problem(), testing::HasSubstr("today.changes: is about other rows than those of"));
}

TEST_F(MapUpdating, NamesTheFileThatIsWrong) {
  options_.accept = "3";
  EXPECT_EQ(problem(), "--accept 3: \"3\" (must be all, or numbers 1..2 joined by ',')");
  options_.accept = "";
  write("today.history", "history 1\nsession 1\n");
  EXPECT_THAT(problem(), testing::EndsWith("today.history:2: \"1\" is one word too many"));
  std::filesystem::remove(folder_.path() / "today.history");
  EXPECT_THAT(problem(), testing::HasSubstr("must be the history of the drive, beside its changes"));
  write("today.history", kDrive);
  write("today.changes", "changes 1\nchange 1 accept removed box_foot\nwas 0 0 x 0\n");
  EXPECT_THAT(problem(), testing::EndsWith("today.changes:3: x = \"x\" (must be a finite number)"));
}

}  // namespace
}  // namespace vismem
