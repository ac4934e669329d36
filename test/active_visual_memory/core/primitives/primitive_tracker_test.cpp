// Tests M8, M9.
#include "active_visual_memory/core/primitives/primitive_tracker.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "active_visual_memory/synthetic_shapes.h"

namespace vismem {
namespace {

using testing::SyntheticShapes;

const SyntheticShapes::Noise kExact{0.0, 0.0, 0.0, 0.15, false};

PrimitiveTracker::Params memoryParams() {
  return {};
}

TEST(PrimitiveTracker, PublishesAShapeThatStaysAndKeepsItsId) {
  PrimitiveTracker memory(memoryParams());
  SyntheticShapes floor(1, kExact);
  floor.addTriangle({0.0, 0.0}, {0.7, 0.0}, {0.3, 0.5});
  memory.update(0, floor.segments());
  EXPECT_TRUE(memory.published().empty());  // 40 per s * 0.2 s = 8 < 15
  for (StampUs t = 200'000; t <= 2'000'000; t += 200'000) memory.update(t, floor.segments());
  ASSERT_EQ(memory.published().size(), 1u);
  EXPECT_EQ(memory.published()[0].id, 1u);
  EXPECT_EQ(memory.published()[0].kind, PrimitiveKind::kTriangle);
}

TEST(PrimitiveTracker, ForgetsAShapeWithItsSegments) {
  PrimitiveTracker memory(memoryParams());
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

TEST(PrimitiveTracker, AShapeFollowsItsSegmentsWhileItIsNotFound) {
  PrimitiveTracker memory(memoryParams());
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
    // 20 cm and 3 degrees at 2.5 m; the two sides measure all of it but for the small prior on rest.
    EXPECT_LT((after.vertices[i] - transform(all, before.vertices[i])).norm(), 0.003) << i;
  }
}

TEST(PrimitiveTracker, PublishesAHypothesisUntilTheCornerWasSeen) {
  PrimitiveTracker memory(memoryParams());
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

TEST(PrimitiveTracker, DropsACornerThatItsSidesDoNotPointAt) {
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
  PrimitiveTracker memory(memoryParams());
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

TEST(PrimitiveTracker, ReportsThePiecesOfABrokenSide) {
  SyntheticShapes::Noise breaking = kExact;
  breaking.broken = 1.0;
  SyntheticShapes floor(1, breaking);
  floor.addTriangle({0.0, 0.0}, {1.0, 0.0}, {0.4, 0.7});
  ASSERT_EQ(floor.segments().size(), 6u);
  PrimitiveTracker memory(memoryParams());
  for (StampUs t = 0; t <= 1'000'000; t += 200'000) memory.update(t, floor.segments());
  const auto completions = memory.completions(std::pmr::get_default_resource());
  ASSERT_EQ(completions.size(), 3u);
  for (const SideCompletion& c : completions) {
    EXPECT_EQ(c.segments.size(), 2u);
    EXPECT_EQ(c.segments[0] + 1, c.segments[1]);  // the two halves of one side follow each other
  }
}

}  // namespace
}  // namespace vismem
