// Tests M8.
#include <gtest/gtest.h>

#include "active_visual_memory/core/primitives/finders.h"
#include "active_visual_memory/floor_edges.h"

namespace vismem {
namespace {

using testing::edge;
using testing::scratch;

TEST(ArrowFinder, AShaftWithTwoHeadsPointsToItsTip) {
  // The tip lies at (1, 0), both heads run back at 45 degrees.
  const std::vector<FloorEdge> strokes{edge(1, {{0.0, 0.0}, {1.0, 0.0}}, "line", 0.05),
                                       edge(2, {{1.0, 0.0}, {0.8, 0.2}}, "line", 0.05),
                                       edge(3, {{1.0, 0.0}, {0.8, -0.2}}, "line", 0.05)};
  const auto found = findArrows(strokes, {}, 2.5, scratch());
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found[0].heading_rad, 0.0, 1e-9);
  EXPECT_NEAR((found[0].vertices[0] - Eigen::Vector2d(1.0, 0.0)).norm(), 0.0, 1e-9) << "tip";
  EXPECT_NEAR(found[0].vertices[2].y(), 0.2, 1e-9) << "left head";
  EXPECT_NEAR(found[0].width_m, 0.4, 1e-9);
  EXPECT_TRUE(findArrows(strokes, {}, 0.9, scratch()).empty()) << "the shaft is longer than 0.9 m";
  auto askew = strokes;
  askew[2] = edge(3, {{1.0, 0.0}, {0.72, -0.05}}, "line", 0.05);
  EXPECT_TRUE(findArrows(askew, {}, 2.5, scratch()).empty()) << "heads at 45 and 10 degrees";
}

}  // namespace
}  // namespace vismem
