// Tests M8.
#include <gtest/gtest.h>

#include <numbers>

#include "active_visual_memory/core/primitives/finders.h"
#include "active_visual_memory/floor_edges.h"

namespace vismem {
namespace {

using testing::edge;
using testing::listed;

FloorEdges findStripes(const std::vector<FloorEdge>& edges) {
  return vismem::findStripes(edges, {}, testing::scratch());
}

TEST(StripeFinder, TwoAntiparallelEdgesMakeTheMiddleLineOfAStripe) {
  const auto found = findStripes({edge(1, {{0, 0}, {1, 0}}), edge(2, {{1.2, 0.06}, {0.2, 0.06}})});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found[0].width_m, 0.06, 1e-9);
  EXPECT_NEAR(found[0].line.a.y(), 0.03, 1e-9);
  EXPECT_NEAR(found[0].length, 1.2, 1e-9) << "the union of both extents";
  EXPECT_EQ(listed(found[0].segments), (std::vector<std::uint64_t>{1, 2}));
  const Primitive stripe = stripePrimitive(found[0]);
  EXPECT_EQ(stripe.kind, PrimitiveKind::kStripe);
  EXPECT_NEAR(stripe.heading_rad, 0.0, 1e-9);
  EXPECT_NEAR((stripe.centre - Eigen::Vector2d(0.6, 0.03)).norm(), 0.0, 1e-9);
}

TEST(StripeFinder, RejectsEqualPolarityAnotherLabelPatchesAndWidePairs) {
  const FloorEdge one = edge(1, {{0, 0}, {1, 0}});
  EXPECT_TRUE(findStripes({one, edge(2, {{0, 0.06}, {1, 0.06}})}).empty()) << "one polarity";
  EXPECT_TRUE(findStripes({one, edge(2, {{1, 0.06}, {0, 0.06}}, "wall")}).empty());
  EXPECT_TRUE(findStripes({one, edge(2, {{1, 0.2}, {0, 0.2}})}).empty()) << "20 cm wide, 13 at most";
  EXPECT_TRUE(findStripes({edge(1, {{0, 0}, {0.1, 0}}), edge(2, {{0.1, 0.06}, {0, 0.06}})}).empty())
      << "a patch of 10 x 6 cm";
}

TEST(StripeFinder, HeadingsLieBetweenZeroAndPi) {
  const Primitive stripe =
      stripePrimitive(findStripes({edge(1, {{0, 1}, {0, 0}}), edge(2, {{0.05, 0}, {0.05, 1}})}).at(0));
  EXPECT_NEAR(stripe.heading_rad, 0.5 * std::numbers::pi, 1e-9);
}

TEST(StripeFinder, JoinsPiecesOfOneLine) {
  const auto found = findStripes({edge(1, {{0, 0}, {1, 0}}), edge(2, {{1, 0.05}, {0, 0.05}}),
                                  edge(3, {{1.2, 0}, {2, 0}}), edge(4, {{2, 0.05}, {1.2, 0.05}})});
  ASSERT_EQ(found.size(), 1U) << "a gap of 20 cm, 25 at most";
  EXPECT_NEAR(found[0].length, 2.0, 1e-9);
}

}  // namespace
}  // namespace vismem
