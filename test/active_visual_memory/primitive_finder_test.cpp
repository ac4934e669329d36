#include "active_visual_memory/core/primitive_finder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <map>

#include "active_visual_memory/core/primitive_memory.h"
#include "active_visual_memory/synthetic_shapes.h"

namespace vismem {
namespace {

using testing::isNearShape;
using testing::SyntheticShapes;

const SyntheticShapes::Noise kExact{0.0, 0.0, 0.0, 0.15, false};

TEST(FindPrimitives, ReadsARectangleFromItsFourSides) {
  SyntheticShapes floor(1, kExact);
  // Corners (0,0) (0.6,0) (0.6,0.4) (0,0.4): longer side 0.6 along x, centre (0.3, 0.2).
  floor.addParallelogram({0.0, 0.0}, {0.6, 0.0}, {0.0, 0.4});
  const auto found = findPrimitives(floor.segments(), {});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].kind, PrimitiveKind::kParallelogram);
  EXPECT_NEAR((found[0].centre - Eigen::Vector2d(0.3, 0.2)).norm(), 0.0, 1e-9);
  EXPECT_NEAR(found[0].length_m, 0.6, 1e-9);
  EXPECT_NEAR(found[0].width_m, 0.4, 1e-9);
  EXPECT_NEAR(std::sin(found[0].heading_rad), 0.0, 1e-9);
  EXPECT_EQ(found[0].hidden_vertex, -1);
  EXPECT_EQ(found[0].segments, (std::vector<std::uint64_t>{1, 2, 3, 4}));
}

TEST(FindPrimitives, ThreeCornersGiveTheFourth) {
  SyntheticShapes::Noise hiding = kExact;
  hiding.hide_a_corner = true;
  SyntheticShapes floor(3, hiding);
  floor.addParallelogram({0.0, 0.0}, {0.8, 0.1}, {0.2, 0.6});
  const auto found = findPrimitives(floor.segments(), {});
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
  EXPECT_TRUE(findPrimitives(segments, {}).empty());
}

TEST(FindPrimitives, WhatMayStandUpMakesNoShapeByItself) {
  SyntheticShapes floor(1, kExact);
  floor.addParallelogram({0.0, 0.0}, {0.6, 0.0}, {0.0, 0.4});
  std::vector<MemorySegment> segments = floor.segments();
  for (MemorySegment& segment : segments) segment.label = "marking";
  const auto found = [&] { return findPrimitives(segments, {}).size(); };
  // 0.6 + 0.4 + 0.6 m of 2 m are confirmed: the fourth side is where what stands up would not be.
  segments[1].confirmed = false;
  EXPECT_EQ(found(), 1u);
  // A shadow or a pattern may lie anywhere.
  segments[1].label = kUnknownLabel;
  EXPECT_EQ(found(), 0u);
  segments[1].label = "marking";
  // 0.4 + 0.4 m of 2 m.
  segments[1].confirmed = true;
  segments[0].confirmed = segments[2].confirmed = false;
  EXPECT_EQ(found(), 0u);
  PrimitiveParams all;
  all.confirmed_only = false;
  EXPECT_EQ(findPrimitives(segments, all).size(), 1u);
}

TEST(FindPrimitives, ReadsBothSidesOfAPaintedCircleAsOne) {
  SyntheticShapes floor(1, kExact);
  floor.addCircle({1.0, -2.0}, 0.6, 0.05, 0.25, 1.0);
  const auto found = findPrimitives(floor.segments(), {});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].kind, PrimitiveKind::kCircle);
  EXPECT_NEAR((found[0].centre - Eigen::Vector2d(1.0, -2.0)).norm(), 0.0, 0.002);
  EXPECT_NEAR(found[0].radius_m, 0.6, 0.003);
  EXPECT_NEAR(found[0].width_m, 0.05, 0.003);
}

TEST(FindPrimitives, PointsTheArrowWhereItPoints) {
  SyntheticShapes floor(1, kExact);
  floor.addArrow({0.0, 0.0}, 0.5, 0.8, 0.3, 0.7, 0.05);
  const auto found = findPrimitives(floor.segments(), {});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].kind, PrimitiveKind::kArrow);
  EXPECT_NEAR(found[0].heading_rad, 0.5, 0.02);
  EXPECT_TRUE(isNearShape(found[0], floor.truth()[0], 0.08));
}

