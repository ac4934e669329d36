// Tests M9.
#include "active_visual_memory/core/markings/shape_edges.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "active_visual_memory/published_elements.h"
#include "common/geometry/angles.h"

namespace vismem {
namespace {

TEST(ShapeEdges, ReplaceACircleByRegularChords) {
  // Ten chords of 0.3 m beside a circle of 0.5 m, as far views give them; every other one is confirmed.
  std::vector<MemoryElement> elements;
  Primitive circle;
  circle.id = 7;
  circle.kind = PrimitiveKind::kCircle;
  circle.radius_m = 0.5;
  for (int i = 0; i < 10; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / 10;
    const Eigen::Vector2d middle = 0.49 * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    const Eigen::Vector2d half = 0.16 * Eigen::Vector2d(-std::sin(angle), std::cos(angle));
    elements.push_back(seen(static_cast<std::uint64_t>(i + 1), {middle - half, middle + half}));
    publish(elements.back(), i % 2 == 0, CameraTiltCovariance::Zero());
    circle.segments.push_back(elements.back().value.id);
  }
  const Published published = complete(elements, {circle});
  double length_m = 0.0;
  for (const MemorySegment& segment : published.segments) {
    EXPECT_GE(segment.id, 1000U) << "the chords found are not published beside the regular ones";
    EXPECT_TRUE(segment.confirmed);
    for (const Eigen::Vector2d& p : {segment.odom.floor().a, segment.odom.floor().middle()}) {
      EXPECT_NEAR(p.norm(), 0.5, 0.011);
    }
    length_m += segment.odom.length();
  }
  EXPECT_GT(length_m, 0.9 * 2.0 * std::numbers::pi * 0.5);
  EXPECT_EQ(published.primitives[0].segments.size(), published.segments.size());
}

TEST(ShapeEdges, CompleteAnEdgeOfACircleFromTheOtherOne) {
  // The outer edge all around, half of the inner one.
  std::vector<MemoryElement> elements;
  Primitive circle;
  circle.id = 7;
  circle.kind = PrimitiveKind::kCircle;
  circle.radius_m = 0.5;
  circle.width_m = 0.05;
  const auto add = [&](int i, double radius, double direction) {
    const double angle = 2.0 * std::numbers::pi * i / 10;
    const Eigen::Vector2d middle = radius * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    const Eigen::Vector2d half = direction * 0.16 * Eigen::Vector2d(-std::sin(angle), std::cos(angle));
    elements.push_back(seen(elements.size() + 1, {middle - half, middle + half}));
    circle.segments.push_back(elements.back().value.id);
  };
  for (int i = 0; i < 10; ++i) add(i, 0.52, 1.0);
  for (int i = 0; i < 5; ++i) add(i, 0.47, -1.0);
  double inner = 0.0;
  for (const MemorySegment& segment : complete(elements, {circle}).segments) {
    if (segment.odom.floor().middle().norm() < 0.5) inner += segment.odom.length();
  }
  EXPECT_GT(inner, 0.9 * 2.0 * std::numbers::pi * 0.475);
}

TEST(ShapeEdges, KeepTheIdOfAnEdge) {
  const std::vector<MemoryElement> elements{seen(1, kLower), seen(2, kUpper)};
  std::uint64_t next = 1000;
  ShapeEdges shapes({});
  std::vector<std::uint64_t> ids;
  for (int i = 0; i < 2; ++i) {
    std::vector<MemorySegment> segments{elements[0].value, elements[1].value};
    std::vector<Primitive> none;
    shapes.complete(segments, elements, none, [&] { return next++; });
    ASSERT_EQ(segments.size(), 4U);
    ids.push_back(segments[2].id);
  }
  EXPECT_EQ(ids[0], ids[1]);
  EXPECT_EQ(next, 1002U);
}

/// A world of bright lines 15 cm wide: two that cross at the origin, and one whose far edge nothing confirms.
TEST(ShapeEdges, OneWidthRangeServesLinesOfFifteenCentimetres) {
  const std::vector<MemoryElement> elements{
      seen(1, {{-2.0, -0.075}, {2.0, -0.075}}), seen(2, {{2.0, 0.075}, {-2.0, 0.075}}),
      seen(3, {{-0.075, 2.0}, {-0.075, -2.0}}), seen(4, {{0.075, -2.0}, {0.075, 2.0}})};
  const auto parts = [&](const ShapeEdges::Params& params) {
    std::vector<MemorySegment> segments;
    for (const MemoryElement& element : elements) segments.push_back(element.value);
    std::vector<Primitive> none;
    std::uint64_t next = 1000;
    ShapeEdges(params).complete(segments, elements, none, [&] { return next++; });
    return std::pair(
        std::count_if(segments.begin(), segments.end(),
                      [](const MemorySegment& s) { return std::abs(s.odom.length() - 1.925) < 0.01; }),
        std::count_if(segments.begin(), segments.end(),
                      [](const MemorySegment& s) { return std::abs(s.odom.length() - 0.15) < 0.01; }));
  };
  EXPECT_EQ(parts({}), std::pair(0L, 0L)) << "13 cm is the default maximum";
  ShapeEdges::Params wide;
  wide.line_width = {0.10, 0.20};
  EXPECT_EQ(parts(wide), std::pair(8L, 4L)) << "each edge is split at the crossing, each line end closed";
}

}  // namespace
}  // namespace vismem
