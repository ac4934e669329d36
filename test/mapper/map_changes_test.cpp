// What changed in a drawn room since its map was made. Tests B6.
#include "mapper/core/map_changes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace vismem {
namespace {

constexpr double kRoom_m = 3.0;  // half its side

struct Box {
  Eigen::Vector2d middle;
  double turn_rad;
  Label label;
};

void add(SegmentMap& map, const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Label& label) {
  map.segments.push_back({{{a.x(), a.y(), 0.0}, {b.x(), b.y(), 0.0}}, label});
}

void addSquare(SegmentMap& map, const Eigen::Vector2d& middle, double half_m, double turn_rad,
               const Label& label) {
  const Eigen::Rotation2Dd R(turn_rad);
  for (int i = 0; i < 4; ++i) {
    const auto corner = [&](int k) -> Eigen::Vector2d {
      const double angle = (2 * k + 1) * std::numbers::pi / 4;
      return middle + R * (half_m * std::sqrt(2.0) * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
    };
    add(map, corner(i), corner(i + 1), label);
  }
}

SegmentMap roomWith(const std::vector<Box>& boxes) {
  SegmentMap map;
  addSquare(map, {0, 0}, kRoom_m, 0.0, "skirting");
  for (const Box& box : boxes) addSquare(map, box.middle, 0.15, box.turn_rad, box.label);
  return map;
}

/// A robot that turned at four places.
SeenFloor viewsAllOver() {
  std::vector<FloorView> views;
  for (const Eigen::Vector2d place : {Eigen::Vector2d(-1.2, -1.2), {1.2, -1.2}, {1.2, 1.2}, {-1.2, 1.2}}) {
    for (int i = 0; i < 36; ++i) {
      const double heading = i * std::numbers::pi / 18;
      const double tilt = -0.4;
      const Eigen::Vector3d axis(std::cos(heading) * std::cos(tilt), std::sin(heading) * std::cos(tilt),
                                 std::sin(tilt));
      const Eigen::Vector3d right = axis.cross(Eigen::Vector3d::UnitZ()).normalized();
      Pose3 T_map_camera = Pose3::Identity();
      T_map_camera.linear().col(0) = right;
      T_map_camera.linear().col(1) = axis.cross(right);
      T_map_camera.linear().col(2) = axis;
      T_map_camera.translation() = Eigen::Vector3d(place.x(), place.y(), 0.5);
      views.push_back({place, CameraView(intrinsicsFromFieldOfView(320, 240, 1.0), T_map_camera)});
    }
  }
  return {views, {}};
}

/// Ends off by a centimetre or so, edges cut into pieces, some not seen at all.
SegmentMap asMapped(const SegmentMap& truth, std::mt19937& random) {
  std::normal_distribution<double> noise(0.0, 0.01);
  SegmentMap map;
  for (MapSegment row : truth.segments) {
    const Eigen::Vector3d middle = 0.5 * (row.world.a + row.world.b);
    const Eigen::Vector3d jitter(noise(random), noise(random), 0.0);
    for (const auto& [a, b] : {std::pair(row.world.a, middle), {middle, row.world.b}}) {
      MapSegment piece = row;
      piece.world = {a + jitter, b + jitter};
      map.segments.push_back(piece);
    }
  }
  return map;
}

const std::vector<Box> kBoxes{{{-2.0, 0.0}, 0.3, "red_foot"},
                              {{0.0, 0.0}, 0.0, "red_foot"},
                              {{2.0, 0.4}, 0.8, "green_foot"},
                              {{0.2, 2.1}, 0.1, "blue_foot"}};

int count(const std::vector<MapChange>& changes, MapChange::Kind kind) {
  return static_cast<int>(
      std::count_if(changes.begin(), changes.end(), [&](const MapChange& one) { return one.kind == kind; }));
}

class MapChangesSeeds : public testing::TestWithParam<unsigned> {};

TEST_P(MapChangesSeeds, AnUnchangedRoomHasNone) {
  std::mt19937 random(GetParam());
  EXPECT_TRUE(mapChanges(roomWith(kBoxes), viewsAllOver(), asMapped(roomWith(kBoxes), random), viewsAllOver())
                  .empty());
}

TEST_P(MapChangesSeeds, ListsWhatWasMovedRemovedAndBroughtIn) {
  std::mt19937 random(GetParam());
  std::vector<Box> boxes = kBoxes;
  boxes[0].middle += Eigen::Vector2d(0.4, -0.7);
  boxes[0].turn_rad += 0.5;
  boxes.erase(boxes.begin() + 3);
  boxes.push_back({{1.0, -2.2}, 0.2, "yellow_foot"});
  const auto changes =
      mapChanges(roomWith(kBoxes), viewsAllOver(), asMapped(roomWith(boxes), random), viewsAllOver());
  ASSERT_EQ(changes.size(), 3U);
  EXPECT_EQ(count(changes, MapChange::Kind::kMoved), 1);
  EXPECT_EQ(count(changes, MapChange::Kind::kRemoved), 1);
  EXPECT_EQ(count(changes, MapChange::Kind::kNew), 1);
  for (const MapChange& change : changes) {
    switch (change.kind) {
      case MapChange::Kind::kMoved:
        EXPECT_EQ(change.label, "red_foot");
        EXPECT_LT((placeOf(change.before) - kBoxes[0].middle).norm(), 0.1);
        EXPECT_LT((placeOf(change.now) - boxes[0].middle).norm(), 0.1);
        break;
      case MapChange::Kind::kRemoved:
        EXPECT_EQ(change.label, "blue_foot");
        break;
      case MapChange::Kind::kNew:
        EXPECT_EQ(change.label, "yellow_foot");
        break;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, MapChangesSeeds, testing::Range(1U, 11U));

TEST(MapChanges, WhatNoViewShowsIsUnchanged) {
  const SeenFloor views = viewsAllOver();
  const SegmentMap empty = roomWith({});
  EXPECT_EQ(mapChanges(roomWith(kBoxes), views, empty, views).size(), kBoxes.size());
  EXPECT_TRUE(mapChanges(roomWith(kBoxes), views, empty, {}).empty());
  // Behind a cupboard that stands there now, nobody knows.
  SegmentMap hidden = empty;
  addSquare(hidden, kBoxes[2].middle, 0.4, 0.0, "cupboard_foot");
  const auto changes = mapChanges(roomWith({kBoxes[2]}), {}, hidden, views);
  ASSERT_EQ(changes.size(), 1U);
  EXPECT_EQ(changes[0].kind, MapChange::Kind::kNew);
  EXPECT_EQ(changes[0].label, "cupboard_foot");
}

TEST(MapChanges, WhatTheFirstDriveDidNotSeeIsNotNew) {
  // It saw nothing of the east half.
  SeenFloor west;
  for (const FloorView& view : viewsAllOver().views) {
    const bool looks_west = view.camera.x() < 0.0 && view.view.shows(view.camera - Eigen::Vector2d(1.2, 0.0));
    if (looks_west) west.views.push_back(view);
  }
  const SegmentMap old = roomWith({kBoxes[0]});
  EXPECT_TRUE(mapChanges(old, west, roomWith({kBoxes[0], kBoxes[2]}), viewsAllOver()).empty());
  EXPECT_EQ(mapChanges(old, {}, roomWith({kBoxes[0], kBoxes[2]}), viewsAllOver()).size(), 1U);
}

TEST(MapChanges, AnEdgeThatWasSeenButNotConfirmedIsNoChange) {
  SegmentMap now = roomWith(kBoxes);
  const Segment2 lost = now.segments.back().world.floor();
  now.segments.pop_back();
  SeenFloor seen = viewsAllOver();
  EXPECT_EQ(mapChanges(roomWith(kBoxes), viewsAllOver(), now, seen).size(), 1U);
  seen.traces.push_back(lost);
  EXPECT_TRUE(mapChanges(roomWith(kBoxes), viewsAllOver(), now, seen).empty());
}

TEST(MapChanges, ADoorThatIsPaintedAnewIsAnotherOne) {
  SegmentMap now = roomWith(kBoxes);
  for (MapSegment& row : now.segments) {
    if (row.label == "green_foot") row.label = "white_foot";
  }
  const auto changes = mapChanges(roomWith(kBoxes), {}, now, viewsAllOver());
  EXPECT_EQ(count(changes, MapChange::Kind::kRemoved), 1);
  EXPECT_EQ(count(changes, MapChange::Kind::kNew), 1);
}

}  // namespace
}  // namespace vismem
