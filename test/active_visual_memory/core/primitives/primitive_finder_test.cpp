// Tests M8, M9.
#include "active_visual_memory/core/primitives/primitive_finder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <map>

#include "active_visual_memory/floor_edges.h"
#include "active_visual_memory/synthetic_shapes.h"

namespace vismem {
namespace {

using testing::isNearShape;
using testing::scratch;
using testing::SyntheticShapes;

const SyntheticShapes::Noise kExact{0.0, 0.0, 0.0, 0.15, false};

TEST(FindPrimitives, ReadsARectangleFromItsFourSides) {
  SyntheticShapes floor(1, kExact);
  // Corners (0,0) (0.6,0) (0.6,0.4) (0,0.4): longer side 0.6 along x, centre (0.3, 0.2).
  floor.addParallelogram({0.0, 0.0}, {0.6, 0.0}, {0.0, 0.4});
  const auto found = findPrimitives(floor.segments(), {}, scratch());
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].kind, PrimitiveKind::kParallelogram);
  EXPECT_NEAR((found[0].centre - Eigen::Vector2d(0.3, 0.2)).norm(), 0.0, 1e-9);
  EXPECT_NEAR(found[0].length_m, 0.6, 1e-9);
  EXPECT_NEAR(found[0].width_m, 0.4, 1e-9);
  EXPECT_NEAR(std::sin(found[0].heading_rad), 0.0, 1e-9);
  EXPECT_EQ(found[0].hidden_vertex, -1);
  EXPECT_EQ(testing::listed(found[0].segments), (std::vector<std::uint64_t>{1, 2, 3, 4}));
}

TEST(FindPrimitives, ThreeCornersGiveTheFourth) {
  SyntheticShapes::Noise hiding = kExact;
  hiding.hide_a_corner = true;
  SyntheticShapes floor(3, hiding);
  floor.addParallelogram({0.0, 0.0}, {0.8, 0.1}, {0.2, 0.6});
  const auto found = findPrimitives(floor.segments(), {}, scratch());
  ASSERT_EQ(found.size(), 1u);
  ASSERT_GE(found[0].hidden_vertex, 0);
  const Eigen::Vector2d hidden =
      floor.truth()[0].vertices[static_cast<std::size_t>(floor.truth()[0].hidden_vertex)];
  EXPECT_LT((found[0].vertices[static_cast<std::size_t>(found[0].hidden_vertex)] - hidden).norm(), 1e-9);
}

TEST(FindPrimitives, SidesOfOppositePolarityMakeNoShape) {
  SyntheticShapes floor(1, kExact);
  floor.addParallelogram({0.0, 0.0}, {0.6, 0.0}, {0.0, 0.4});
  std::vector<MemorySegment> segments = floor.segments();
  std::swap(segments[0].odom.a, segments[0].odom.b);
  EXPECT_TRUE(findPrimitives(segments, {}, scratch()).empty());
}

TEST(FindPrimitives, UnconfirmedSegmentsMakeNoShape) {
  SyntheticShapes floor(1, kExact);
  floor.addParallelogram({0.0, 0.0}, {0.6, 0.0}, {0.0, 0.4});
  std::vector<MemorySegment> segments = floor.segments();
  for (MemorySegment& segment : segments) segment.label = "marking";
  const auto found = [&] { return findPrimitives(segments, {}, scratch()).size(); };
  EXPECT_EQ(found(), 1u);
  segments[1].confirmed = false;
  EXPECT_EQ(found(), 0u);
  PrimitiveParams all;
  all.confirmed_only = false;
  EXPECT_EQ(findPrimitives(segments, all, scratch()).size(), 1u);
}

TEST(FindPrimitives, ReadsBothSidesOfAPaintedCircleAsOne) {
  SyntheticShapes floor(1, kExact);
  floor.addCircle({1.0, -2.0}, 0.6, 0.05, 0.25, 1.0);
  const auto found = findPrimitives(floor.segments(), {}, scratch());
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].kind, PrimitiveKind::kCircle);
  EXPECT_NEAR((found[0].centre - Eigen::Vector2d(1.0, -2.0)).norm(), 0.0, 0.002);
  EXPECT_NEAR(found[0].radius_m, 0.6, 0.003);
  EXPECT_NEAR(found[0].width_m, 0.05, 0.003);
}

