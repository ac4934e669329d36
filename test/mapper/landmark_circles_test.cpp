// Painted circles from the chords that single images saw of them. Tests B6.
#include "mapper/core/landmark_circles.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numbers>

#include "common/geometry/angles.h"
#include "common/geometry/projection.h"
#include "mapper/core/map_graph.h"
#include "synthetic_drive.h"

namespace vismem {
namespace {

const Eigen::Vector2d kCentre(0.3, -0.2);
constexpr double kInner_m = 0.40;
constexpr double kOuter_m = 0.45;
constexpr double kTurn = 2.0 * std::numbers::pi;

Eigen::Vector2d onCircle(double radius_m, double angle_rad) {
  return kCentre + radius_m * Eigen::Vector2d(std::cos(angle_rad), std::sin(angle_rad));
}

/// A robot that looks at a place from all around it. A landmark gets what a detector sees of an arc: the line
/// fitted to it, from each image of another part.
class Looks {
 public:
  Looks() {
    constexpr int kPlaces = 24;
    for (int i = 0; i < kPlaces; ++i) {
      const double angle = kTurn * i / kPlaces;
      const Eigen::Vector2d place = kCentre + 1.4 * Eigen::Vector2d(std::cos(angle), std::sin(angle));
      addPose({place.x(), place.y(), wrapAngle(angle + std::numbers::pi)});
    }
  }

  /// @param left  whether the brighter side lies towards the centre.
  void addArcs(double radius_m, bool left, double share, double arc_rad) {
    const int landmarks = static_cast<int>(std::lround(share * 16.0));
    for (int n = 0; n < landmarks; ++n) {
      std::vector<Segment2> chords;
      for (std::size_t k = 0; k < state.poses.size(); ++k) {
        // The part that a landmark was matched with wanders.
        const double middle = kTurn * n / 16.0 + 0.15 * std::sin(1.7 * static_cast<double>(k) + n);
        Segment2 chord = chordOf(radius_m, middle, arc_rad);
        if (!left) std::swap(chord.a, chord.b);
        chords.push_back(chord);
      }
      addLandmark(chords);
    }
  }
  void addLandmark(const std::vector<Segment2>& seen) {
    LineLandmark landmark;
    landmark.elements = {addElement()};
    landmark.id = 100 * landmark.elements.front();
    landmark.label = "marking";
    const Segment2& held = seen.front();
    const Segment2 local = transform(inverse(state.poses[0]), held);
    landmark.reference = local.middle();
    landmark.direction_rad = local.direction();
    landmark.a = {-0.6 * held.length(), true};  // longer than any image showed it
    landmark.b = {0.6 * held.length(), true};
    for (std::size_t k = 0; k < seen.size(); ++k) {
      if (addSighting(landmark.elements.front(), k, seen[k]))
        landmark.seen.push_back(
            {static_cast<int>(k), static_cast<int>(record.keyframes[k].sightings.size()) - 1});
    }
    state.landmarks.push_back(landmark);
  }
  /// Chords that the memory knew for one image each: they are of no landmark.
  void addShortLivedArcs(double radius_m, bool left, double share, double arc_rad) {
    for (std::size_t k = 0; k < state.poses.size(); ++k) {
      for (int n = 0; n < static_cast<int>(std::lround(share * 16.0)); ++n) {
        Segment2 chord = chordOf(radius_m, kTurn * n / 16.0 + 0.05 * static_cast<double>(k), arc_rad);
        if (!left) std::swap(chord.a, chord.b);
        addSighting(addElement(), k, chord);
      }
    }
  }

  DriveRecord record;
  MapState state;

