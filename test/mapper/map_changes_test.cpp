// What changed in a drawn room since its map was made. Tests B6.
#include "mapper/core/map_changes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "localization/core/map/visibility.h"

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
  std::vector<SeenView> views;
  for (const Eigen::Vector2d& place : {Eigen::Vector2d(-1.2, -1.2), {1.2, -1.2}, {1.2, 1.2}, {-1.2, 1.2}}) {
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
      views.push_back({intrinsicsFromFieldOfView(320, 240, 1.0), T_map_camera});
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

/// As maps of drives that saw each edge so often, or of a drawing (0).
std::vector<CountedRow> counted(const SegmentMap& map, int times_seen = 40) {
  std::vector<CountedRow> rows;
  for (const MapSegment& row : map.segments) rows.push_back({row, times_seen, times_seen > 0 ? 1 : 0});
  return rows;
}

std::vector<MapChange> mapChanges(const SegmentMap& before, const SeenFloor& seen_before,
                                  const SegmentMap& now, const SeenFloor& seen_now) {
  const bool is_complete = seen_before.views.empty();
  return compareMaps(counted(before, is_complete ? 0 : 40), {{seen_before}, is_complete}, counted(now),
                     seen_now)
      .changes;
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

TEST(MapChanges, WhatTheFirstDriveDidNotSeeIsAddedAndNotNew) {
  // It saw nothing of the east half.
  SeenFloor west;
  for (const SeenView& view : viewsAllOver().views) {
    const Eigen::Vector2d camera = view.T_map_camera.translation().head<2>();
    const bool looks_west =
        camera.x() < 0.0 &&
        CameraView(view.intrinsics, view.T_map_camera).shows(camera - Eigen::Vector2d(1.2, 0.0));
    if (looks_west) west.views.push_back(view);
  }
  const SegmentMap old = roomWith({kBoxes[0]});
  EXPECT_TRUE(mapChanges(old, west, roomWith({kBoxes[0], kBoxes[2]}), viewsAllOver()).empty());
  const auto found =
      compareMaps(counted(old), {{west}, false}, counted(roomWith({kBoxes[0], kBoxes[2]})), viewsAllOver());
  EXPECT_EQ(found.added.size(), 4U);  // the sides of the box
  EXPECT_EQ(mapChanges(old, {}, roomWith({kBoxes[0], kBoxes[2]}), viewsAllOver()).size(), 1U);
}

TEST(MapChanges, ASideOfAThingThatWasOverlookedIsNoChange) {
  SegmentMap now = roomWith(kBoxes);
  now.segments.pop_back();
  EXPECT_TRUE(mapChanges(roomWith(kBoxes), viewsAllOver(), now, viewsAllOver()).empty());
}

TEST(MapChanges, AThingThatWasSeenButNotConfirmedIsNoChange) {
  const SegmentMap now = roomWith({kBoxes[0], kBoxes[1], kBoxes[2]});
  SeenFloor seen = viewsAllOver();
  EXPECT_EQ(mapChanges(roomWith(kBoxes), viewsAllOver(), now, seen).size(), 1U);
  for (const MapSegment& row : roomWith({kBoxes[3]}).segments)
    seen.traces.push_back({row.world.floor(), kUnknownLabel, 20});
  EXPECT_TRUE(mapChanges(roomWith(kBoxes), viewsAllOver(), now, seen).empty());
  // Another thing stands there.
  for (FloorTrace& trace : seen.traces) trace.label = "white_foot";
  EXPECT_EQ(mapChanges(roomWith(kBoxes), viewsAllOver(), now, seen).size(), 1U);
}

TEST(MapChanges, ALoneEdgeCountsByItsEvidence) {
  SegmentMap now = roomWith({});
  now.segments.push_back({{{1.0, -1.0, 0.0}, {1.25, -1.0, 0.0}}, "red_foot"});
  const auto changesOf = [&](int times_seen) {
    return compareMaps(counted(roomWith({})), {{viewsAllOver()}, false}, counted(now, times_seen),
                       viewsAllOver())
        .changes.size();
  };
  // Some 40 images looked at its place before and showed nothing.
  EXPECT_EQ(changesOf(20), 1U);
  EXPECT_EQ(changesOf(10), 1U);
  EXPECT_EQ(mapChanges(roomWith({}), {}, now, viewsAllOver()).size(), 1U) << "a drawing shows all";
  EXPECT_EQ(changesOf(1), 0U) << "whoever sees it once in 40 images may have missed it before";
}

TEST(MapChanges, WhatIsSeldomSeenMustBeMissingInMoreImages) {
  // 144 images, of which about 40 show the middle of the room.
  const std::vector<CountedRow> now = counted(roomWith({}));
  const SeenBefore before{{viewsAllOver()}, false};
  EXPECT_EQ(compareMaps(counted(roomWith({kBoxes[1]}), 20), before, now, viewsAllOver()).changes.size(), 1U);
  SeenFloor few = viewsAllOver();
  few.views.resize(few.views.size() / 4);
  EXPECT_EQ(compareMaps(counted(roomWith({kBoxes[1]}), 20), before, now, few).changes.size(), 1U);
  EXPECT_TRUE(compareMaps(counted(roomWith({kBoxes[1]}), 1), before, now, few).changes.empty());
}

TEST(MapChanges, ALoneEdgeThatFewImagesShowedIsNoThing) {
  SegmentMap old = roomWith({});
  add(old, {0.0, 0.0}, {0.4, 0.0}, "red_foot");
  const SeenBefore before{{viewsAllOver()}, false};
  const std::vector<CountedRow> now = counted(roomWith({}));
  EXPECT_EQ(compareMaps(counted(old, 12), before, now, viewsAllOver()).changes.size(), 1U);
  EXPECT_TRUE(compareMaps(counted(old, 5), before, now, viewsAllOver()).changes.empty());
}

TEST(MapChanges, WhatMovedLessThanMapsErrDidNotMove) {
  std::vector<Box> boxes = kBoxes;
  boxes[1].middle += Eigen::Vector2d(0.1, 0.05);
  EXPECT_TRUE(mapChanges(roomWith(kBoxes), viewsAllOver(), roomWith(boxes), viewsAllOver()).empty());
}

TEST(MapChanges, AWallIsNoThingThatMoved) {
  SegmentMap before = roomWith({});
  add(before, {-2.0, 0.0}, {2.0, 0.0}, "red_foot");
  const SegmentMap now = roomWith({{{1.0, 1.2}, 0.0, "red_foot"}});
  const auto changes = mapChanges(before, viewsAllOver(), now, viewsAllOver());
  EXPECT_EQ(count(changes, MapChange::Kind::kMoved), 0);
  EXPECT_EQ(count(changes, MapChange::Kind::kRemoved), 1);
  EXPECT_EQ(count(changes, MapChange::Kind::kNew), 1);
}

TEST(MapChanges, WhatWasRejectedIsNotOfferedAgainUntilItChanges) {
  const std::vector<CountedRow> old = counted(roomWith(kBoxes));
  const SeenBefore before{{viewsAllOver()}, false};
  std::vector<Box> boxes = kBoxes;
  boxes[1].middle.x() += 0.6;
  const auto first = compareMaps(old, before, counted(roomWith(boxes)), viewsAllOver());
  ASSERT_EQ(first.changes.size(), 1U);
  const std::vector<ChangeFact> rejected = factsOf(first.changes[0]);
  ASSERT_EQ(rejected.size(), 2U);
  const auto second = compareMaps(old, before, counted(roomWith(boxes)), viewsAllOver(), {}, rejected);
  EXPECT_TRUE(second.changes.empty());
  EXPECT_EQ(second.rejected.size(), 2U);
  // A drive that saw nothing of it does not speak against it.
  EXPECT_EQ(compareMaps(old, before, old, {}, {}, rejected).rejected.size(), 2U);
  // It is back: both facts are over.
  EXPECT_TRUE(compareMaps(old, before, old, viewsAllOver(), {}, rejected).rejected.empty());
  // It moved on: its new place is offered, its old one is not.
  boxes[1].middle.y() += 0.7;
  const auto third = compareMaps(old, before, counted(roomWith(boxes)), viewsAllOver(), {}, rejected);
  ASSERT_EQ(third.changes.size(), 1U);
  EXPECT_EQ(third.changes[0].kind, MapChange::Kind::kNew);
  EXPECT_EQ(third.rejected.size(), 1U);
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
