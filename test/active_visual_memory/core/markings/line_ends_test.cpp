// Tests M9.
#include "active_visual_memory/core/markings/line_ends.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "active_visual_memory/published_elements.h"
#include "common/geometry/angles.h"

namespace vismem {
namespace {

TEST(LineEnds, CloseBothEndsOfAPaintedLine) {
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

TEST(LineEnds, LeaveACensoredEndOpen) {
  EXPECT_EQ(complete({seen(1, kLower, true), seen(2, kUpper)}).segments.size(), 3U);
}

TEST(LineEnds, CloseNoJunction) {
  // Another line meets the right end: its edges begin there.
  const Published published =
      complete({seen(1, kLower), seen(2, kUpper), seen(3, {{1.0, -0.01}, {1.3, -0.4}})});
  EXPECT_EQ(published.segments.size(), 4U) << "only the left end";
}

TEST(LineEnds, PutAnObservedEndSquareToItsLine) {
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

TEST(LineEnds, CloseNoStripOfShadow) {
  EXPECT_EQ(complete({seen(1, kLower), seen(2, kUpper, false, 30.0)}).segments.size(), 2U);
}

TEST(LineEnds, CutAnEdgeThatRunsOnIntoAnotherOneInItsLine) {
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

TEST(LineEnds, CutAnEdgeOfReducedContrast) {
  const Published published = complete({seen(1, {{0.0, 0.0}, {1.3, 0.0}}, false, 45.0), seen(2, kUpper)});
  EXPECT_NEAR(published.segments.front().odom.length(), 1.0, 0.005);
}

TEST(LineEnds, CutAnEdgeOfALineMeasuredTooNarrow) {
  const Published published = complete({seen(1, {{0.0, 0.04}, {1.3, 0.04}}), seen(2, kUpper)});
  EXPECT_NEAR(published.segments.front().odom.length(), 1.0, 0.005);
}

TEST(LineEnds, DoNotCutWhereTheOtherEdgeContinuesOrALineBranchesOff) {
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

TEST(LineEnds, ExtendAnEdgeToTheLineThatTheOtherOneReaches) {
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

}  // namespace
}  // namespace vismem
