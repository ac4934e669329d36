#include "active_visual_memory/core/shape_edges.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "common/geometry/angles.h"

namespace vismem {
namespace {

/// A confirmed element that three images saw from end to end.
MemoryElement seen(std::uint64_t id, const Segment2& line, bool open_b = false, double strength = 100.0) {
  FloorSegment segment;
  segment.odom = line;
  segment.P_a = segment.P_b = 1e-4 * Eigen::Matrix2d::Identity();
  segment.open_b = open_b;
  segment.label = "line";
  MemoryElement element;
  element.value.id = id;
  element.value.label = "line";
  element.value.life = 50.0 + static_cast<double>(id);
  element.line = FloorLine(segment, {});
  for (int i = 0; i < 3; ++i) element.line.fuse(segment, {});
  element.strength = strength;
  publish(element, true, LeanCovariance::Zero());
  return element;
}

struct Published {
  std::vector<MemorySegment> segments;
  std::vector<Primitive> primitives;
};

Published complete(const std::vector<MemoryElement>& elements, std::vector<Primitive> primitives = {}) {
  Published published{{}, std::move(primitives)};
  for (const MemoryElement& element : elements) published.segments.push_back(element.value);
  std::uint64_t next = 1000;
  ShapeEdges shapes({});
  shapes.complete(published.segments, elements, published.primitives, [&] { return next++; });
  return published;
}

// A bright line from (0, 0) to (1, 0), 5 cm wide: its lower edge runs along +x (bright on the left).
const Segment2 kLower{{0.0, 0.0}, {1.0, 0.0}};
const Segment2 kUpper{{1.0, 0.05}, {0.0, 0.05}};

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

TEST(ShapeEdges, LeaveOpenWhatTheImageBorderCut) {
  EXPECT_EQ(complete({seen(1, kLower, true), seen(2, kUpper)}).segments.size(), 3U);
}

TEST(ShapeEdges, CloseNoJunction) {
  // Another line meets the right end: its edges begin there.
  const Published published =
      complete({seen(1, kLower), seen(2, kUpper), seen(3, {{1.0, -0.01}, {1.3, -0.4}})});
  EXPECT_EQ(published.segments.size(), 4U) << "only the left end";
}

TEST(ShapeEdges, CutASideThatRanIntoAnEdgeInItsLine) {
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

TEST(ShapeEdges, DoNotCutWhereTheOtherSideGoesOnOrALineBranchesOff) {
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

TEST(ShapeEdges, CloseNoStripOfShadow) {
  EXPECT_EQ(complete({seen(1, kLower), seen(2, kUpper, false, 30.0)}).segments.size(), 2U);
}

TEST(ShapeEdges, TellACircleInRegularChords) {
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
    publish(elements.back(), i % 2 == 0, LeanCovariance::Zero());
    circle.segments.push_back(elements.back().value.id);
  }
  const Published published = complete(elements, {circle});
  double covered = 0.0;
  for (const MemorySegment& segment : published.segments) {
    EXPECT_GE(segment.id, 1000U) << "the chords found are not told beside the regular ones";
    EXPECT_TRUE(segment.confirmed);
    for (const Eigen::Vector2d& p : {segment.odom.floor().a, segment.odom.floor().middle()}) {
      EXPECT_NEAR(p.norm(), 0.5, 0.011);
    }
    covered += segment.odom.length();
  }
  EXPECT_GT(covered, 0.9 * 2.0 * std::numbers::pi * 0.5);
  EXPECT_EQ(published.primitives[0].segments.size(), published.segments.size());
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

}  // namespace
}  // namespace vismem
