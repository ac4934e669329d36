// Tests M2.
#include "active_visual_memory/core/memory/duplicates.h"

#include <gtest/gtest.h>

namespace vismem {
namespace {

TEST(Duplicates, OfOneImageAreJoinedOncePerPolarity) {
  FloorSegment a;
  a.place({{0, 0}, {1, 0}});
  a.label = "edge";
  a.strength = 40.0;
  FloorSegment copy = a;
  copy.place({{0.5, 0.01}, {1.2, 0.01}});
  FloorSegment other = a;
  other.place({{0, 0.3}, {1, 0.3}});
  FloorSegment opposite = a;
  opposite.place({{1, 0.01}, {0, 0.01}});
  const auto clean = cleanDuplicates(std::vector<FloorSegment>{a, copy, other, opposite}, 0.06, 0.03, 0.03);
  ASSERT_EQ(clean.size(), 3u) << "the other polarity is another edge";
  EXPECT_NEAR(clean[0].b.p.x(), 1.2, 1e-9);
  EXPECT_NEAR(clean[0].b.p.y(), 0.0, 1e-9);
}

TEST(Antiparallel, SegmentsHaveASignedDistance) {
  const Segment2 one{{0.0, 0.0}, {2.0, 0.0}};
  const auto bright = antiparallel(one, {{1.5, 0.05}, {-0.5, 0.05}}, 0.1);
  ASSERT_TRUE(bright);
  EXPECT_NEAR(bright->left_m, 0.05, 1e-12);
  EXPECT_NEAR(bright->from_m, 0.0, 1e-12);
  EXPECT_NEAR(bright->overlap_m(), 1.5, 1e-12);
  EXPECT_NEAR(antiparallel(one, {{1.5, -0.05}, {-0.5, -0.05}}, 0.1)->left_m, -0.05, 1e-12);
  EXPECT_FALSE(antiparallel(one, {{-0.5, 0.05}, {1.5, 0.05}}, 0.1)) << "the same way";
  EXPECT_FALSE(antiparallel(one, {{3.5, 0.05}, {2.5, 0.05}}, 0.1)) << "one behind the other";
  EXPECT_FALSE(antiparallel(one, {{1.5, 0.5}, {0.5, 0.0}}, 0.1)) << "askew";
}

}  // namespace
}  // namespace vismem
