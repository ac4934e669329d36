// A person's edits, replayed after each solve. Tests B6.
#include "mapper/core/map_edits.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "common/config/config_error.h"
#include "mapper/core/drive_mapper.h"
#include "mapper/core/drive_record_io.h"
#include "synthetic_drive.h"

namespace vismem {
namespace {

using testing::HasSubstr;

SyntheticDrive hall() {
  return drive(straightCorridor(), wayThrough({{-4.0, 0.0}, {4.0, 0.0}}, 8.0), {});
}

DriveMapperParams params() {
  DriveMapperParams made;
  made.graph.odometry.turn_noise = 0.008;
  return made;
}

DriveMap mapWith(const DriveRecord& record, const std::string& edits) {
  DriveMapperParams with = params();
  with.edits = parseMapEdits(edits, "map.edits");
  return mapDrive(record, {}, with);
}

const LineLandmark* find(const DriveMap& map, std::uint64_t id) {
  for (const LineLandmark& landmark : map.state.landmarks) {
    if (landmark.id == id) return &landmark;
  }
  return nullptr;
}

/// The two longest door feet with closed ends.
std::vector<std::uint64_t> doors(const DriveMap& map) {
  std::vector<std::uint64_t> ids;
  for (const LineLandmark& landmark : map.state.landmarks) {
    if (landmark.label == "door_foot" && landmark.a.closed && landmark.b.closed) ids.push_back(landmark.id);
  }
  return ids;
}

TEST(MapEdits, AChordOfACircleIsDeletedOrRelabelledOnly) {
  MapState state;
  for (const std::uint64_t id : {100, 200}) {
    LineLandmark landmark;
    landmark.id = id;
    landmark.circle = id == 200 ? 0 : -1;
    state.landmarks.push_back(landmark);
  }
  const auto edits =
      parseMapEdits("join 100 200\nsplit 200 0.1 0.2\nsquare 100 200\nlength 200 0.3\n", "map.edits");
  const auto notes = applyEdits(edits, state);
  ASSERT_EQ(notes.size(), 4U);
  EXPECT_EQ(notes[0], "map.edits:1: chords of a circle can be deleted and relabelled only");
  EXPECT_TRUE(constraintsOf(edits, state).empty());
  EXPECT_EQ(state.landmarks.size(), 2U);
  EXPECT_TRUE(applyEdits(parseMapEdits("delete 200\n", "map.edits"), state).empty());
  EXPECT_EQ(state.landmarks.size(), 1U);
}

TEST(MapEdits, ALengthThatIsNotOfTheEdgeHasNoEffect) {
  MapState state;
  state.poses.push_back({});
  LineLandmark closed;
  closed.id = 100;
  closed.anchor = 0;
  closed.a = {-0.35, true};
  closed.b = {0.35, true};
  LineLandmark open = closed;
  open.id = 200;
  open.b.closed = false;
  state.landmarks = {closed, open};
  const auto notesOf = [&](const std::string& text) {
    return applyEdits(parseMapEdits(text, "map.edits"), state);
  };
  const auto constraints = [&](const std::string& text) {
    return constraintsOf(parseMapEdits(text, "map.edits"), state).size();
  };
  const auto notes = notesOf("length 100 3\nlength 100 0.07\nlength 200 0.07\n");
  ASSERT_EQ(notes.size(), 3U);
  EXPECT_EQ(notes[0],
            "map.edits:1: edge 100 is 0.70 m long (must be within a factor of 1.5 of the measured 3 m): it "
            "stays as it is");
  EXPECT_EQ(constraints("length 100 3\nlength 100 0.07\nlength 200 0.07\n"), 0U);
  // What was hidden of an edge may be longer than what was seen.
  EXPECT_TRUE(notesOf("length 100 0.8\nlength 200 3\n").empty());
  EXPECT_EQ(constraints("length 100 0.8\nlength 200 3\n"), 2U);
}

TEST(MapEdits, OverruleWhatTheMemorySawOfTheEdgesThatTheyDeny) {
  MapState state;
  state.poses.push_back({});
  for (const std::uint64_t id : {100, 200, 300, 400}) {
    LineLandmark landmark;
    landmark.id = id;
    landmark.elements = {id / 100, id / 100 + 10};
    landmark.b.t_m = 1.0;
    state.landmarks.push_back(landmark);
  }
  const auto edits =
      parseMapEdits("delete 100\nrelabel 200 crate\nsplit 300 0.2 0.4\nlength 400 1.1\n", "map.edits");
  EXPECT_TRUE(applyEdits(edits, state).empty());
  EXPECT_EQ(state.overruled, (std::set<std::uint64_t>{1, 11, 2, 12, 3, 13}));
}

TEST(MapEdits, AreReplayedAfterEachSolve) {
  const SyntheticDrive drive = hall();
  const DriveMap first = mapDrive(drive.record, {}, params());
  const auto ids = doors(first);
  ASSERT_GE(ids.size(), 3u);
  const std::string edits = "delete " + std::to_string(ids[0]) + "\nrelabel " + std::to_string(ids[1]) +
                            " cupboard_foot\nlength " + std::to_string(ids[2]) + " 0.95  # measured\n";
  for (int solve = 0; solve < 2; ++solve) {
    const DriveMap edited = mapWith(drive.record, edits);
    EXPECT_EQ(edited.problem, "");
    EXPECT_EQ(find(edited, ids[0]), nullptr);
    ASSERT_NE(find(edited, ids[1]), nullptr);
    EXPECT_EQ(find(edited, ids[1])->label, "cupboard_foot");
    ASSERT_NE(find(edited, ids[2]), nullptr);
    EXPECT_NEAR(find(edited, ids[2])->segment().length(), 0.95, 0.002);
  }
}

TEST(MapEdits, SquareAndStraightenHold) {
  const SyntheticDrive drive = hall();
  const DriveMap first = mapDrive(drive.record, {}, params());
  const auto ids = doors(first);
  ASSERT_GE(ids.size(), 2u);
  // Two doors in one wall: straightened, their ends lie in one line.
  std::vector<std::uint64_t> left;
  for (const std::uint64_t id : ids) {
    const double heading = first.state.worldSegment(*find(first, id)).direction();
    if (std::cos(heading) > 0.0) left.push_back(id);
  }
  ASSERT_GE(left.size(), 2u);
  const DriveMap edited =
      mapWith(drive.record, "straighten " + std::to_string(left[0]) + " " + std::to_string(left[1]));
  const Segment2 one = edited.state.worldSegment(*find(edited, left[0]));
  const Segment2 other = edited.state.worldSegment(*find(edited, left[1]));
  EXPECT_LT(distanceToLine(other.a, one), 0.005);
  EXPECT_LT(distanceToLine(other.b, one), 0.005);
}

TEST(MapEdits, SplitLeavesAStretchFreeAndJoinClosesIt) {
  const SyntheticDrive drive = hall();
  const DriveMap first = mapDrive(drive.record, {}, params());
  const auto id = doors(first).front();
  const double length = find(first, id)->segment().length();
  const DriveMap split = mapWith(drive.record, "split " + std::to_string(id) + " 0.2 0.5");
  ASSERT_NE(find(split, id), nullptr);
  ASSERT_NE(find(split, id + 1), nullptr);
  const DriveMap joined = mapWith(drive.record, "split " + std::to_string(id) + " 0.2 0.5\njoin " +
                                                    std::to_string(id) + " " + std::to_string(id + 1));
  ASSERT_NE(find(joined, id), nullptr);
  EXPECT_EQ(find(joined, id + 1), nullptr);
  EXPECT_NEAR(find(joined, id)->segment().length(), length, 0.05);
}

TEST(MapEdits, SplitTakesAFreeIdAndStaysOnTheEdge) {
  const SyntheticDrive drive = hall();
  const auto id = doors(mapDrive(drive.record, {}, params())).front();
  const std::string name = std::to_string(id);
  const DriveMap twice = mapWith(drive.record, "split " + name + " 0.6 0.7\nsplit " + name + " 0.2 0.4");
  std::set<std::uint64_t> ids;
  for (const LineLandmark& landmark : twice.state.landmarks) {
    EXPECT_TRUE(ids.insert(landmark.id).second) << landmark.id << " names two edges";
  }
  EXPECT_TRUE(ids.contains(id + 1) && ids.contains(id + 2));
  const DriveMap beyond = mapWith(drive.record, "split " + name + " 5 6");
  EXPECT_THAT(beyond.notes, testing::Contains(HasSubstr("it has no stretch from 5.00 m on")));
  EXPECT_LT(find(beyond, id)->segment().length(), 2.0);
}

TEST(MapEdits, EdgesThatDoNotFitStayAndSaySo) {
  const SyntheticDrive drive = hall();
  const DriveMap first = mapDrive(drive.record, {}, params());
  const auto ids = doors(first);
  ASSERT_GE(ids.size(), 2u);
  const DriveMap edited =
      mapWith(drive.record, "square " + std::to_string(ids[0]) + " " + std::to_string(ids[1]));
  EXPECT_THAT(edited.notes, testing::Contains(HasSubstr("(must be within 30 of a right angle)")));
  for (const auto id : ids) {
    const Segment2 before = first.state.worldSegment(*find(first, id));
    EXPECT_LT((edited.state.worldSegment(*find(edited, id)).a - before.a).norm(), 0.001);
  }
}

/// Deletes the edges along the longest one that are longer than all across it: the longest edge is then
/// another way round.
TEST(MapEdits, LeaveTheFrameAsItWas) {
  const SyntheticDrive ring = drive(ringOfCorridors(), ringWay(30.0), {});
  const DriveMap first = mapDrive(ring.record, {}, params());
  const auto isAcross = [&](const LineLandmark& landmark) {
    return std::abs(std::sin(
               (first.T_map_world * Pose2{0.0, 0.0, first.state.worldSegment(landmark).direction()}).theta)) >
           0.7;
  };
  double across_m = 0.0;
  for (const LineLandmark& landmark : first.state.landmarks) {
    if (isAcross(landmark)) across_m = std::max(across_m, landmark.segment().length());
  }
  std::string edits;
  for (const LineLandmark& landmark : first.state.landmarks) {
    if (!isAcross(landmark) && landmark.segment().length() > across_m - 0.05)
      edits += "delete " + std::to_string(landmark.id) + "\n";
  }
  ASSERT_NE(edits, "");
  const DriveMap edited = mapWith(ring.record, edits);
  for (const LineLandmark& landmark : edited.state.landmarks) {
    const LineLandmark* before = find(first, landmark.id);
    ASSERT_NE(before, nullptr);
    const Eigen::Vector2d was = transform(first.T_map_world, first.state.worldSegment(*before)).middle();
    EXPECT_LT((transform(edited.T_map_world, edited.state.worldSegment(landmark)).middle() - was).norm(),
              0.1);
  }
}

TEST(MapEdits, MoveSetsAnEndOfTheFinishedMap) {
  std::vector<MappedRow> rows(1);
  rows[0].id = 700;
  rows[0].map = {{0.0, 0.0}, {1.0, 0.0}};
  applyMoves(parseMapEdits("move 700 b 1.25 0.5", "map.edits"), rows);
  EXPECT_EQ(rows[0].row.world.b, Eigen::Vector3d(1.25, 0.5, 0.0));
  EXPECT_TRUE(rows[0].closed_b);
}

TEST(MapEdits, NamesWhatIsWrong) {
  const auto problem = [](const std::string& text) -> std::string {
    try {
      parseMapEdits(text, "map.edits");
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(problem("remove 12"), HasSubstr("map.edits:1: \"remove\" (must be delete, relabel"));
  EXPECT_THAT(problem("\nlength 12"), HasSubstr("map.edits:2: the line ends before a length"));
  EXPECT_THAT(problem("move 12 c 1 2"), HasSubstr("\"c\" (must be a or b)"));
  EXPECT_THAT(problem("join 12 x"), HasSubstr("\"x\" (must be the id of an edge)"));
  EXPECT_THAT(problem("split 12 0.9 0.2"), HasSubstr("\"0.2\" (must be its end in metres, 0.9..100000)"));
  EXPECT_THAT(problem("length 12 -1"), HasSubstr("\"-1\" (must be a length in metres, 0.001..100000)"));
  EXPECT_THAT(problem("delete 12 13"), HasSubstr("\"13\" is one word too many"));
}

TEST(MapEdits, AnEdgeThatIsNoMoreIsReported) {
  const SyntheticDrive drive = hall();
  const DriveMap map = mapWith(drive.record, "delete 99999900");
  EXPECT_THAT(map.notes, testing::Contains(HasSubstr("map.edits:1: no edge 99999900 any more")));
}

TEST(DriveRecordIo, IsReadBackExactly) {
  SavedDrive saved;
  saved.record = hall().record;
  Closing closing{3, 7, {0.1, -0.2, 1e-3}, Eigen::Matrix3d::Identity() * 0.01};
  closing.P(0, 2) = closing.P(2, 0) = 1.0 / 3.0;
  saved.closings = {closing};
  const std::string text = writeDriveRecord(saved);
  const SavedDrive read = parseDriveRecord(text, "map.drive");
  EXPECT_EQ(writeDriveRecord(read), text);
  ASSERT_EQ(read.record.keyframes.size(), saved.record.keyframes.size());
  EXPECT_EQ(read.record.keyframes[5].sightings.size(), saved.record.keyframes[5].sightings.size());
  EXPECT_EQ(read.record.keyframes[5].T_robot_camera.matrix(),
            saved.record.keyframes[5].T_robot_camera.matrix());
  EXPECT_EQ(read.closings[0].P, closing.P);
  // The same record gives the same map.
  const DriveMap one = mapDrive(saved.record, {}, params());
  const DriveMap two = mapDrive(read.record, {}, params());
  ASSERT_EQ(one.state.poses.size(), two.state.poses.size());
  EXPECT_EQ(one.state.poses.back(), two.state.poses.back());
}

TEST(DriveRecordIo, NamesWhatIsWrong) {
  const auto problem = [](const std::string& text) -> std::string {
    try {
      parseDriveRecord(text, "map.drive");
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(problem(""), HasSubstr("map.drive: is empty"));
  EXPECT_THAT(problem("bag 1\n"), HasSubstr("map.drive:1: \"bag\" (must be \"drive 1\")"));
  EXPECT_THAT(problem("drive 1\nsighting 1 0 0 1 1 0 0\n"),
              HasSubstr("map.drive:2: a sighting before the first"));
  EXPECT_THAT(problem("drive 1\nkeyframe 1 x\n"), HasSubstr("x = \"x\" (must be a finite number)"));
  EXPECT_THAT(problem("drive 1\nclosing 0 9 0 0 0 1 0 0 1 0 1\n"), HasSubstr("must be two keyframes"));
}

}  // namespace
}  // namespace vismem