TEST(FindPrimitives, NothingMakesNothing) {
  EXPECT_TRUE(findPrimitives({}, {}).empty());
  std::vector<MemorySegment> point(1);
  point[0].confirmed = true;  // no extent
  EXPECT_TRUE(findPrimitives(point, {}).empty());
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
    const auto found = findPrimitives(room.segments(), {});
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

TEST(FindPrimitives, FindsTheShapesOfNoisyRoomsAndHardlyOthers) {
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
  const auto a = findPrimitives(room.segments(), {});
  const auto b = findPrimitives(turned, {});
  ASSERT_EQ(a.size(), b.size());
  for (const Primitive& shape : a) {
    EXPECT_TRUE(std::any_of(b.begin(), b.end(), [&](const Primitive& other) {
      return other.kind == shape.kind && (other.centre - shape.centre).norm() < 0.01;
    }));
  }
}

PrimitiveMemory::Params memoryParams() {
  return {};
}

TEST(PrimitiveMemory, PublishesAShapeThatStaysAndKeepsItsId) {
  PrimitiveMemory memory(memoryParams());
  SyntheticShapes floor(1, kExact);
  floor.addTriangle({0.0, 0.0}, {0.7, 0.0}, {0.3, 0.5});
  memory.update(0, floor.segments());
  EXPECT_TRUE(memory.published().empty());  // 40 per s * 0.2 s = 8 < 15
  for (StampUs t = 200'000; t <= 2'000'000; t += 200'000) memory.update(t, floor.segments());
  ASSERT_EQ(memory.published().size(), 1u);
  EXPECT_EQ(memory.published()[0].id, 1u);
  EXPECT_EQ(memory.published()[0].kind, PrimitiveKind::kTriangle);
}

TEST(PrimitiveMemory, ForgetsAShapeWithItsSegments) {
  PrimitiveMemory memory(memoryParams());
  SyntheticShapes floor(1, kExact);
  floor.addTriangle({0.0, 0.0}, {0.7, 0.0}, {0.3, 0.5});
  StampUs t = 0;
  for (; t <= 2'000'000; t += 200'000) memory.update(t, floor.segments());
  ASSERT_EQ(memory.published().size(), 1u);
  // One side lost, two remain: the shape is frozen.
  std::vector<MemorySegment> two = floor.segments();
  two.pop_back();
  const double life = memory.published()[0].life;
  for (const StampUs end = t + 2'000'000; t <= end; t += 200'000) memory.update(t, two);
  ASSERT_EQ(memory.published().size(), 1u);
  EXPECT_DOUBLE_EQ(memory.published()[0].life, life);
  // All lost: at most 100 life at 25 per second.
  for (const StampUs end = t + 4'200'000; t <= end; t += 200'000) memory.update(t, {});
  EXPECT_TRUE(memory.published().empty());
}

TEST(PrimitiveMemory, AShapeGoesWhereItsSegmentsGoWhileItIsNotFound) {
  PrimitiveMemory memory(memoryParams());
  SyntheticShapes floor(1, kExact);
  floor.addTriangle({1.0, 2.0}, {1.7, 2.0}, {1.3, 2.5});
  StampUs t = 0;
  for (; t <= 2'000'000; t += 200'000) memory.update(t, floor.segments());
  const Primitive before = memory.published().at(0);
  // The memory turns by 3 degrees about the origin and moves, in steps, with one side lost and one that shows
  // only half of itself: no triangle is found.
  std::vector<MemorySegment> segments = floor.segments();
  segments.pop_back();
  segments[0].odom.b = segments[0].odom.middle();
  const Pose2 step{0.02, -0.01, 0.0052};
  Pose2 all{};
  for (int i = 0; i < 10; ++i, t += 200'000) {
    for (MemorySegment& segment : segments) segment.odom = transform(step, segment.odom);
    all = step * all;
    memory.update(t, segments);
  }
  ASSERT_EQ(memory.published().size(), 1u);
  const Primitive after = memory.published()[0];
  for (std::size_t i = 0; i < 3; ++i) {
    // 20 cm and 3 degrees at 2.5 m; the two sides tell all of it but for the little weight on rest.
    EXPECT_LT((after.vertices[i] - transform(all, before.vertices[i])).norm(), 0.003) << i;
  }
}

TEST(PrimitiveMemory, AsksForAHiddenCornerUntilItWasSeen) {
  PrimitiveMemory memory(memoryParams());
  SyntheticShapes::Noise hiding = kExact;
  hiding.hide_a_corner = true;
  SyntheticShapes partly(3, hiding);
  partly.addParallelogram({0.0, 0.0}, {0.8, 0.1}, {0.2, 0.6});
  StampUs t = 0;
  for (; t <= 1'000'000; t += 200'000) memory.update(t, partly.segments());
  ASSERT_EQ(memory.hypotheses().size(), 1u);
  const Eigen::Vector2d hidden =
      partly.truth()[0].vertices[static_cast<std::size_t>(partly.truth()[0].hidden_vertex)];
  EXPECT_LT((memory.hypotheses()[0].p_odom - hidden).norm(), 1e-6);

  SyntheticShapes whole(3, kExact);
  whole.addParallelogram({0.0, 0.0}, {0.8, 0.1}, {0.2, 0.6});
  memory.update(t, whole.segments());
  EXPECT_TRUE(memory.hypotheses().empty());
  ASSERT_EQ(memory.published().size(), 1u);
  EXPECT_EQ(memory.published()[0].id, 1u);
  // Hidden again: what was seen stays known.
  for (const StampUs end = t + 1'000'000; t <= end; t += 200'000) memory.update(t, partly.segments());
  EXPECT_TRUE(memory.hypotheses().empty());
}

TEST(PrimitiveMemory, TakesBackACornerThatItsSidesDoNotPointAt) {
  SyntheticShapes floor(1, kExact);
  floor.addParallelogram({0.0, 0.0}, {0.8, 0.0}, {0.2, 0.9});
  const Eigen::Vector3d corner{1.0, 0.9, 0.0};
  const auto withCorner = [&](const std::function<Eigen::Vector3d(const Eigen::Vector3d&)>& seen_from) {
    std::vector<MemorySegment> segments = floor.segments();
    int ends = 0;
    for (MemorySegment& segment : segments) {
      for (auto [end, other] :
           {std::pair{&segment.odom.a, segment.odom.b}, {&segment.odom.b, segment.odom.a}}) {
        if ((*end - corner).norm() > 1e-6) continue;
        *end = seen_from(other);
        ++ends;
      }
    }
    EXPECT_EQ(ends, 2);
    return segments;
  };
  // The foot of what hides the corner was taken for a piece of one side, whose line was turned by that: both
  // sides met 10 cm beside the corner.
  PrimitiveMemory memory(memoryParams());
  const auto wrong = withCorner([](const Eigen::Vector3d&) { return Eigen::Vector3d(0.9, 0.9, 0.0); });
  StampUs t = 0;
  for (; t <= 2'000'000; t += 200'000) memory.update(t, wrong);
  ASSERT_EQ(memory.published().size(), 1u);
  ASSERT_EQ(memory.published()[0].hidden_vertex, -1);
  // Now both sides end where they are hidden, and point at the corner.
  const auto right = withCorner([&](const Eigen::Vector3d& other) {
    return Eigen::Vector3d(corner + 0.25 * (other - corner).normalized());
  });
  for (const StampUs end = t + 3'000'000; t <= end; t += 200'000) memory.update(t, right);
  ASSERT_EQ(memory.hypotheses().size(), 1u);
  EXPECT_LT((memory.hypotheses()[0].p_odom - corner.head<2>()).norm(), 0.01);
}

TEST(PrimitiveMemory, NamesThePiecesOfABrokenSide) {
  SyntheticShapes::Noise breaking = kExact;
  breaking.broken = 1.0;
  SyntheticShapes floor(1, breaking);
  floor.addTriangle({0.0, 0.0}, {1.0, 0.0}, {0.4, 0.7});
  ASSERT_EQ(floor.segments().size(), 6u);
  PrimitiveMemory memory(memoryParams());
  for (StampUs t = 0; t <= 1'000'000; t += 200'000) memory.update(t, floor.segments());
  const auto completions = memory.completions(floor.segments());
  ASSERT_EQ(completions.size(), 3u);
  for (const SideCompletion& c : completions) {
    EXPECT_EQ(c.segments.size(), 2u);
    EXPECT_EQ(c.segments[0] + 1, c.segments[1]);  // the two halves of one side follow each other
  }
}

}  // namespace
}  // namespace vismem