TEST(FindPrimitives, PointsTheArrowWhereItPoints) {
  SyntheticShapes floor(1, kExact);
  floor.addArrow({0.0, 0.0}, 0.5, 0.8, 0.3, 0.7, 0.05);
  const auto found = findPrimitives(floor.segments(), {}, scratch());
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].kind, PrimitiveKind::kArrow);
  EXPECT_NEAR(found[0].heading_rad, 0.5, 0.02);
  EXPECT_TRUE(isNearShape(found[0], floor.truth()[0], 0.08));
}

TEST(FindPrimitives, NothingMakesNothing) {
  EXPECT_TRUE(findPrimitives({}, {}, scratch()).empty());
  std::vector<MemorySegment> point(1);
  point[0].confirmed = true;  // no extent
  EXPECT_TRUE(findPrimitives(point, {}, scratch()).empty());
}

struct Tally {
  int truths = 0;
  int found = 0;
  int reported = 0;
  int wrong = 0;
};

/// Over rooms of several seeds. Stripes are counted by themselves: they are parts, not shapes.
std::map<PrimitiveKind, Tally> tally(const SyntheticShapes::Noise& noise, int seeds) {
  std::map<PrimitiveKind, Tally> tallies;
  for (int seed = 1; seed <= seeds; ++seed) {
    const SyntheticShapes room = SyntheticShapes::room(static_cast<std::uint64_t>(seed), noise);
    const auto found = findPrimitives(room.segments(), {}, scratch());
    for (const Primitive& truth : room.truth()) {
      Tally& t = tallies[truth.kind];
      ++t.truths;
      t.found += std::any_of(found.begin(), found.end(),
                             [&](const Primitive& f) { return isNearShape(f, truth, 0.10); });
    }
    for (const Primitive& f : found) {
      Tally& t = tallies[f.kind];
      ++t.reported;
      t.wrong += std::none_of(room.truth().begin(), room.truth().end(),
                              [&](const Primitive& truth) { return isNearShape(f, truth, 0.15); });
    }
  }
  return tallies;
}

void expectGoals(const std::map<PrimitiveKind, Tally>& tallies) {
  int reported = 0;
  int wrong = 0;
  for (const auto& [kind, t] : tallies) {
    if (kind == PrimitiveKind::kStripe) continue;
    std::printf("kind %d: %d of %d found, %d reported, %d wrong\n", static_cast<int>(kind), t.found, t.truths,
                t.reported, t.wrong);
    EXPECT_GE(t.found, 0.95 * t.truths) << "kind " << static_cast<int>(kind);
    reported += t.reported;
    wrong += t.wrong;
  }
  EXPECT_LE(wrong, 0.02 * reported);
}

TEST(FindPrimitives, FindsTheShapesOfNoisyRoomsAndFewOthers) {
  expectGoals(tally({}, 200));
}

TEST(FindPrimitives, FindsThemWithACornerHidden) {
  SyntheticShapes::Noise noise;
  noise.hide_a_corner = true;
  expectGoals(tally(noise, 200));
}

TEST(FindPrimitives, DoesNotDependOnTheOrderOfTheMemory) {
  const SyntheticShapes room = SyntheticShapes::room(5, {});
  std::vector<MemorySegment> turned = room.segments();
  std::reverse(turned.begin(), turned.end());
  const auto a = findPrimitives(room.segments(), {}, scratch());
  const auto b = findPrimitives(turned, {}, scratch());
  ASSERT_EQ(a.size(), b.size());
  for (const Primitive& shape : a) {
    EXPECT_TRUE(std::any_of(b.begin(), b.end(), [&](const Primitive& other) {
      return other.kind == shape.kind && (other.centre - shape.centre).norm() < 0.01;
    }));
  }
}

}  // namespace
}  // namespace vismem
