// Ends that edges share. Tests B6.
#include "mapper/core/landmark_corners.h"

#include <gtest/gtest.h>

namespace vismem {
namespace {

LineLandmark landmark(const Segment2& segment, const Label& label, bool closed = true) {
  LineLandmark made;
  made.label = label;
  made.reference = segment.middle();
  made.direction_rad = segment.direction();
  made.a = {-0.5 * segment.length(), closed};
  made.b = {0.5 * segment.length(), closed};
  made.seen = {{0, 0}, {1, 0}};
  return made;
}

MapState stateOf(std::vector<LineLandmark> landmarks) {
  MapState state;
  state.poses = {Pose2{}, Pose2{}};
  state.landmarks = std::move(landmarks);
  return state;
}

TEST(JoinCorners, TwoWallsMeetWhereTheirLinesDo) {
  // One runs 8 cm beyond the corner at (2, 1), the other stops 4 cm before it.
  MapState state = stateOf(
      {landmark({{0.0, 1.0}, {2.08, 1.0}}, "skirting"), landmark({{2.0, 0.96}, {2.0, -1.0}}, "skirting")});
  EXPECT_EQ(joinCorners({}, state), 2);
  EXPECT_LT((state.worldSegment(state.landmarks[0]).b - Eigen::Vector2d(2.0, 1.0)).norm(), 1e-9);
  EXPECT_LT((state.worldSegment(state.landmarks[1]).a - Eigen::Vector2d(2.0, 1.0)).norm(), 1e-9);
}

TEST(JoinCorners, AnEndThatWasSeenWellBeforeTheOtherLineStays) {
  MapState state = stateOf(
      {landmark({{0.0, 1.0}, {1.9, 1.0}}, "skirting"), landmark({{2.0, 1.0}, {2.0, -1.0}}, "skirting")});
  EXPECT_EQ(joinCorners({}, state), 0);
}

TEST(JoinCorners, ABoundReachesFurtherThanAClosedEnd) {
  LineLandmark open = landmark({{0.0, 1.0}, {1.9, 1.0}}, "skirting");
  open.b.closed = false;
  MapState state = stateOf({open, landmark({{2.0, 1.0}, {2.0, -1.0}}, "skirting")});
  EXPECT_GE(joinCorners({}, state), 1);
  EXPECT_TRUE(state.landmarks[0].b.closed);
  EXPECT_NEAR(state.worldSegment(state.landmarks[0]).b.x(), 2.0, 1e-9);
}

TEST(JoinCorners, WallsMeetBehindWhatHidTheirCorner) {
  LineLandmark one = landmark({{0.0, 1.0}, {1.6, 1.0}}, "skirting");
  LineLandmark other = landmark({{2.0, 0.6}, {2.0, -1.0}}, "skirting");
  one.b.closed = other.a.closed = false;
  MapState state = stateOf({one, other});
  EXPECT_EQ(joinCorners({}, state), 2);
  EXPECT_LT((state.worldSegment(state.landmarks[0]).b - Eigen::Vector2d(2.0, 1.0)).norm(), 1e-9);
  EXPECT_LT((state.worldSegment(state.landmarks[1]).a - Eigen::Vector2d(2.0, 1.0)).norm(), 1e-9);
  // Sides of two boxes do not.
  LineLandmark side = landmark({{1.5, 1.0}, {1.7, 1.0}}, "box_foot");
  LineLandmark far = landmark({{2.0, 0.9}, {2.0, 0.7}}, "box_foot");
  side.b.closed = far.a.closed = false;
  state = stateOf({side, far});
  EXPECT_EQ(joinCorners({}, state), 0);
  // Lines on the floor may end anywhere.
  one.label = other.label = "marking";
  state = stateOf({one, other});
  EXPECT_EQ(joinCorners({}, state), 0);
}

TEST(JoinCorners, AWallPassesIntoADoorAtOnePlace) {
  MapState state = stateOf({landmark({{0.0, 0.0}, {2.03, 0.0}}, "skirting"),
                            landmark({{2.09, 0.002}, {3.0, 0.002}}, "door_foot")});
  EXPECT_EQ(joinCorners({}, state), 2);
  EXPECT_NEAR(state.worldSegment(state.landmarks[0]).b.x(), 2.06, 1e-6);
  EXPECT_NEAR(state.worldSegment(state.landmarks[1]).a.x(), 2.06, 1e-6);
}

TEST(JoinCorners, AMarkingAndAWallFormNoCorner) {
  MapState state = stateOf(
      {landmark({{0.0, 1.0}, {1.97, 1.0}}, "marking"), landmark({{2.0, 1.0}, {2.0, -1.0}}, "skirting")});
  EXPECT_EQ(joinCorners({}, state), 0);
}

}  // namespace
}  // namespace vismem
