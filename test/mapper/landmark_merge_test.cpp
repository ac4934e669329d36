// Which landmarks are one edge. Tests B6.
#include "mapper/core/landmark_merge.h"

#include <gtest/gtest.h>

namespace vismem {
namespace {

/// A landmark about the only keyframes, which stand at the origin.
LineLandmark landmark(const Segment2& segment, const Label& label, int keyframe, int sighting = 0) {
  LineLandmark made;
  made.label = label;
  made.anchor = keyframe;
  made.reference = segment.middle();
  made.direction_rad = segment.direction();
  made.a = {-0.5 * segment.length(), true};
  made.b = {0.5 * segment.length(), true};
  made.seen = {{keyframe, sighting}};
  return made;
}

/// Three images; each shows two edges at different places.
DriveRecord record() {
  DriveRecord made;
  for (int k = 0; k < 3; ++k) {
    Keyframe keyframe;
    keyframe.sightings = {{1, {{10.0, 100.0}, {200.0, 100.0}}},
                          {2, {{40.0, 112.0}, {260.0, 112.0}}},
                          {3, {{206.0, 100.0}, {300.0, 100.0}}}};
    made.keyframes.push_back(keyframe);
  }
  return made;
}

MapState stateOf(std::vector<LineLandmark> landmarks) {
  MapState state;
  state.poses = {Pose2{}, Pose2{0.5, 0.0, 0.3}, Pose2{1.0, 0.2, 0.1}};
  for (LineLandmark& each : landmarks) {
    const Pose2 T_anchor_world = inverse(state.poses[static_cast<std::size_t>(each.anchor)]);
    each.reference = transform(T_anchor_world, each.reference);
    each.direction_rad += T_anchor_world.theta;
  }
  state.landmarks = std::move(landmarks);
  return state;
}

TEST(MergeLandmarks, JoinsTwoViewsOfOneEdge) {
  MapState state = stateOf({landmark({{0.0, 0.0}, {2.0, 0.0}}, "skirting", 0),
                            landmark({{0.5, 0.02}, {2.9, 0.02}}, "skirting", 1)});
  EXPECT_EQ(mergeLandmarks(record(), {}, state), 1);
  ASSERT_EQ(state.landmarks.size(), 1u);
  EXPECT_EQ(state.landmarks[0].seen.size(), 2u);
  const Segment2 joined = state.worldSegment(state.landmarks[0]);
  EXPECT_NEAR(joined.length(), 2.9, 0.01);
}

TEST(MergeLandmarks, AWallGoesOnBehindWhatStandsBeforeIt) {
  LineLandmark left = landmark({{0.0, 0.0}, {1.0, 0.0}}, "skirting", 0);
  LineLandmark right = landmark({{1.4, 0.0}, {2.0, 0.0}}, "skirting", 1);
  MapState seen = stateOf({left, right});
  EXPECT_EQ(mergeLandmarks(record(), {}, seen), 0) << "images saw both ends";
  left.b.closed = right.a.closed = false;
  MapState hidden = stateOf({left, right});
  EXPECT_EQ(mergeLandmarks(record(), {}, hidden), 1);
  EXPECT_NEAR(hidden.worldSegment(hidden.landmarks.at(0)).length(), 2.0, 0.01);
  // Two boxes in a row are no long one.
  LineLandmark box = landmark({{0.0, 0.0}, {0.3, 0.0}}, "box_foot", 0);
  LineLandmark next = landmark({{0.6, 0.0}, {0.9, 0.0}}, "box_foot", 1);
  box.b.closed = next.a.closed = false;
  MapState boxes = stateOf({box, next});
  EXPECT_EQ(mergeLandmarks(record(), {}, boxes), 0);
}

TEST(MergeLandmarks, KeepsEdgesApartThatOneImageShowed) {
  MapState state = stateOf({landmark({{0.0, 0.0}, {2.0, 0.0}}, "skirting", 0),
                            landmark({{0.5, 0.02}, {2.9, 0.02}}, "skirting", 0, 1)});
  EXPECT_EQ(mergeLandmarks(record(), {}, state), 0);
}

TEST(MergeLandmarks, JoinsPiecesThatOneImageShowedEndToEnd) {
  MapState state = stateOf({landmark({{0.0, 0.0}, {2.0, 0.0}}, "skirting", 0),
                            landmark({{2.03, 0.0}, {2.9, 0.0}}, "skirting", 0, 2)});
  EXPECT_EQ(mergeLandmarks(record(), {}, state), 1);
}

TEST(MergeLandmarks, KeepsOtherLabelsAndTheOtherSideOfALineApart) {
  MapState labels = stateOf({landmark({{0.0, 0.0}, {2.0, 0.0}}, "skirting", 0),
                             landmark({{0.0, 0.0}, {2.0, 0.0}}, "door_foot", 1)});
  EXPECT_EQ(mergeLandmarks(record(), {}, labels), 0);
  // The two edges of a painted line have opposite polarity.
  MapState sides = stateOf(
      {landmark({{0.0, 0.0}, {2.0, 0.0}}, "marking", 0), landmark({{2.0, 0.04}, {0.0, 0.04}}, "marking", 1)});
  EXPECT_EQ(mergeLandmarks(record(), {}, sides), 0);
}

TEST(MergeLandmarks, KeepsPiecesWithAGapBetweenThemApart) {
  MapState state = stateOf(
      {landmark({{0.0, 0.0}, {1.0, 0.0}}, "skirting", 0), landmark({{1.3, 0.0}, {2.0, 0.0}}, "skirting", 1)});
  EXPECT_EQ(mergeLandmarks(record(), {}, state), 0);
}

TEST(MergeLandmarks, AClosedEndWinsOverABoundNearIt) {
  LineLandmark open = landmark({{0.0, 0.0}, {1.97, 0.0}}, "skirting", 0);
  open.b.closed = false;
  MapState state = stateOf({open, landmark({{1.0, 0.0}, {2.0, 0.0}}, "skirting", 1)});
  ASSERT_EQ(mergeLandmarks(record(), {}, state), 1);
  EXPECT_TRUE(state.landmarks[0].b.closed);
  EXPECT_NEAR(state.worldSegment(state.landmarks[0]).length(), 2.0, 0.01);
}

/// Pieces of a wall that a first visit shows at y = 0 and a second one, some way later, elsewhere.
std::optional<EdgesTwice> twoVisits(double later_m, double across_m) {
  DriveRecord visits = record();
  visits.keyframes[1].way_m = later_m;
  std::vector<LineLandmark> landmarks;
  for (const double x : {0.0, 2.0, 4.0}) {
    landmarks.push_back(landmark({{x, 0.0}, {x + 1.0, 0.0}}, "skirting", 0));
    landmarks.push_back(landmark({{x + 0.3, across_m}, {x + 1.3, across_m + 0.01 * x}}, "skirting", 1));
  }
  return edgesTwice(visits, {}, stateOf(landmarks));
}

TEST(EdgesTwice, NamesThePlaceWhereTwoVisitsWereNotJoined) {
  const auto twice = twoVisits(30.0, 0.2);
  ASSERT_TRUE(twice);
  EXPECT_EQ(twice->edges, 3);
  EXPECT_NEAR(twice->length_m, 3 * 0.7, 0.02);
  EXPECT_NEAR(twice->across_m, 0.2 + 0.5 * 0.04 * 0.7, 0.02);
  EXPECT_NEAR(twice->world.x(), 4.5, 0.01);
}

TEST(EdgesTwice, EdgesOfOneVisitAndThoseThatAgreeStandOnce) {
  EXPECT_FALSE(twoVisits(3.0, 0.2)) << "two edges beside each other";
  EXPECT_FALSE(twoVisits(30.0, 0.0)) << "near enough";
  EXPECT_FALSE(twoVisits(30.0, 0.7)) << "another wall";
}

}  // namespace
}  // namespace vismem
