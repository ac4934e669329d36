// Tests M3, M4, M5, M6.
#include "active_visual_memory/core/memory/segment_memory.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "active_visual_memory/memory_scene.h"
#include "common/geometry/angles.h"
#include "common/geometry/projection.h"

namespace vismem {
namespace {

const std::vector<Segment3> kCross{{{1.0, -0.3, 0}, {1.0, 0.3, 0}}, {{1.2, 0.2, 0}, {1.8, 0.2, 0}}};

TEST(SegmentMemory, RemembersWhatItSawAndPredictsIt) {
  AttentiveVisualMemory memory(standard());
  AttentiveVisualMemory::StepResult result;
  for (int i = 0; i < 5; ++i) {
    const auto o = at(i * 33'333);
    result = memory.update(o, images(o, kCross));
  }
  ASSERT_EQ(result.update.snapshot->segments.size(), 2u);
  EXPECT_EQ(result.update.snapshot->revision, 5u);
  EXPECT_EQ(result.update.analysis->predicted.size(), 2u);
  EXPECT_EQ(result.update.analysis->matches.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_NEAR((result.update.snapshot->segments[i].odom.a - kCross[i].a).norm(), 0.0, 1e-6);
    EXPECT_NEAR((result.update.snapshot->segments[i].odom.b - kCross[i].b).norm(), 0.0, 1e-6);
    EXPECT_EQ(result.update.snapshot->segments[i].label, "edge");
  }
}

TEST(SegmentMemory, StaysStillInTheWorldUnderPureMotion) {
  // The robot drives and turns with its eyes away from what it knows; odom places must not move at all, and
  // back in view the memory predicts them where they are.
  AttentiveVisualMemory memory(standard());
  StampUs t = 0;
  for (int i = 0; i < 5; ++i, t += 33'333) {
    const auto o = at(t);
    memory.update(o, images(o, kCross));
  }
  const Segment3 before = memory.elements()[0].value.odom;
  for (int i = 0; i < 60; ++i, t += 33'333)
    memory.update(at(t, {0.005 * i, 0.0, 0.02 * i}, degToRad(150.0)), {});
  ASSERT_EQ(memory.elements().size(), 2u);
  EXPECT_EQ(memory.elements()[0].value.odom.a, before.a);
  EXPECT_EQ(memory.elements()[0].value.odom.b, before.b);
  const auto o = at(t, {0.1, 0.05, 0.1});
  const auto result = memory.update(o, images(o, kCross));
  EXPECT_EQ(result.update.analysis->matches.size(), 2u);
  EXPECT_EQ(memory.elements().size(), 2u);
}

TEST(SegmentMemory, FragmentsOfAKnownLineDoNotBecomeDuplicates) {
  AttentiveVisualMemory memory(standard());
  const std::vector<Segment3> whole{kCross[0]};
  const std::vector<Segment3> pieces{{{1.0, -0.3, 0}, {1.0, -0.05, 0}}, {{1.0, 0.05, 0}, {1.0, 0.3, 0}}};
  StampUs t = 0;
  for (int i = 0; i < 40; ++i, t += 33'333) {
    const auto o = at(t);
    memory.update(o, images(o, i % 2 ? pieces : whole));
  }
  ASSERT_EQ(memory.elements().size(), 1u);
  EXPECT_NEAR(memory.elements()[0].value.odom.length(), 0.6, 0.01);
}

TEST(SegmentMemory, ALineLongerThanTheImageGrowsAsTheCameraPans) {
  AttentiveVisualMemory memory(standard());
  const std::vector<Segment3> wall{{{1.2, -2.0, 0}, {1.2, 2.0, 0}}};
  StampUs t = 0;
  for (int i = 0; i <= 120; ++i, t += 33'333) {
    const auto o = at(t, {}, degToRad(-60.0 + i));
    memory.update(o, images(o, wall));
  }
  ASSERT_EQ(memory.elements().size(), 1u);
  const MemoryElement& e = memory.elements()[0];
  EXPECT_NEAR(std::abs(e.value.odom.a.y()), 2.0, 0.03);
  EXPECT_NEAR(std::abs(e.value.odom.b.y()), 2.0, 0.03);
  EXPECT_FALSE(e.line.endA().censored);
  EXPECT_FALSE(e.line.endB().censored);
}

TEST(SegmentMemory, ANewEpochSetsTheMemoryAside) {
  AttentiveVisualMemory memory(standard());
  StampUs t = 0;
  for (int i = 0; i < 5; ++i, t += 33'333) {
    const auto o = at(t);
    memory.update(o, images(o, kCross));
  }
  const std::uint64_t last_id = memory.elements().back().value.id;
  auto o = at(t);
  o.epoch = 1;
  const auto result = memory.update(o, images(o, {kCross[0]}));
  ASSERT_EQ(memory.elements().size(), 1u);
  EXPECT_GT(memory.elements()[0].value.id, last_id);
  EXPECT_EQ(result.update.snapshot->epoch, 1u);
}

TEST(SegmentMemory, OnlyTheCacheAroundTheRobotIsPredictedAndTheWholeCollectionStays) {
  AttentiveVisualMemoryParams params = standard();
  params.memory.gates.cache_radius_m = 1.5;
  AttentiveVisualMemory memory(params);
  const std::vector<Segment3> both{{{1.0, -0.3, 0}, {1.0, 0.3, 0}}, {{1.4, -0.3, 0}, {1.4, 0.3, 0}}};
  StampUs t = 0;
  for (int i = 0; i < 5; ++i, t += 33'333) {
    const auto o = at(t);
    memory.update(o, images(o, both));
  }
  // From x = -0.3 the lines lie 1.3 m and 1.7 m away.
  const auto o = at(t, {-0.3, 0.0, 0.0});
  const auto result = memory.update(o, images(o, {both[0]}));
  EXPECT_EQ(result.update.analysis->predicted.size(), 1u);
  EXPECT_EQ(result.update.snapshot->segments.size(), 2u);
}

}  // namespace
}  // namespace vismem
