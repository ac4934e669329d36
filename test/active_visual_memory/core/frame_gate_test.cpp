// Tests V6.
#include "active_visual_memory/core/frame_gate.h"

#include <gtest/gtest.h>

#include "active_visual_memory/memory_scene.h"

namespace vismem {
namespace {

TEST(FrameGate, OpensOnMotionTurnAndTime) {
  FrameGate::Params p;
  p.enabled = true;
  FrameGate gate(p);
  EXPECT_TRUE(gate.opens(at(0)));
  gate.passed(at(0));
  EXPECT_FALSE(gate.opens(at(33'333)));
  EXPECT_TRUE(gate.opens(at(33'333, {0.03, 0, 0})));
  EXPECT_TRUE(gate.opens(at(33'333, {}, 0.03)));
  EXPECT_TRUE(gate.opens(at(200'000)));
  p.enabled = false;
  EXPECT_TRUE(FrameGate(p).opens(at(33'333)));
}

TEST(FrameGate, AFrameThatIsNotAnalysedKeepsTheRevision) {
  AttentiveVisualMemory memory(standard());
  const auto first = memory.update(at(0), {});
  const auto between = memory.predict(at(33'333));
  EXPECT_EQ(between.update.snapshot, first.update.snapshot);
  EXPECT_EQ(memory.update(at(66'666), {}).update.snapshot->revision, 2u);
}

}  // namespace
}  // namespace vismem
