// Tests M9.
#include "active_visual_memory/core/memory/edge_corner.h"

#include <gtest/gtest.h>

#include <cmath>

#include "active_visual_memory/published_elements.h"

namespace vismem {
namespace {

TEST(EdgeCorner, LiesWhereTheLinesCross) {
  // End b lies 3 cm before the corner (1, 0), end a 2 cm below it.
  MemoryElement bottom = seen(1, {{0.0, 0.0}, {0.97, 0.0}});
  MemoryElement right = seen(2, {{1.0, -0.02}, {1.0, 0.8}});
  const CornerEdge one = cornerEdge(bottom.value, bottom);
  const CornerEdge other = cornerEdge(right.value, right);
  EdgeCorner corner;
  ASSERT_TRUE(findCorner(one, other, {}, corner));
  EXPECT_NEAR((corner.place - Eigen::Vector2d(1.0, 0.0)).norm(), 0.0, 1e-9);
  EXPECT_NEAR(corner.distance_m, 0.03 + 0.02, 1e-9);
  EXPECT_FALSE(findCorner(other, one, {}, corner)) << "from end b of the second to end a of the first";
}

TEST(EdgeCorner, NeedsAnAngleAndEndsWithinReach) {
  MemoryElement bottom = seen(1, {{0.0, 0.0}, {1.0, 0.0}});
  const auto meets = [&](const Segment2& line, bool censored = false) {
    MemoryElement other = seen(2, line);
    MemoryElement first = censored ? seen(1, {{0.0, 0.0}, {1.0, 0.0}}, true) : bottom;
    EdgeCorner corner;
    return findCorner(cornerEdge(first.value, first), cornerEdge(other.value, other), {}, corner);
  };
  EXPECT_TRUE(meets({{1.0, 0.0}, {1.0, 1.0}}));
  EXPECT_FALSE(meets({{1.0, 0.0}, {1.0, 1.0}}, true)) << "a censored end has no corner";
  EXPECT_FALSE(meets({{1.0, 0.0}, {2.0, 0.3}})) << "0.29 rad between them, 0.4 rad needed";
  EXPECT_FALSE(meets({{1.0, 0.2}, {1.0, 1.0}})) << "20 cm away";
}

TEST(EdgeCorner, TheReachOfAnEndGrowsWithItsBestViewUpToALimit) {
  const CornerParams params;
  ExtentEnd end;
  end.best_m2 = 0.0;
  EXPECT_DOUBLE_EQ(endReach(end, params), 0.03);
  end.best_m2 = 0.04 * 0.04;
  EXPECT_DOUBLE_EQ(endReach(end, params), 0.07);
  end.best_m2 = 1.0;
  EXPECT_DOUBLE_EQ(endReach(end, params), 0.12);
}

}  // namespace
}  // namespace vismem
