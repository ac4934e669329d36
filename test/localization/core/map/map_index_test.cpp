// Tests L4, L5.
#include "localization/core/map/map_index.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "common/geometry/angles.h"
#include "localization/core/many_lines.h"
#include "localization/corridor_world.h"

namespace vismem {
namespace {

MapSegment wall(double x1, double y1, double x2, double y2, const Label& label) {
  return {{{x1, y1, 0.0}, {x2, y2, 0.0}}, label, 0.0};
}

TEST(MapIndex, AnyMatchesEveryKnownLabelAndUnknownNone) {
  SegmentMap map;
  map.segments = {wall(0, 0, 4, 0, "skirting"), wall(0, 1, 4, 1, kAnyLabel)};
  const MapIndex index(map, {});
  EXPECT_NEAR(index.distance(*index.floorLabelId("skirting"), {2.0, 0.9}), 0.1, 1e-6);
  EXPECT_NEAR(index.distance(*index.floorLabelId("stripe_edge"), {2.0, 0.4}), 0.6, 1e-6);
  EXPECT_FALSE(index.labelId(kUnknownLabel));
}

TEST(MapIndex, LabelsWithoutAMapSegmentAreRejected) {
  SegmentMap map;
  map.segments = {wall(0, 0, 4, 0, "skirting"), {{{1, 0, 0.5}, {1, 0, 2.0}}, "shelf", 0.0}};
  const MapIndex index(map, {});
  EXPECT_FALSE(index.labelId("door_foot"));
  EXPECT_TRUE(index.labelId("shelf"));
  EXPECT_FALSE(index.floorLabelId("shelf"));  // it does not touch the floor
}

TEST(MapIndex, AnUprightEdgeTouchesTheFloorAtItsFoot) {
  SegmentMap map;
  map.segments = {{{{1, 2, 0.0}, {1, 2, 2.0}}, "door_jamb", 0.0}};
  const MapIndex index(map, {});
  EXPECT_NEAR(index.distance(*index.floorLabelId("door_jamb"), {1.3, 2.4}), 0.5, 0.01);
}

TEST(MapIndex, LevelEdgesOfOneThingCountForEachOther) {
  const auto raised = [](double x1, double y1, double x2, double y2, double z, const Label& label) {
    return MapSegment{{{x1, y1, z}, {x2, y2, z}}, label, 0.0};
  };
  SegmentMap map;
  map.segments = {wall(0, 0, 4, 0, "skirting"), raised(0, 0.01, 4, 0.01, 0.08, "skirting_top"),
                  raised(0, 0.3, 4, 0.3, 0.1, "shelf"), wall(0, 2, 4, 2, "door_foot"),
                  raised(0, 2, 4, 2, 2.0, "lintel")};
  const MapIndex index(map, {});
  for (const Label label : {"skirting", "skirting_top"}) {
    const auto& levels = index.levels(*index.labelId(label));
    ASSERT_EQ(levels.size(), 2u) << label;
    EXPECT_EQ(levels[0].height_m, 0.0);
    EXPECT_EQ(levels[1].height_m, 0.08);
    EXPECT_NEAR(index.nearest(levels[0].field, {2.0, 0.5}, 0.0)->distance_m, 0.5, 1e-9);
    EXPECT_NEAR(index.nearest(levels[1].field, {2.0, 0.5}, 0.0)->distance_m, 0.49, 1e-9);
  }
  // 0.3 m off is another thing.
  const auto& shelf = index.levels(*index.labelId("shelf"));
  ASSERT_EQ(shelf.size(), 1u);
  EXPECT_EQ(shelf[0].height_m, 0.1);
  // So is what is far above.
  EXPECT_EQ(index.levels(*index.labelId("door_foot")).size(), 1u);
  ASSERT_EQ(index.levels(*index.labelId("lintel")).size(), 1u);
  EXPECT_EQ(index.levels(*index.labelId("lintel"))[0].height_m, 2.0);
}

TEST(MapIndexProperty, TheFieldAgreesWithExhaustiveSearch) {
  const SegmentMap map = test::corridorMap();
  for (const bool gated : {false, true}) {
    MapIndex::Params params;
    if (gated) params.direction_gate_rad = degToRad(20);
    const MapIndex index(map, params);
    RandomEngine engine(5);
    int compared = 0;
    for (int i = 0; i < 5000; ++i) {
      const Eigen::Vector2d p(uniform(engine, -2, 10), uniform(engine, -2, 7));
      const double direction = uniform(engine, -4, 4);
      const int label = static_cast<int>(pick(engine, 2));
      const auto field = index.nearest(label, p, direction);
      // Directions are compared in bins of 15 degrees.
      const double certainly_rad = gated ? degToRad(20) : std::numbers::pi;
      const double perhaps_rad = gated ? degToRad(35) : std::numbers::pi;
      const double most_m = exhaustiveDistance(index, label, p, direction, certainly_rad);
      if (!field) {
        EXPECT_GE(most_m, params.reach_m) << p.transpose();
        continue;
      }
      EXPECT_LE(field->distance_m, most_m + 1e-9) << p.transpose();
      EXPECT_GE(field->distance_m, exhaustiveDistance(index, label, p, direction, perhaps_rad) - 1e-9);
      ++compared;
    }
    EXPECT_GT(compared, 1000);
  }
}

TEST(MapIndexProperty, DistancesBeyondTheFieldsAreExact) {
  RandomEngine engine(18);
  const SegmentMap map = manyLines(engine);
  const MapIndex index(map, {});
  for (int i = 0; i < 500; ++i) {
    const double side_m = i % 2 == 0 ? 100.0 : 3000.0;
    const Eigen::Vector2d p(uniform(engine, -side_m, side_m), uniform(engine, -side_m, side_m));
    for (int label = 0; label < 2; ++label) {
      ASSERT_NEAR(index.distance(label, p), exhaustiveDistance(index, label, p), 1e-9) << p.transpose();
    }
  }
}

}  // namespace
}  // namespace vismem
