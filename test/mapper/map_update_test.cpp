// A map after a further drive: changes that were answered, places seen for the first time. Tests B6.
#include "mapper/core/map_update.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

namespace vismem {
namespace {

CountedRow rowOf(const Label& label, const Eigen::Vector2d& a, const Eigen::Vector2d& b, int times_seen = 10,
                 double width_m = 0.0) {
  CountedRow row;
  row.row.label = label;
  row.row.world.a << a, 0.0;
  row.row.world.b << b, 0.0;
  row.row.width_m = width_m;
  row.times_seen = times_seen;
  row.sessions = 1;
  return row;
}

Segment2 edge(double ax, double ay, double bx, double by) {
  return {{ax, ay}, {bx, by}};
}

const std::map<Label, Label> kStripes{{"line", "line_edge"}};

/// Two walls, a painted line, an upright jamb, two sides of a box.
MapHistory oldMap() {
  MapHistory history;
  history.rows = {
      rowOf("skirting", {-2.0, 1.501}, {2.0, 1.503}, 30), rowOf("skirting", {-2.0, -1.5}, {2.0, -1.5}, 20),
      rowOf("line", {-1.0, 0.0}, {1.0, 0.0}, 12, 0.05),   rowOf("jamb", {0.0, 1.5}, {0.0, 1.5}, 5),
      rowOf("box_foot", {0.5, 0.5}, {0.8, 0.5}, 9),       rowOf("box_foot", {0.8, 0.5}, {0.8, 0.8}, 8)};
  history.rows[3].row.world.b.z() = 2.0;
  SeenFloor seen;
  seen.traces = {{edge(0.5, 0.5, 0.8, 0.5), "box_foot", 9}, {edge(-2.0, 1.5, 2.0, 1.5), "skirting", 30}};
  history.seen.sessions = {seen};
  return history;
}

ListedChange moved(Decision decision) {
  return {{MapChange::Kind::kMoved,
           "box_foot",
           {edge(0.5, 0.5, 0.8, 0.5), edge(0.8, 0.5, 0.8, 0.8)},
           {edge(-0.5001, 0.5, -0.2, 0.7004)}},
          decision};
}

/// The drive saw the north wall, in a frame of its own.
MapHistory drive(const Pose2& T_old_map) {
  MapHistory history;
  history.rows = {rowOf("skirting", {-1.0, 1.49}, {1.0, 1.51}, 7),
                  rowOf("box_foot", {-0.5, 0.5}, {-0.2, 0.7}, 4)};
  history.seen.sessions = {{{}, {{edge(-0.5, 0.5, -0.2, 0.7), "box_foot", 4}}}};
  return transform(inverse(T_old_map), std::move(history));
}

bool isSame(const CountedRow& one, const CountedRow& other) {
  return one.row.world.a == other.row.world.a && one.row.world.b == other.row.world.b &&
         one.row.label == other.row.label && one.row.width_m == other.row.width_m;
}

TEST(MapUpdate, AnAcceptedMoveTakesTheThingAndLeavesAllOtherRows) {
  const MapHistory old = oldMap();
  ChangeList list;
  list.T_old_map = {3.0, -1.0, 0.8};
  list.changes = {moved(Decision::kAccept)};
  const UpdatedMap updated = updateMap(old, kStripes, list, drive(list.T_old_map));
  EXPECT_EQ(updated.kept, 4);
  EXPECT_EQ(updated.gone, 2);
  EXPECT_EQ(updated.came, 1);
  EXPECT_EQ(updated.cut, 0);
  const auto& rows = updated.history.rows;
  ASSERT_EQ(rows.size(), 5U);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_TRUE(isSame(rows[i], old.rows[i])) << i;
  EXPECT_EQ(rows[4].row.world.a, Eigen::Vector3d(-0.5, 0.5, 0.0));  // millimetres
  EXPECT_EQ(rows[4].row.world.b, Eigen::Vector3d(-0.2, 0.7, 0.0));
  EXPECT_EQ(rows[4].times_seen, 4);
  EXPECT_EQ(rows[4].sessions, 1);
}

TEST(MapUpdate, RowsAreCountedAgainWhereTheDriveSawThem) {
  ChangeList list;
  list.T_old_map = {3.0, -1.0, 0.8};
  const UpdatedMap updated = updateMap(oldMap(), kStripes, list, drive(list.T_old_map));
  EXPECT_EQ(updated.seen_again, 1);
  EXPECT_EQ(updated.history.rows[0].times_seen, 37);
  EXPECT_EQ(updated.history.rows[0].sessions, 2);
  EXPECT_EQ(updated.history.rows[1].times_seen, 20);
  EXPECT_EQ(updated.history.rows[1].sessions, 1);
  ASSERT_EQ(updated.history.seen.sessions.size(), 2U);
  // In the frame of the map.
  EXPECT_LT((updated.history.seen.sessions[1].traces[0].floor.a - Eigen::Vector2d(-0.5, 0.5)).norm(), 1e-9);
}

TEST(MapUpdate, WhatIsRejectedOrOpenLeavesTheMapAsItWas) {
  for (const Decision decision : {Decision::kReject, Decision::kOpen}) {
    const MapHistory old = oldMap();
    ChangeList list;
    list.changes = {moved(decision)};
    list.rejected = {{true, "skirting", {edge(0.0, 1.5, 1.0, 1.5)}}};
    const UpdatedMap updated = updateMap(old, kStripes, list, drive({}));
    ASSERT_EQ(updated.history.rows.size(), old.rows.size());
    for (std::size_t i = 0; i < old.rows.size(); ++i)
      EXPECT_TRUE(isSame(updated.history.rows[i], old.rows[i]));
    // What was rejected is remembered: the thing that is gone, and where it came.
    EXPECT_EQ(updated.history.rejected.size(), decision == Decision::kReject ? 3U : 1U);
  }
}

TEST(MapUpdate, APartOfAWallIsCutOut) {
  ChangeList list;
  list.changes = {
      {{MapChange::Kind::kRemoved, "skirting", {edge(0.0, -1.5, 0.9, -1.5)}, {}}, Decision::kAccept}};
  const UpdatedMap updated = updateMap(oldMap(), kStripes, list, drive({}));
  EXPECT_EQ(updated.cut, 1);
  EXPECT_EQ(updated.kept, 5);
  const auto& rows = updated.history.rows;
  ASSERT_EQ(rows.size(), 7U);
  EXPECT_EQ(rows[1].row.world.a, Eigen::Vector3d(-2.0, -1.5, 0.0));
  EXPECT_NEAR(rows[1].row.world.b.x(), 0.0, 3e-3);
  EXPECT_NEAR(rows[2].row.world.a.x(), 0.9, 3e-3);
  EXPECT_EQ(rows[2].row.world.b, Eigen::Vector3d(2.0, -1.5, 0.0));
}

TEST(MapUpdate, APaintedLineIsGoneOnlyWithBothItsEdges) {
  ChangeList list;
  list.changes = {
      {{MapChange::Kind::kRemoved, "line_edge", {edge(-1.0, 0.025, 1.0, 0.025)}, {}}, Decision::kAccept}};
  EXPECT_EQ(updateMap(oldMap(), kStripes, list, drive({})).kept, 6);
  list.changes[0].change.before.push_back(edge(1.0, -0.025, -1.0, -0.025));
  const UpdatedMap updated = updateMap(oldMap(), kStripes, list, drive({}));
  EXPECT_EQ(updated.gone, 1);
  EXPECT_TRUE(std::none_of(updated.history.rows.begin(), updated.history.rows.end(),
                           [](const CountedRow& row) { return row.row.label == "line"; }));
}

TEST(MapUpdate, APlaceSeenForTheFirstTimeContinuesTheWall) {
  const MapHistory old = oldMap();
  ChangeList list;
  list.added = {rowOf("skirting", {2.06, 1.51}, {5.0, 1.52}).row,
                rowOf("skirting", {5.0, 1.5}, {5.0, 4.0}).row};
  const UpdatedMap updated = updateMap(old, kStripes, list, drive({}));
  EXPECT_EQ(updated.added, 2);
  const auto& rows = updated.history.rows;
  EXPECT_TRUE(isSame(rows[0], old.rows[0]));
  EXPECT_EQ(rows[6].row.world.a, old.rows[0].row.world.b);
  EXPECT_EQ(rows[6].row.world.b, Eigen::Vector3d(5.0, 1.52, 0.0));
  EXPECT_EQ(rows[7].row.world.a, Eigen::Vector3d(5.0, 1.5, 0.0));
}

TEST(MapUpdate, TracesOfWhatWentDoNotHideThatItReturns) {
  ChangeList list;
  list.changes = {moved(Decision::kAccept)};
  const UpdatedMap updated = updateMap(oldMap(), kStripes, list, drive({}));
  ASSERT_EQ(updated.history.seen.sessions[0].traces.size(), 1U);
  EXPECT_EQ(updated.history.seen.sessions[0].traces[0].label, "skirting");
}

}  // namespace
}  // namespace vismem
