// Tests M8.
#include "active_visual_memory/core/primitives/floor_edge.h"

#include <gtest/gtest.h>

namespace vismem {
namespace {

TEST(FloorEdge, IsMadeOfASegmentOfSomeLength) {
  const auto edge = makeFloorEdge({{1.0, 1.0}, {4.0, 5.0}}, "line", {7});
  ASSERT_TRUE(edge);
  EXPECT_DOUBLE_EQ(edge->length, 5.0);
  EXPECT_TRUE(edge->along.isApprox(Eigen::Vector2d(0.6, 0.8)));
  EXPECT_TRUE(edge->inward(0).isApprox(edge->along));
  EXPECT_TRUE(edge->inward(1).isApprox(-edge->along));
  EXPECT_FALSE(edge->isStripe());
  EXPECT_FALSE(makeFloorEdge({{1.0, 1.0}, {1.0, 1.0}}, "line", {7}));
}

TEST(FloorEdge, IntersectionIsThatOfTheInfiniteLines) {
  const auto a = *makeFloorEdge({{0.0, 0.0}, {1.0, 0.0}}, "line", {1});
  const auto b = *makeFloorEdge({{3.0, -2.0}, {3.0, -1.0}}, "line", {2});
  const auto point = intersection(a, b);
  ASSERT_TRUE(point);
  EXPECT_TRUE(point->isApprox(Eigen::Vector2d(3.0, 0.0)));
  const auto parallel = *makeFloorEdge({{0.0, 1.0}, {1.0, 1.005}}, "line", {3});
  EXPECT_FALSE(intersection(a, parallel)) << "0.005 rad";
}

TEST(FloorEdge, IdsAreJoinedSortedAndCompared) {
  EXPECT_EQ(joinedIds({1, 4, 9}, {2, 4}), (std::vector<std::uint64_t>{1, 2, 4, 9}));
  EXPECT_TRUE(shareIds({1, 4, 9}, {2, 4}));
  EXPECT_FALSE(shareIds({1, 5, 9}, {2, 4}));
  EXPECT_FALSE(shareIds({}, {2, 4}));
}

TEST(FloorEdge, ConfirmedOnlyLeavesOutTheRest) {
  MemorySegment confirmed;
  confirmed.id = 1;
  confirmed.confirmed = true;
  confirmed.odom = {{0, 0, 0}, {1, 0, 0}};
  MemorySegment other = confirmed;
  other.id = 2;
  other.confirmed = false;
  const std::vector<MemorySegment> segments{confirmed, other};
  EXPECT_EQ(floorEdges(segments, true).size(), 1U);
  ASSERT_EQ(floorEdges(segments, false).size(), 2U);
  EXPECT_EQ(floorEdges(segments, false)[1].segments, (std::vector<std::uint64_t>{2}));
}

}  // namespace
}  // namespace vismem
