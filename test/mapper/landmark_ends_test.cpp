// Where edges end, and lines seen from afar across what lies between their pieces. Tests B6.
#include "mapper/core/landmark_ends.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <numbers>
#include <set>

#include "common/geometry/angles.h"
#include "mapper/core/map_graph.h"
#include "synthetic_drive.h"

namespace vismem {
namespace {

/// A straight way past all doors of both walls, odometry without errors. On a shorter one, most doors stay
/// out of range and nothing can be known of them.
SyntheticDrive pastAllDoors() {
  SyntheticDriveParams params;
  params.scale_error = params.turn_per_rad = params.turn_per_m = params.turn_noise_rad = 0.0;
  return drive(straightCorridor(), wayThrough({{-9.0, 0.0}, {9.0, 0.0}}, 18.0), params);
}

/// Near the graph's solution, as both functions ask for, by the mapper's first two solves: the memory's own
/// lines lie up to 5 cm aside. Lines alone say nothing of the way along a straight corridor.
MapState solvedState(const SyntheticDrive& past) {
  MapState state = initialState(past.record, {});
  for (const bool ends : {false, true}) {
    EXPECT_TRUE(solveGraph(past.record, {}, {.ends = ends}, state).usable);
  }
  return state;
}

TEST(UpdateEnds, FindsTheTrueEndsFromTheViews) {
  const SyntheticDrive past = pastAllDoors();
  MapState state = solvedState(past);
  // The memory's ends are wrong by 10 cm.
  for (LineLandmark& landmark : state.landmarks) {
    landmark.a.t_m -= 0.10;
    landmark.b.t_m += 0.10;
  }
  updateEnds(past.record, {}, state);
  int doors = 0;
  const Pose2 T = past.truth.front();
  for (const LineLandmark& landmark : state.landmarks) {
    // A door shows in 5 to 8 of the images while the camera turns to and fro.
    if (landmark.label != "door_foot") continue;
    const Segment2 world = transform(T, state.worldSegment(landmark));
    double nearest = 1e9;
    for (const TrueFloorEdge& edge : straightCorridor()) {
      if (edge.label != landmark.label) continue;
      nearest = std::min(nearest, (edge.world.a - world.a).norm() + (edge.world.b - world.b).norm());
    }
    EXPECT_LT(nearest, 0.08);
    EXPECT_TRUE(landmark.a.closed && landmark.b.closed);
    ++doors;
  }
  EXPECT_EQ(doors, 9);
}

/// Images of one landmark from known places, and what each showed of it.
struct Looks {
  DriveRecord record;
  MapState state;

  /// The landmark as the memory holds it, on the floor.
  explicit Looks(const Segment2& held) {
    LineLandmark landmark;
    landmark.id = 100;
    landmark.label = "box_foot";
    landmark.reference = held.middle();
    landmark.direction_rad = held.direction();
    landmark.a = {-0.5 * held.length(), false};
    landmark.b = {0.5 * held.length(), false};
    state.landmarks.push_back(landmark);
    addPose({});  // the anchor: the frame of the world
  }
  /// @param heading  of the camera 0.5 m above `place`, which looks 25 degrees down.
  void add(const Eigen::Vector2d& place, double heading_rad, const Eigen::Vector3d& a,
           const Eigen::Vector3d& b) {
    addPose({place.x(), place.y(), heading_rad});
    const Pose3 T_camera_world =
        (toPose3(state.poses.back()) * record.keyframes.back().T_robot_camera).inverse();
    const CameraIntrinsics& k = record.keyframes.back().intrinsics;
    LineSighting sighting;
    sighting.px = {*projectToIdeal(k, T_camera_world * a), *projectToIdeal(k, T_camera_world * b)};
    record.keyframes.back().sightings.push_back(sighting);
    state.landmarks[0].seen.push_back({static_cast<int>(record.keyframes.size()) - 1, 0});
  }
  Segment2 landmark() const { return state.worldSegment(state.landmarks.at(0)); }

 private:
  void addPose(const Pose2& T_world_robot) {
    record.keyframes.push_back(lookDown());
    state.poses.push_back(T_world_robot);
    state.frame_tilts.push_back(Eigen::Vector2d::Zero());
  }
};

constexpr int kLeastViews = 3;
constexpr double kQuarterTurn = std::numbers::pi / 2;

TEST(UpdateEnds, AnEdgeReachesNoFurtherThanImagesShowedIt) {
  // The memory joined a side of 0.3 m with that of another thing in the same line.
  Looks looks({{0.0, 0.0}, {2.0, 0.0}});
  for (const double x : {-0.1, 0.1, 0.3})
    looks.add({x, -1.0}, kQuarterTurn, {0.0, 0.0, 0.0}, {0.3, 0.0, 0.0});
  updateEnds(looks.record, {}, looks.state);
  EXPECT_NEAR(looks.landmark().a.x(), 0.0, 0.01);
  EXPECT_NEAR(looks.landmark().b.x(), 0.3, 0.01);
}

TEST(UpdateEnds, AnUprightEdgeInLineWithAFootIsNoPartOfIt) {
  // From the plane of a box's side, 0.3 m long and 0.25 m high, foot and far corner are one line in the
  // image.
  Looks looks({{0.0, 0.0}, {1.0, 0.0}});
  for (const double x : {-1.2, -1.1, -1.0, -0.9}) looks.add({x, 0.0}, 0.0, {0.0, 0.0, 0.0}, {0.3, 0.0, 0.25});
  for (const double x : {0.0, 0.1, 0.2}) looks.add({x, -1.0}, kQuarterTurn, {0.0, 0.0, 0.0}, {0.3, 0.0, 0.0});
  EXPECT_EQ(dropUprights(looks.record, {}, kLeastViews, looks.state), 0);
  updateEnds(looks.record, {}, looks.state);
  EXPECT_NEAR(looks.landmark().b.x(), 0.3, 0.01);
}

TEST(DropUprights, WhatEveryImageMayHaveSeenUprightIsNotOnTheFloor) {
  Looks looks({{0.0, 0.0}, {1.0, 0.0}});
  for (const double x : {-1.2, -1.1, -1.0}) looks.add({x, 0.0}, 0.0, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.25});
  EXPECT_EQ(dropUprights(looks.record, {}, kLeastViews, looks.state), 1);
  EXPECT_TRUE(looks.state.landmarks.empty());
}

TEST(DropUprights, TwoLooksAtAnotherThingDoNotPutAnUprightOnTheFloor) {
  Looks looks({{0.0, 0.0}, {1.0, 0.0}});
  for (const double x : {-1.3, -1.2, -1.1, -1.0}) looks.add({x, 0.0}, 0.0, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.25});
  for (const double x : {0.5, 0.6}) looks.add({x, -1.0}, kQuarterTurn, {0.4, 0.0, 0.0}, {0.7, 0.0, 0.0});
  EXPECT_EQ(dropUprights(looks.record, {}, kLeastViews, looks.state), 1);
}