 private:
  /// The line of least squares of an arc: its ends are as far outside as its middle is inside.
  static Segment2 chordOf(double radius_m, double middle_rad, double arc_rad) {
    const double reach = radius_m * (1.0 + std::cos(0.5 * arc_rad)) / 2.0 / std::cos(0.5 * arc_rad);
    return {onCircle(reach, middle_rad - 0.5 * arc_rad), onCircle(reach, middle_rad + 0.5 * arc_rad)};
  }
  std::uint64_t addElement() {
    const std::uint64_t id = record.elements.size() + 1;
    record.elements[id].label = "marking";
    return id;
  }
  bool addSighting(std::uint64_t element, std::size_t k, const Segment2& world) {
    Keyframe& keyframe = record.keyframes[k];
    const Pose3 T_camera_world = cameraOf(record, state, static_cast<int>(k)).inverse();
    const auto a =
        projectToIdeal(keyframe.intrinsics, T_camera_world * Eigen::Vector3d(world.a.x(), world.a.y(), 0));
    const auto b =
        projectToIdeal(keyframe.intrinsics, T_camera_world * Eigen::Vector3d(world.b.x(), world.b.y(), 0));
    if (!a || !b) return false;
    LineSighting sighting;
    sighting.element = element;
    sighting.px = {*a, *b};
    keyframe.sightings.push_back(sighting);
    return true;
  }
  void addPose(const Pose2& T_world_robot) {
    record.keyframes.push_back(lookDown());
    record.keyframes.back().T_odom_robot = T_world_robot;
    if (!state.poses.empty())
      record.keyframes.back().way_m = record.keyframes[record.keyframes.size() - 2].way_m +
                                      (T_world_robot.position() - state.poses.back().position()).norm();
    state.poses.push_back(T_world_robot);
    state.frame_tilts.push_back(Eigen::Vector2d::Zero());
  }
};

double radiusOf(const Segment2& chord) {
  const double half = 0.5 * chord.length();
  const double middle = (chord.middle() - kCentre).norm();
  return 0.5 * (middle + std::hypot(middle, half));
}

TEST(JoinCircles, ChordsOfAPaintedCircleBecomeRegularOnesOfBothEdges) {
  Looks looks;
  looks.addArcs(kOuter_m, true, 1.0, 0.5);
  looks.addArcs(kInner_m, false, 1.0, 0.5);
  EXPECT_EQ(joinCircles(looks.record, {}, looks.state), 1);
  int inner = 0;
  int outer = 0;
  for (const LineLandmark& chord : looks.state.landmarks) {
    EXPECT_TRUE(chord.isChord());
    EXPECT_FALSE(chord.a.closed || chord.b.closed) << "the circle goes on";
    EXPECT_GE(chord.seen.size(), 3U);
    const Segment2 world = looks.state.worldSegment(chord);
    const double radius = radiusOf(world);
    const bool is_left = cross2(world.middle() - kCentre, world.b - world.a) > 0.0;
    ++(is_left ? outer : inner);
    EXPECT_NEAR(radius, is_left ? kOuter_m : kInner_m, 0.005);
  }
  EXPECT_GE(inner, 12);
  EXPECT_GE(outer, 12);
}

TEST(JoinCircles, AnArcIsMappedAsFarAsItWasSeen) {
  Looks looks;
  looks.addArcs(kOuter_m, true, 0.5, 0.5);
  EXPECT_EQ(joinCircles(looks.record, {}, looks.state), 1);
  EXPECT_GE(looks.state.landmarks.size(), 6U);
  for (const LineLandmark& chord : looks.state.landmarks) {
    const Eigen::Vector2d middle = looks.state.worldSegment(chord).middle() - kCentre;
    // Seen from 0 to 180 degrees, and a chord to each side.
    EXPECT_GT(std::atan2(middle.y(), middle.x()), degToRad(-35.0));
  }
}

/// Mean over the chords of one edge.
double meanRadius(const MapState& state, bool is_left) {
  double sum = 0.0;
  int count = 0;
  for (const LineLandmark& chord : state.landmarks) {
    const Segment2 world = state.worldSegment(chord);
    if (!chord.isChord() || (cross2(world.middle() - kCentre, world.b - world.a) > 0.0) != is_left) continue;
    sum += radiusOf(world);
    ++count;
  }
  return count > 0 ? sum / count : 0.0;
}

TEST(JoinCircles, ChordsThatTheMemoryHeldForOneImageEachMakeACircle) {
  Looks looks;
  looks.addShortLivedArcs(kOuter_m, true, 1.0, 0.5);
  looks.addShortLivedArcs(kInner_m, false, 1.0, 0.5);
  ASSERT_TRUE(looks.state.landmarks.empty());
  EXPECT_EQ(joinCircles(looks.record, {}, looks.state), 1);
  EXPECT_NEAR(meanRadius(looks.state, true), kOuter_m, 0.005);
  EXPECT_NEAR(meanRadius(looks.state, false), kInner_m, 0.005);
}

TEST(JoinCircles, PiecesOfLongLinesAreNoChords) {
  Looks looks;
  looks.addShortLivedArcs(kOuter_m, true, 1.0, 0.5);
  std::vector<SeenChord> chords = seenChords(looks.record, looks.state, {});
  EXPECT_EQ(findSeenCircles(chords, {}).size(), 1U);
  for (SeenChord& chord : chords) chord.line_m = 2.0;
  EXPECT_TRUE(findSeenCircles(chords, {}).empty());
}

TEST(TakeCircles, TheGraphFindsTheTiltOfTheCameraByTheCurve) {
  Looks looks;
  looks.state.camera_tilt[1] = degToRad(0.6);  // nose down: unknown to the kinematics
  looks.addArcs(kOuter_m, true, 1.0, 0.5);
  looks.addArcs(kInner_m, false, 1.0, 0.5);
  looks.state.camera_tilt.setZero();
  MapState untaken = looks.state;
  EXPECT_EQ(joinCircles(looks.record, {}, untaken), 1);
  EXPECT_GT(std::abs(meanRadius(untaken, true) - kOuter_m), 0.004);
  EXPECT_EQ(takeCircles(looks.record, {}, looks.state), 1);
  EXPECT_TRUE(looks.state.landmarks.empty()) << "a line along an arc is none";
  ASSERT_TRUE(solveGraph(looks.record, {}, {.kernel = 2.0}, looks.state).usable);
  // That of the mount and that of the camera are one while the head looks ahead.
  EXPECT_NEAR(radToDeg(looks.state.camera_tilt[1] - looks.state.camera_tilt[2]), 0.6, 0.1);
  EXPECT_EQ(joinCircles(looks.record, {}, looks.state), 1);
  EXPECT_NEAR(meanRadius(looks.state, true), kOuter_m, 0.004);
}

TEST(TakeCircles, ChordsHaveTheCovarianceOfTheirCircle) {
  Looks looks;
  looks.addArcs(kOuter_m, true, 1.0, 0.5);
  looks.addArcs(kInner_m, false, 1.0, 0.5);
  EXPECT_EQ(joinCircles(looks.record, {}, looks.state), 1);
  ASSERT_EQ(addCovariances(looks.record, {}, {}, looks.state), "");
  for (const LineLandmark& chord : looks.state.landmarks) {
    EXPECT_GT(chord.P_line(0, 0), 0.0);
    EXPECT_LT(std::sqrt(chord.P_line(0, 0)), 0.03);
  }
}

TEST(JoinCircles, TheSidesOfAHexagonAndOfARoomStay) {
  Looks looks;
  for (const int sides : {4, 6}) {
    looks.state.landmarks.clear();
    for (int n = 0; n < sides; ++n) {
      const Segment2 side{onCircle(kOuter_m, kTurn * n / sides), onCircle(kOuter_m, kTurn * (n + 1) / sides)};
      looks.addLandmark(std::vector<Segment2>(looks.state.poses.size(), side));
    }
    EXPECT_EQ(joinCircles(looks.record, {}, looks.state), 0) << sides;
    EXPECT_EQ(looks.state.landmarks.size(), static_cast<std::size_t>(sides));
  }
}

TEST(JoinCircles, WhatRemainsOfTheLineOfACircleGoesAndItsSurroundingsStay) {
  Looks looks;
  looks.addArcs(kOuter_m, true, 1.0, 0.5);
  looks.addArcs(kInner_m, false, 1.0, 0.5);
  // A far view took both edges of an arc for one line; a stripe passes the circle.
  const std::size_t views = looks.state.poses.size();
  looks.addLandmark(std::vector<Segment2>(views, {onCircle(0.40, 0.2), onCircle(0.47, 0.7)}));
  looks.addLandmark(std::vector<Segment2>(
      views, {kCentre + Eigen::Vector2d(0.6, -1.0), kCentre + Eigen::Vector2d(0.6, 1.0)}));
  EXPECT_EQ(joinCircles(looks.record, {}, looks.state), 1);
  int others = 0;
  for (const LineLandmark& landmark : looks.state.landmarks) others += !landmark.isChord();
  EXPECT_EQ(others, 1);
}

}  // namespace
}  // namespace vismem
