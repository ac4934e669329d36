// What is known of a map beside its rows. Tests B6.
#include "mapper/core/map_history.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/config/config_error.h"

namespace vismem {
namespace {

MapSegment rowOf(const Label& label, const Eigen::Vector2d& a, const Eigen::Vector2d& b,
                 double width_m = 0.0) {
  MapSegment row;
  row.label = label;
  row.world.a << a, 0.0;
  row.world.b << b, 0.0;
  row.width_m = width_m;
  return row;
}

MapHistory twoSessions() {
  MapHistory history;
  history.seen.is_complete = true;
  history.rows = {{rowOf("skirting", {0.0, 1.5}, {2.0, 1.5}), 41, 2},
                  {rowOf("line", {0.0, 0.0}, {1.0, 0.0}, 0.05), 3, 1}};
  history.rejected = {{true, "box_foot", {{{0.0, 0.0}, {0.3, 0.0}}, {{0.3, 0.0}, {0.3, 0.3}}}},
                      {false, "box2_foot", {{{1.0, 0.0}, {1.3, 1.0 / 3.0}}}}};
  SeenFloor seen;
  Pose3 T = toPose3(Pose2{0.1, -0.7, 2.0});
  T.translation().z() = 0.9;
  seen.views = {{intrinsicsFromFieldOfView(320, 240, 1.0), T}};
  seen.traces = {{{{0.0, 0.1}, {0.2, 1.0 / 3.0}}, "skirting", 4}};
  history.seen.sessions = {seen, {}};
  return history;
}

std::string problemOf(const std::string& text) {
  try {
    parseMapHistory(text, "map.history");
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

TEST(MapHistory, IsReadBackAsItWasWritten) {
  const MapHistory history = twoSessions();
  const std::string text = writeMapHistory(history);
  const MapHistory read = parseMapHistory(text, "map.history");
  EXPECT_EQ(writeMapHistory(read), text);
  ASSERT_EQ(read.seen.sessions.size(), 2U);
  EXPECT_TRUE(read.seen.is_complete);
  EXPECT_TRUE(read.seen.sessions[0].views[0].T_map_camera.isApprox(
      history.seen.sessions[0].views[0].T_map_camera, 0.0));
  EXPECT_EQ(read.seen.sessions[0].views[0].intrinsics, history.seen.sessions[0].views[0].intrinsics);
  EXPECT_EQ(read.seen.sessions[0].traces[0].sightings, 4);
  EXPECT_EQ(read.rows[0].times_seen, 41);
  EXPECT_EQ(read.rows[1].row.width_m, 0.05);
  EXPECT_EQ(read.rejected[0].edges.size(), 2U);
}

TEST(MapHistory, NamesLineFieldFoundAndExpected) {
  EXPECT_EQ(problemOf("history 1\nview 1\n"), "map.history:2: a view before the camera of its session");
  EXPECT_EQ(problemOf("history 1\ntrace line 3 0 0 1 1\n"),
            "map.history:2: a trace before the first session");
  EXPECT_EQ(problemOf("history 1\nrow line 0 -1 1 0 0 1 1\n"),
            "map.history:2: times seen = -1 (must be a whole number 0..1000000000)");
  EXPECT_EQ(problemOf("history 1\ncomplete yes\n"),
            "map.history:2: complete = yes (must be a whole number 0..1)");
  EXPECT_EQ(problemOf("history 1\nrows\n"),
            "map.history:2: \"rows\" (must be complete, row, gone, came, session, camera, view or trace)");
  EXPECT_EQ(problemOf("history 1\ngone box_foot 0 0 1\n"), "map.history:2: the line ends before y");
}

TEST(MapHistory, RowsThatWereEditedSinceHaveNoCount) {
  SegmentMap map;
  map.segments = {rowOf("skirting", {2.0, 1.5}, {0.0, 1.5}), rowOf("line", {0.0, 0.0}, {1.2, 0.0}, 0.05),
                  rowOf("door_foot", {0.0, 1.5}, {2.0, 1.5})};
  const auto rows = countedRows(map, twoSessions());
  ASSERT_EQ(rows.size(), 3U);
  EXPECT_EQ(rows[0].times_seen, 41);  // also with its ends in the other order
  EXPECT_EQ(rows[0].sessions, 2);
  EXPECT_EQ(rows[1].sessions, 0);
  EXPECT_EQ(rows[2].sessions, 0);
}

TEST(MapHistory, WhatAPersonOverruledIsNoTrace) {
  DriveRecord record;
  record.keyframes.resize(1);
  for (const std::uint64_t id : {7, 8}) {
    record.elements[id].label = id == 7 ? "crate_foot" : "skirting";
    record.elements[id].sightings = 5;
  }
  ASSERT_EQ(seenBy(record, {{}}).traces.size(), 2U);
  const SeenFloor seen = seenBy(record, {{}}, {7});
  ASSERT_EQ(seen.traces.size(), 1U);
  EXPECT_EQ(seen.traces[0].label, "skirting");
}

TEST(MapHistory, MovesAsAWhole) {
  const Pose2 T{1.0, 2.0, 0.7};
  const MapHistory moved = transform(T, twoSessions());
  const MapHistory back = transform(inverse(T), moved);
  const MapHistory history = twoSessions();
  EXPECT_LT((back.rows[0].row.world.b - history.rows[0].row.world.b).norm(), 1e-12);
  EXPECT_LT((back.rejected[1].edges[0].b - history.rejected[1].edges[0].b).norm(), 1e-12);
  EXPECT_LT((back.seen.sessions[0].traces[0].floor.b - history.seen.sessions[0].traces[0].floor.b).norm(),
            1e-12);
  EXPECT_TRUE(
      back.seen.sessions[0].views[0].T_map_camera.isApprox(history.seen.sessions[0].views[0].T_map_camera));
  EXPECT_GT((moved.rows[0].row.world.b - history.rows[0].row.world.b).norm(), 1.0);
}

TEST(MapHistory, PaintedLinesAreTwoEdgesWithTheirCount) {
  const auto edges = expandStripes(twoSessions().rows, {{"line", "line_edge"}});
  ASSERT_EQ(edges.size(), 3U);
  EXPECT_EQ(edges[1].row.label, "line_edge");
  EXPECT_EQ(edges[1].times_seen, 3);
  EXPECT_EQ(edges[2].times_seen, 3);
}

}  // namespace
}  // namespace vismem
