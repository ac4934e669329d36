// Tests M9.
#include "active_visual_memory/core/markings/junctions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "active_visual_memory/published_elements.h"
#include "common/geometry/angles.h"

namespace vismem {
namespace {

/// The published edges of one direction without ends of lines, in their order along it.
std::vector<Segment2> along(const Published& published, double direction) {
  std::vector<Segment2> found;
  for (const MemorySegment& s : published.segments) {
    const Segment2 floor = s.odom.floor();
    const bool is_end = floor.length() < 0.1;  // of a line
    if (!is_end && std::abs(angleDifference(floor.direction(), direction)) < 0.1) found.push_back(floor);
  }
  std::sort(found.begin(), found.end(), [&](const Segment2& a, const Segment2& b) {
    return std::cos(direction) * (a.a.x() - b.a.x()) + std::sin(direction) * (a.a.y() - b.a.y()) < 0.0;
  });
  return found;
}

// A line along x from -1 to 1, 5 cm wide, and one below it along y that reaches it at x = 0.2: bright inside.
const Segment2 kTopOfBar{{1.0, 0.05}, {-1.0, 0.05}};
const Segment2 kBottomOfBar{{-1.0, 0.0}, {1.0, 0.0}};
const Segment2 kLeftOfStem{{0.175, 0.02}, {0.175, -1.0}};
const Segment2 kRightOfStem{{0.225, -1.0}, {0.225, -0.03}};

TEST(Junctions, SplitAnEdgeWhereALineJoinsIt) {
  const Published published =
      complete({seen(1, kTopOfBar), seen(2, kBottomOfBar), seen(3, kLeftOfStem), seen(4, kRightOfStem)});
  const auto bottom = along(published, 0.0);
  ASSERT_EQ(bottom.size(), 2U) << "of the side that the other line joins";
  EXPECT_NEAR(bottom[0].a.x(), -1.0, 1e-3);
  EXPECT_NEAR(bottom[0].b.x(), 0.175, 1e-3);
  EXPECT_NEAR(bottom[1].a.x(), 0.225, 1e-3);
  EXPECT_NEAR(bottom[1].b.x(), 1.0, 1e-3);
  EXPECT_EQ(along(published, std::numbers::pi).size(), 1U) << "the other side goes on";
  // The sides of the joining line end on the edge.
  EXPECT_NEAR(along(published, -std::numbers::pi / 2)[0].a.y(), 0.0, 1e-3);
  EXPECT_NEAR(along(published, std::numbers::pi / 2)[0].b.y(), 0.0, 1e-3);
}

TEST(Junctions, SplitAllFourEdgesWhereLinesCross) {
  const Published published =
      complete({seen(1, kTopOfBar), seen(2, kBottomOfBar), seen(3, {{0.175, 1.0}, {0.175, -1.0}}),
                seen(4, {{0.225, -1.0}, {0.225, 1.0}})});
  for (const double direction : {0.0, std::numbers::pi / 2, std::numbers::pi, -std::numbers::pi / 2}) {
    EXPECT_EQ(along(published, direction).size(), 2U) << direction;
  }
}

TEST(Junctions, DoNotSplitAnEdgeThatALineEndsAwayFrom) {
  const Published published =
      complete({seen(1, kTopOfBar), seen(2, kBottomOfBar), seen(3, {{0.175, -0.2}, {0.175, -1.0}}),
                seen(4, {{0.225, -1.0}, {0.225, -0.2}})});
  // The upper end of the stem is published, too: it is 5 cm long.
  const auto bottom = along(published, 0.0);
  EXPECT_EQ(std::count_if(bottom.begin(), bottom.end(), [](const Segment2& s) { return s.length() > 1.9; }),
            1);
}

TEST(Junctions, DoNotSplitTheOuterEdgeOfACorner) {
  // The stem reaches the bar at its right end: its right side meets the bar's end, the bar's top goes on.
  const Published published =
      complete({seen(1, kTopOfBar), seen(2, {{-1.0, 0.0}, {0.95, 0.0}}), seen(3, {{0.95, 0.0}, {0.95, -1.0}}),
                seen(4, {{1.0, -1.0}, {1.0, 0.05}})});
  const auto top = along(published, std::numbers::pi);
  ASSERT_EQ(top.size(), 1U);
  EXPECT_NEAR(top[0].length(), 2.0, 0.01);
  const auto bottom = along(published, 0.0);
  ASSERT_EQ(bottom.size(), 1U);
  EXPECT_NEAR(bottom[0].b.x(), 0.95, 1e-3);
}

TEST(Junctions, KeepTheOuterEdgesOfACornerWhoseInnerEdgeWasRememberedTooLong) {
  // The inner edge of the bar runs 2 mm past the inner corner: that is no junction, and the right side of the
  // stem still ends at the outer corner.
  const Published published =
      complete({seen(1, kTopOfBar), seen(2, {{-1.0, 0.0}, {0.952, 0.0}}), seen(3, {{0.95, 0.0}, {0.95, -1.0}}),
                seen(4, {{1.0, -1.0}, {1.0, 0.05}})});
  const auto right = along(published, std::numbers::pi / 2);
  ASSERT_EQ(right.size(), 1U);
  EXPECT_NEAR(right[0].b.y(), 0.05, 1e-3);
}

TEST(Junctions, SplitALineWhereACircleCrossesIt) {
  Primitive circle;
  circle.id = 7;
  circle.kind = PrimitiveKind::kCircle;
  circle.centre = {0.0, 0.0};
  circle.radius_m = 0.5;
  circle.width_m = 0.05;
  const Published published = complete({seen(1, {{-2.0, 0.0}, {2.0, 0.0}})}, {circle});
  const auto parts = along(published, 0.0);
  ASSERT_EQ(parts.size(), 3U);
  EXPECT_NEAR(parts[0].b.x(), -0.525, 1e-3);
  EXPECT_NEAR(parts[1].a.x(), -0.475, 1e-3);
  EXPECT_NEAR(parts[1].b.x(), 0.475, 1e-3);
  EXPECT_NEAR(parts[2].a.x(), 0.525, 1e-3);
}

}  // namespace
}  // namespace vismem
