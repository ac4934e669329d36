// Tests M8, M9.
#include <gtest/gtest.h>

#include <algorithm>

#include "active_visual_memory/core/primitives/finders.h"
#include "active_visual_memory/floor_edges.h"

namespace vismem {
namespace {

using testing::edge;
using testing::scratch;

std::vector<FloorEdge> outline(const std::vector<Eigen::Vector2d>& corners) {
  std::vector<FloorEdge> edges;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    edges.push_back(edge(i + 1, {corners[i], corners[(i + 1) % corners.size()]}));
  }
  return edges;
}

const std::vector<Eigen::Vector2d> kRectangle{{0.0, 0.0}, {0.6, 0.0}, {0.6, 0.4}, {0.0, 0.4}};

/// The best reading.
const Primitive& best(const Shapes& found) {
  return *std::max_element(found.begin(), found.end(),
                           [](const Primitive& a, const Primitive& b) { return a.quality < b.quality; });
}

TEST(PolygonFinder, FourEdgesMakeARectangle) {
  const auto found = findPolygons(outline(kRectangle), {}, scratch());
  ASSERT_FALSE(found.empty());
  const Primitive& shape = best(found);
  EXPECT_EQ(shape.kind, PrimitiveKind::kParallelogram);
  EXPECT_EQ(shape.hidden_vertex, -1);
  EXPECT_NEAR(shape.length_m, 0.6, 1e-9);
  EXPECT_NEAR(shape.width_m, 0.4, 1e-9);
  EXPECT_NEAR((shape.centre - Eigen::Vector2d(0.3, 0.2)).norm(), 0.0, 1e-9);
}

TEST(PolygonFinder, ThreeCornersGiveTheHiddenFourth) {
  // Two sides end 25 cm before the corner (0.6, 0.4).
  auto edges = outline(kRectangle);
  edges[1] = edge(2, {{0.6, 0.0}, {0.6, 0.15}});
  edges[2] = edge(3, {{0.35, 0.4}, {0.0, 0.4}});
  const auto found = findPolygons(edges, {}, scratch());
  ASSERT_FALSE(found.empty());
  const Primitive& shape = best(found);
  ASSERT_GE(shape.hidden_vertex, 0);
  const auto& hidden = shape.vertices[static_cast<std::size_t>(shape.hidden_vertex)];
  EXPECT_NEAR((hidden - Eigen::Vector2d(0.6, 0.4)).norm(), 0.0, 1e-9);
}

TEST(PolygonFinder, ThreeEdgesMakeATriangle) {
  const auto found = findPolygons(outline({{0.0, 0.0}, {0.6, 0.0}, {0.3, 0.5}}), {}, scratch());
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].kind, PrimitiveKind::kTriangle);
  EXPECT_EQ(found[0].vertices.size(), 3U);
}

TEST(PolygonFinder, EdgesOfOppositePolarityMakeNoShape) {
  auto edges = outline(kRectangle);
  edges[1] = edge(2, {edges[1].line.b, edges[1].line.a});
  EXPECT_TRUE(findPolygons(edges, {}, scratch()).empty());
}

}  // namespace
}  // namespace vismem
