// Tests M4.
#include "active_visual_memory/core/memory/life.h"

#include <gtest/gtest.h>

#include <random>

#include "active_visual_memory/core/attentive_visual_memory.h"

namespace vismem {
namespace {

const LifeParams kChapter = AttentiveVisualMemoryParams::chapter().memory.retention.life;
const LifeParams kDefault = AttentiveVisualMemoryParams::standard().memory.retention.life;

TEST(Life, ChapterGainsTwentyPerTickAndLosesOne) {
  EXPECT_DOUBLE_EQ(agedLife(50, Sighting::kObserved, 0.2, kChapter), 70.0);
  EXPECT_DOUBLE_EQ(agedLife(90, Sighting::kObserved, 0.2, kChapter), 100.0);
  for (const Sighting s : {Sighting::kAbsent, Sighting::kOutOfView, Sighting::kOccluded}) {
    EXPECT_DOUBLE_EQ(agedLife(50, s, 0.2, kChapter), 49.0);
  }
}

TEST(Life, DefaultForgetsTheAbsentWithinTwoSecondsAndTheUnseenAfterTwentyOrMore) {
  const auto lasts = [](Sighting sighting) {
    double life = kDefault.maximum;
    double seconds = 0.0;
    while (life >= kDefault.threshold && seconds < 300.0) {
      life = agedLife(life, sighting, 1.0 / 30, kDefault);
      seconds += 1.0 / 30;
    }
    return seconds;
  };
  EXPECT_LT(lasts(Sighting::kAbsent), 2.0);
  EXPECT_GT(lasts(Sighting::kOutOfView), 20.0);
  EXPECT_GE(lasts(Sighting::kOccluded), 300.0) << "frozen";
}

TEST(Life, StaysInItsRange) {
  std::mt19937_64 random(1);
  for (const LifeParams& params : {kChapter, kDefault}) {
    double life = params.initial;
    for (int i = 0; i < 10000; ++i) {
      life = agedLife(life, static_cast<Sighting>(random() % 4), (random() % 1000) * 1e-3, params);
      ASSERT_GE(life, 0.0);
      ASSERT_LE(life, params.maximum);
    }
  }
}

TEST(Life, ClockCountsTicksWhateverTheFrameRate) {
  for (const StampUs frame_us : {33'333, 50'000, 130'000}) {
    LifeClock clock(200'000);
    double counted = 0.0;
    for (StampUs t = 5; t <= 10 * kSecondUs; t += frame_us) counted += clock.advance(t);
    EXPECT_NEAR(counted, 10.0, 0.35) << frame_us;
  }
}

TEST(Life, UncertaintyIsItsInverse) {
  EXPECT_DOUBLE_EQ(uncertaintyOf(100.0), 0.01);
  EXPECT_TRUE(std::isinf(uncertaintyOf(0.0)));
}

}  // namespace
}  // namespace vismem
