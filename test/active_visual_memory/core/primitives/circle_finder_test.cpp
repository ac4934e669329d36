// Tests M8.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "active_visual_memory/core/primitives/finders.h"
#include "active_visual_memory/floor_edges.h"

namespace vismem {
namespace {

using testing::edge;
using testing::scratch;

/// Chords that a line fit finds on an arc of a circle around (0.4, -0.2). @param direction +1:
/// counter-clockwise.
std::vector<FloorEdge> chords(double radius_m, int of, int count, double direction, std::uint64_t first_id) {
  std::vector<FloorEdge> edges;
  const double half_turn = std::numbers::pi / of;
  for (int i = 0; i < count; ++i) {
    const double angle = 2.0 * half_turn * i;
    const Eigen::Vector2d out{std::cos(angle), std::sin(angle)};
    const Eigen::Vector2d along{-out.y(), out.x()};
    // The fitted line cuts the arc at 1 / sqrt(3) of its half length.
    const Eigen::Vector2d middle =
        Eigen::Vector2d(0.4, -0.2) + radius_m * (1.0 - half_turn * half_turn / 6.0) * out;
    const Eigen::Vector2d half = direction * radius_m * half_turn * along;
    edges.push_back(edge(first_id + static_cast<std::uint64_t>(i), {middle - half, middle + half}));
  }
  return edges;
}

TEST(CircleFinder, FindsCentreAndRadiusOfAFullCircle) {
  const auto found = findCircles(chords(0.5, 12, 12, 1.0, 1), {}, scratch());
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].kind, PrimitiveKind::kCircle);
  EXPECT_NEAR((found[0].centre - Eigen::Vector2d(0.4, -0.2)).norm(), 0.0, 0.005);
  EXPECT_NEAR(found[0].radius_m, 0.5, 0.005);
  EXPECT_EQ(found[0].width_m, 0.0) << "a disc has one edge";
  EXPECT_EQ(found[0].segments.size(), 12U);
}

TEST(CircleFinder, TwoConcentricEdgesOfOppositePolarityAreOnePaintedCircle) {
  auto edges = chords(0.525, 12, 12, 1.0, 1);
  const auto inner = chords(0.475, 12, 12, -1.0, 101);
  edges.insert(edges.end(), inner.begin(), inner.end());
  const auto found = findCircles(edges, {}, scratch());
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found[0].width_m, 0.05, 0.005);
  EXPECT_NEAR(found[0].radius_m, 0.5, 0.005);
  EXPECT_EQ(found[0].segments.size(), 24U);
}

TEST(CircleFinder, NeedsEnoughOfTheCircumference) {
  EXPECT_TRUE(findCircles(chords(0.5, 12, 4, 1.0, 1), {}, scratch()).empty()) << "4 chords, 5 needed";
  EXPECT_TRUE(findCircles(chords(0.5, 20, 6, 1.0, 1), {}, scratch()).empty()) << "30 % covered, 40 % needed";
  EXPECT_EQ(findCircles(chords(0.5, 20, 12, 1.0, 1), {}, scratch()).size(), 1U) << "60 % covered";
  CircleParams small;
  small.max_radius_m = 0.4;
  EXPECT_TRUE(findCircles(chords(0.5, 12, 12, 1.0, 1), small, scratch()).empty());
}

}  // namespace
}  // namespace vismem
