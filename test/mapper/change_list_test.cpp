// A list of changes that a person answers. Tests B6.
#include "mapper/core/change_list.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/config/config_error.h"

namespace vismem {
namespace {

ChangeList threeChanges() {
  ChangeList list;
  list.T_old_map = {1.0 / 3.0, -2.0, 0.1};
  const Segment2 here{{0.1, 0.2}, {1.0 / 7.0, 0.4}};
  const Segment2 there{{1.1, 0.2}, {1.1, 0.4}};
  list.changes = {{{MapChange::Kind::kMoved, "box_foot", {here}, {there, here}}, Decision::kOpen},
                  {{MapChange::Kind::kRemoved, "line", {here}, {}}, Decision::kReject},
                  {{MapChange::Kind::kNew, "box2_foot", {}, {there}}, Decision::kAccept}};
  MapSegment row;
  row.label = "skirting";
  row.world.b.x() = 2.5;
  list.added = {row};
  list.rejected = {{true, "box_foot", {here, there}}, {false, "line", {there}}};
  list.map = 4711;
  return list;
}

std::vector<Decision> decisionsOf(const ChangeList& list) {
  std::vector<Decision> decisions;
  for (const ListedChange& listed : list.changes) decisions.push_back(listed.decision);
  return decisions;
}

std::string problemOf(const std::string& text) {
  try {
    parseChangeList(text, "map.changes");
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

TEST(ChangeList, IsReadBackAsItWasWritten) {
  const ChangeList list = threeChanges();
  const std::string text = writeChangeList(list);
  const ChangeList read = parseChangeList(text, "map.changes");
  EXPECT_EQ(writeChangeList(read), text);
  ASSERT_EQ(read.changes.size(), 3U);
  EXPECT_EQ(read.T_old_map, list.T_old_map);
  EXPECT_EQ(decisionsOf(read), decisionsOf(list));
  EXPECT_EQ(read.changes[0].change.now.size(), 2U);
  EXPECT_EQ(read.changes[0].change.before[0].b, list.changes[0].change.before[0].b);
  EXPECT_EQ(read.map, list.map);
  EXPECT_EQ(read.added.size(), 1U);
  ASSERT_EQ(read.rejected.size(), 2U);
  EXPECT_EQ(read.rejected[0].edges.size(), 2U);
}

TEST(ChangeList, SaysInWordsWhatChanged) {
  EXPECT_THAT(
      writeChangeList(threeChanges()),
      testing::HasSubstr("# moved box_foot from 0.12 0.30 to 0.61 0.30\nchange 1 open moved box_foot\n"));
}

TEST(ChangeList, NamesLineFieldFoundAndExpected) {
  EXPECT_EQ(problemOf("changes 1\nchange 1 maybe new box_foot\n"),
            "map.changes:2: decision = \"maybe\" (must be one of: open, accept, reject)");
  EXPECT_EQ(problemOf("changes 1\nchange 1 open gone box_foot\n"),
            "map.changes:2: kind = \"gone\" (must be one of: moved, removed, new)");
  EXPECT_EQ(problemOf("changes 1\nchange 2 open new box_foot\n"),
            "map.changes:2: number = 2 (must be a whole number 1..1)");
  EXPECT_EQ(problemOf("changes 1\nnow 0 0 1 x\n"), "map.changes:2: \"now\" before the first change");
  EXPECT_EQ(problemOf("changes 1\nchange 1 open new a\nnow 0 0 1 x\n"),
            "map.changes:3: y = \"x\" (must be a finite number)");
  EXPECT_EQ(problemOf("changes 1\nchange 1 open new a\nwas 0 0 1 1\n"),
            "map.changes:3: \"was\" of a change that is new (must be \"now\")");
  EXPECT_EQ(problemOf("changes 1\nchange 1 open removed a\n"),
            "map.changes: change 1 (removed) has no line \"was\" (must be 1 or more)");
  EXPECT_EQ(problemOf("changes 1\nframe 0 0 0 0\n"), "map.changes:2: \"0\" is one word too many");
  EXPECT_EQ(problemOf("history 1\n"), "map.changes:1: \"history\" (must be \"changes 1\")");
  EXPECT_EQ(problemOf("# nothing\n"), "map.changes: is empty (must begin with \"changes 1\")");
}

TEST(ChangeList, ACommandDecides) {
  using enum Decision;
  const auto decided = [](const std::string& accept, const std::string& reject) {
    ChangeList list = threeChanges();
    decide(list, accept, reject);
    return decisionsOf(list);
  };
  EXPECT_EQ(decided("", ""), (std::vector{kOpen, kReject, kAccept}));
  EXPECT_EQ(decided("1,2", ""), (std::vector{kAccept, kAccept, kAccept}));
  EXPECT_EQ(decided("1", "all"), (std::vector{kAccept, kReject, kAccept}));
  // What the file says stays: "all" is what is open.
  EXPECT_EQ(decided("", "all"), (std::vector{kReject, kReject, kAccept}));
  EXPECT_EQ(decided("all", "3"), (std::vector{kAccept, kReject, kReject}));
}

TEST(ChangeList, ANumberOfAListWithoutChangesIsNamed) {
  ChangeList list;
  try {
    decide(list, "1", "");
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_STREQ(error.what(), "--accept 1: \"1\" (must be nothing: the list has no changes)");
  }
  decide(list, "all", "");
  EXPECT_TRUE(list.changes.empty());
}

TEST(ChangeList, AWrongCommandIsNamed) {
  const auto problem = [](const std::string& accept, const std::string& reject) -> std::string {
    ChangeList list = threeChanges();
    try {
      decide(list, accept, reject);
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(problem("4", ""), "--accept 4: \"4\" (must be all, or numbers 1..3 joined by ',')");
  EXPECT_EQ(problem("", "1,x"), "--reject 1,x: \"x\" (must be all, or numbers 1..3 joined by ',')");
  EXPECT_EQ(problem("2", "2"), "change 2 (must be accepted or rejected, not both)");
  EXPECT_EQ(problem("all", "all"), "--accept all and --reject all (must be one of both)");
}

}  // namespace
}  // namespace vismem