class RaisedEdge : public testing::TestWithParam<double> {};

/// A box's top edge along the way of the robot: its line fits the floor in every image, its ends do not.
TEST_P(RaisedEdge, IsDroppedByItsEnds) {
  const double height_m = GetParam();
  Looks looks({{0.0, 0.0}, {0.3, 0.0}});
  for (const double x : {-0.3, -0.1, 0.1, 0.3, 0.5})
    looks.add({x, -1.0}, kQuarterTurn, {0.0, 0.0, height_m}, {0.3, 0.0, height_m});
  EXPECT_EQ(dropRaised(looks.record, {}, looks.state), height_m > 0.0 ? 1 : 0);
}

INSTANTIATE_TEST_SUITE_P(Heights, RaisedEdge, testing::Values(0.0, 0.1, 0.2, 0.3));

TEST(DropRaised, AFootThatIsPartlyHiddenStays) {
  // Each image shows another part: that fits no height.
  Looks looks({{0.0, 0.0}, {0.3, 0.0}});
  double shown = 0.05;
  for (const double x : {-0.3, -0.1, 0.1, 0.3, 0.5}) {
    looks.add({x, -1.0}, kQuarterTurn, {0.0, 0.0, 0.0}, {shown, 0.0, 0.0});
    shown = shown > 0.2 ? 0.1 : 0.3;
  }
  EXPECT_EQ(dropRaised(looks.record, {}, looks.state), 0);
}

/// A wall as one landmark, and how often it has to be cut. Doors are known in the order of the way: along the
/// left wall and against the right one, so that the first or the second piece is cut again.
struct WholeWall {
  Segment2 world;
  int doors;
};

class CutOverlaps : public testing::TestWithParam<WholeWall> {};

TEST_P(CutOverlaps, AWallSeenAcrossItsDoorIsCutThere) {
  const SyntheticDrive past = pastAllDoors();
  MapState state = solvedState(past);
  // A landmark over the whole wall, as a view along it makes it.
  LineLandmark whole;
  whole.label = "skirting";
  whole.id = 100'000;
  whole.anchor = 0;
  const Segment2 wall = transform(inverse(past.truth.front()), GetParam().world);
  whole.reference = wall.middle();
  whole.direction_rad = wall.direction();
  whole.a = {-10.0, false};
  whole.b = {10.0, false};
  for (const LineLandmark& landmark : state.landmarks) {
    // Sightings of this wall.
    if (landmark.label == "skirting" &&
        state.worldSegment(landmark).middle().y() * GetParam().world.a.y() > 0.0) {
      whole.seen.insert(whole.seen.end(), landmark.seen.begin(), landmark.seen.end());
    }
  }
  ASSERT_FALSE(whole.seen.empty());
  state.landmarks.push_back(whole);
  EXPECT_EQ(cutOverlaps(past.record, {}, state), GetParam().doors);
  std::set<std::uint64_t> ids;
  for (const LineLandmark& landmark : state.landmarks) {
    EXPECT_TRUE(ids.insert(landmark.id).second) << landmark.id;  // edits name landmarks by it
  }
  // No skirting covers a door any more.
  for (const LineLandmark& landmark : state.landmarks) {
    if (landmark.label != "skirting") continue;
    EXPECT_LT(landmark.b.t_m - landmark.a.t_m, 6.0);
    const Segment2 world = transform(past.truth.front(), state.worldSegment(landmark));
    for (const TrueFloorEdge& edge : straightCorridor()) {
      const bool same_wall = edge.world.middle().y() * world.middle().y() > 0.0;
      if (edge.label != "door_foot" || !same_wall) continue;
      const double covered =
          std::min(std::max(edge.world.a.x(), edge.world.b.x()), std::max(world.a.x(), world.b.x())) -
          std::max(std::min(edge.world.a.x(), edge.world.b.x()), std::min(world.a.x(), world.b.x()));
      EXPECT_LT(covered, 0.10) << "at x = " << edge.world.middle().x();
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Walls, CutOverlaps,
                         testing::Values(WholeWall{{{-10.0, 0.8}, {10.0, 0.8}}, 5},
                                         WholeWall{{{10.0, -0.8}, {-10.0, -0.8}}, 4}));

}  // namespace
}  // namespace vismem
