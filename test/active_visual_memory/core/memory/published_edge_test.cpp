// Tests M9.
#include "active_visual_memory/core/memory/published_edge.h"

#include <gtest/gtest.h>

#include <cmath>

#include "active_visual_memory/published_elements.h"

namespace vismem {
namespace {

TEST(PublishedEdge, HasACornerWhereTheLinesCross) {
  // End b lies 3 cm before the corner (1, 0), end a 2 cm below it.
  MemoryElement bottom = seen(1, {{0.0, 0.0}, {0.97, 0.0}});
  MemoryElement right = seen(2, {{1.0, -0.02}, {1.0, 0.8}});
  const PublishedEdge one(bottom.value, &bottom);
  const PublishedEdge other(right.value, &right);
  const auto corner = findCorner(one, other, {});
  ASSERT_TRUE(corner);
  EXPECT_NEAR((corner->place - Eigen::Vector2d(1.0, 0.0)).norm(), 0.0, 1e-9);
  EXPECT_NEAR(corner->distance_m, 0.03 + 0.02, 1e-9);
  EXPECT_FALSE(findCorner(other, one, {})) << "from end b of the second to end a of the first";
}

TEST(PublishedEdge, ACornerNeedsAnAngleAndEndsWithinReach) {
  MemoryElement bottom = seen(1, {{0.0, 0.0}, {1.0, 0.0}});
  const auto meets = [&](const Segment2& line, bool censored = false) {
    MemoryElement other = seen(2, line);
    MemoryElement first = censored ? seen(1, {{0.0, 0.0}, {1.0, 0.0}}, true) : bottom;
    return findCorner({first.value, &first}, {other.value, &other}, {}).has_value();
  };
  EXPECT_TRUE(meets({{1.0, 0.0}, {1.0, 1.0}}));
  EXPECT_FALSE(meets({{1.0, 0.0}, {1.0, 1.0}}, true)) << "a censored end has no corner";
  EXPECT_FALSE(meets({{1.0, 0.0}, {2.0, 0.3}})) << "0.29 rad between them, 0.4 rad needed";
  EXPECT_FALSE(meets({{1.0, 0.2}, {1.0, 1.0}})) << "20 cm away";
}

TEST(EndReach, OfAnEndGrowsWithItsBestViewUpToALimit) {
  const CornerParams params;
  ExtentEnd end;
  end.best_m2 = 0.0;
  EXPECT_DOUBLE_EQ(params.reach.of(end), 0.03);
  end.best_m2 = 0.04 * 0.04;
  EXPECT_DOUBLE_EQ(params.reach.of(end), 0.07);
  end.best_m2 = 1.0;
  EXPECT_DOUBLE_EQ(params.reach.of(end), 0.12);
}

TEST(PublishedEdge, HasItsEndsAtCornersAtTheIntersectionOfTheLines) {
  // Two sides of a bright square whose corner is (1, 0): one stops 3 cm short of it, one goes on by 2 cm.
  const Segment2 bottom{{0.0, 0.0}, {0.97, 0.0}};
  const Segment2 right{{1.0, -0.02}, {1.0, 0.8}};
  const auto corner = [](const MemorySegment& segment, bool at_b) {
    return Eigen::Vector2d((at_b ? segment.odom.b : segment.odom.a).head<2>());
  };
  const Published met = complete({seen(1, bottom), seen(2, right)});
  EXPECT_NEAR((corner(met.segments[0], true) - Eigen::Vector2d(1.0, 0.0)).norm(), 0.0, 1e-6);
  EXPECT_NEAR((corner(met.segments[1], false) - Eigen::Vector2d(1.0, 0.0)).norm(), 0.0, 1e-6);
  EXPECT_NEAR(corner(met.segments[0], false).norm(), 0.0, 1e-6) << "the other end stays";
  // What is hidden or cut meets nothing, nor what is too far away, nor two edges of different surfaces.
  EXPECT_NEAR(corner(complete({seen(1, bottom, true), seen(2, right)}).segments[0], true).x(), 0.97, 1e-6);
  EXPECT_NEAR(corner(complete({seen(1, bottom), seen(2, {{1.2, 0.0}, {1.2, 0.8}})}).segments[0], true).x(),
              0.97, 1e-6);
  EXPECT_NEAR(corner(complete({seen(1, bottom), seen(2, {right.b, right.a})}).segments[0], true).x(), 0.97,
              1e-6);
}

}  // namespace
}  // namespace vismem
