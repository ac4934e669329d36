// Where edges end, and lines seen from afar across what lies between their pieces. Tests B6.
#include "mapper/core/landmark_ends.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
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
