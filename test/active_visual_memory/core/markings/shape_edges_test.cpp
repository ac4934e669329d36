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

TEST(ShapeEdges, CloseBothEndsOfAPaintedLine) {
  const Published published = complete({seen(1, kLower), seen(2, kUpper)});
  ASSERT_EQ(published.segments.size(), 4U);
  for (std::size_t i = 2; i < 4; ++i) {
    const Segment2 end = published.segments[i].odom.floor();
    EXPECT_NEAR(end.length(), 0.05, 0.005);
    EXPECT_NEAR(lineAngleDifference(end.direction(), std::numbers::pi / 2), 0.0, 0.02);
    EXPECT_TRUE(published.segments[i].confirmed);
    EXPECT_EQ(published.segments[i].life, 51.0) << "the life of the side that is known less";
    // The bright side, left of a -> b, is the line's inside.
    const Eigen::Vector2d d = end.b - end.a;
    EXPECT_GT(d.x() * (0.025 - end.a.y()) - d.y() * (0.5 - end.a.x()), 0.0);
  }
}

TEST(ShapeEdges, LeaveACensoredEndOpen) {
  EXPECT_EQ(complete({seen(1, kLower, true), seen(2, kUpper)}).segments.size(), 3U);
}

TEST(ShapeEdges, CloseNoJunction) {
  // Another line meets the right end: its edges begin there.
  const Published published =
      complete({seen(1, kLower), seen(2, kUpper), seen(3, {{1.0, -0.01}, {1.3, -0.4}})});
  EXPECT_EQ(published.segments.size(), 4U) << "only the left end";
}

TEST(ShapeEdges, CutAnEdgeThatRunsOnIntoAnotherOneInItsLine) {
  // The lower side goes on by 30 cm at its right end, then at its left one: both sides of a painted line end
  // together.
  for (const Segment2& over : {Segment2{{0.0, 0.0}, {1.3, 0.0}}, Segment2{{-0.3, 0.0}, {1.0, 0.0}}}) {
    const Published published = complete({seen(1, over), seen(2, kUpper)});
    ASSERT_EQ(published.segments.size(), 4U) << "and both ends are closed";
    const Segment2 cut = published.segments.front().odom.floor();
    EXPECT_EQ(published.segments.front().id, 1U);
    EXPECT_NEAR((cut.a - kLower.a).norm(), 0.0, 0.005);
    EXPECT_NEAR((cut.b - kLower.b).norm(), 0.0, 0.005);
  }
}

TEST(ShapeEdges, CutAnEdgeOfReducedContrast) {
  const Published published = complete({seen(1, {{0.0, 0.0}, {1.3, 0.0}}, false, 45.0), seen(2, kUpper)});
  EXPECT_NEAR(published.segments.front().odom.length(), 1.0, 0.005);
}

TEST(ShapeEdges, CutAnEdgeOfALineMeasuredTooNarrow) {
  const Published published = complete({seen(1, {{0.0, 0.04}, {1.3, 0.04}}), seen(2, kUpper)});
  EXPECT_NEAR(published.segments.front().odom.length(), 1.0, 0.005);
}

TEST(ShapeEdges, TurnAnObservedEndSquareToItsLine) {
  // 5 cm long, and 10 degrees askew; in its middle 1 cm behind the ends of the sides.
  const Eigen::Vector2d middle{1.01, 0.025};
  const Eigen::Vector2d half = 0.025 * Eigen::Vector2d(std::sin(degToRad(10.0)), std::cos(degToRad(10.0)));
  const Published published =
      complete({seen(1, kLower), seen(2, kUpper), seen(3, {middle - half, middle + half})});
  ASSERT_EQ(published.segments.size(), 4U) << "only the left end is added";
  const Segment2 end = published.segments[2].odom.floor();
  EXPECT_EQ(published.segments[2].id, 3U);
  EXPECT_NEAR((end.a - Eigen::Vector2d(1.01, 0.0)).norm(), 0.0, 0.003);
  EXPECT_NEAR((end.b - Eigen::Vector2d(1.01, 0.05)).norm(), 0.0, 0.003);
}

TEST(ShapeEdges, DoNotCutWhereTheOtherEdgeContinuesOrALineBranchesOff) {
  const Segment2 over{{0.0, 0.0}, {1.5, 0.0}};
  const auto length = [](const Published& p) { return p.segments.front().odom.length(); };
  // A line of 5 cm that branches off interrupts the upper side.
  EXPECT_NEAR(length(complete({seen(1, over), seen(2, kUpper), seen(3, {{1.5, 0.05}, {1.05, 0.05}})})), 1.5,
              0.01);
  EXPECT_NEAR(length(complete({seen(1, over), seen(2, kUpper), seen(3, {{1.0, 0.05}, {1.0, 0.6}})})), 1.5,
              0.01);
  // An end that an image border cut is none, and a side of a line that is mostly alone has no partner.
  EXPECT_NEAR(length(complete({seen(1, over), seen(2, {{0.0, 0.05}, {1.0, 0.05}})})), 1.5, 0.01)
      << "one polarity";
  EXPECT_NEAR(length(complete({seen(1, over), seen(2, {{0.3, 0.05}, {0.0, 0.05}})})), 1.5, 0.01);
}

TEST(ShapeEdges, ExtendAnEdgeToTheLineThatTheOtherOneReaches) {
  // The upper side was seen 20 cm short; the lower one ends at another line.
  const std::vector<MemoryElement> elements{seen(1, kLower), seen(2, {{0.8, 0.05}, {0.0, 0.05}}),
                                            seen(3, {{1.0, -1.0}, {1.0, 1.0}})};
  const Published published = complete(elements);
  for (const MemorySegment& segment : published.segments) {
    if (segment.id == 1) {
      EXPECT_NEAR(segment.odom.b.x(), 1.0, 1e-3) << "not cut";
    } else if (segment.id == 2) {
      EXPECT_NEAR(segment.odom.a.x(), 1.0, 1e-3) << "goes on";
      EXPECT_NEAR(segment.odom.b.x(), 0.0, 1e-3);
    }
  }
}

TEST(ShapeEdges, CloseNoStripOfShadow) {
  EXPECT_EQ(complete({seen(1, kLower), seen(2, kUpper, false, 30.0)}).segments.size(), 2U);
}

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

TEST(ShapeEdges, WidthsOfFifteenCentimetresAreMeasuredAndGivenToFarLines) {
  std::vector<MemoryElement> elements{seen(1, {{0.0, 0.0}, {2.0, 0.0}}), seen(2, {{2.0, 0.15}, {0.0, 0.15}}),
                                      seen(3, {{0.0, 5.0}, {2.0, 5.0}}), seen(4, {{2.0, 5.12}, {0.0, 5.12}})};
  for (std::size_t i = 2; i < 4; ++i) {
    // Seen from afar: their ends are known to 10 cm only.
    FloorSegment far;
    far.odom = elements[i].line.segment();
    far.P_a = far.P_b = 0.01 * Eigen::Matrix2d::Identity();
    elements[i].line = FloorLine(far, {});
  }
  const auto width = [&](const LineWidthRange& range) {
    std::vector<MemorySegment> segments;
    for (const MemoryElement& element : elements) segments.push_back(element.value);
    LineWidthParams params;
    params.range = range;
    equalizeLineWidths(segments, elements, params);
    return std::abs(segments[3].odom.a.y() - segments[2].odom.a.y());
  };
  EXPECT_NEAR(width({}), 0.12, 1e-6);
  EXPECT_NEAR(width({0.10, 0.20}), 0.15, 1e-6);
}

}  // namespace
}  // namespace vismem
