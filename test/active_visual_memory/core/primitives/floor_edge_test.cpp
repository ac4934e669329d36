// Tests M8.
#include "active_visual_memory/core/primitives/floor_edge.h"

#include <gtest/gtest.h>

#include "active_visual_memory/floor_edges.h"

namespace vismem {
namespace {

using testing::edge;
using testing::listed;
using testing::scratch;

TEST(FloorEdge, IsMadeOfASegmentOfSomeLength) {
  const auto edge = makeFloorEdge({{1.0, 1.0}, {4.0, 5.0}}, "line", {});
  ASSERT_TRUE(edge);
  EXPECT_DOUBLE_EQ(edge->length, 5.0);
  EXPECT_TRUE(edge->along.isApprox(Eigen::Vector2d(0.6, 0.8)));
  EXPECT_TRUE(edge->inward(0).isApprox(edge->along));
  EXPECT_TRUE(edge->inward(1).isApprox(-edge->along));
  EXPECT_FALSE(edge->isStripe());
  EXPECT_FALSE(makeFloorEdge({{1.0, 1.0}, {1.0, 1.0}}, "line", {}));
}

TEST(FloorEdge, IntersectionIsThatOfTheInfiniteLines) {
  const auto a = edge(1, {{0.0, 0.0}, {1.0, 0.0}});
  const auto b = edge(2, {{3.0, -2.0}, {3.0, -1.0}});
  const auto point = intersection(a, b);
  ASSERT_TRUE(point);
  EXPECT_TRUE(point->isApprox(Eigen::Vector2d(3.0, 0.0)));
  const auto parallel = edge(3, {{0.0, 1.0}, {1.0, 1.005}});
  EXPECT_FALSE(intersection(a, parallel)) << "0.005 rad";
}

TEST(FloorEdge, IdsAreJoinedSortedAndCompared) {
  const std::vector<std::uint64_t> three{1, 4, 9};
  const std::vector<std::uint64_t> others{1, 5, 9};
  const std::vector<std::uint64_t> two{2, 4};
  EXPECT_EQ(listed(joinedIds(three, two, scratch())), (std::vector<std::uint64_t>{1, 2, 4, 9}));
  EXPECT_TRUE(shareIds(three, two));
  EXPECT_FALSE(shareIds(others, two));
  EXPECT_FALSE(shareIds({}, two));
}

TEST(FloorEdge, UnconfirmedSegmentsAreLeftOut) {
  MemorySegment confirmed;
  confirmed.id = 1;
  confirmed.confirmed = true;
  confirmed.odom = {{0, 0, 0}, {1, 0, 0}};
  MemorySegment other = confirmed;
  other.id = 2;
  other.confirmed = false;
  const std::vector<MemorySegment> segments{other, confirmed};
  const auto kept = [&](bool confirmed_only) { return floorEdges(segments, confirmed_only, scratch()); };
  EXPECT_EQ(kept(false).size(), 2U);
  ASSERT_EQ(kept(true).size(), 1U);
  EXPECT_EQ(listed(kept(true)[0].segments), (std::vector<std::uint64_t>{1}));
}

}  // namespace
}  // namespace vismem
