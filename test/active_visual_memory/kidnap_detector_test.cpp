#include "active_visual_memory/core/kidnap_detector.h"

#include <gtest/gtest.h>

namespace vismem {
namespace {

constexpr StampUs kFrame = 100'000;

/// Shows the same scene for so long. @return stamps at which a kidnapping was told.
int told(KidnapDetector& detector, StampUs& now, const SceneAgreement& scene, double seconds) {
  int count = 0;
  for (const StampUs end = now + toStampUs(seconds); now < end; now += kFrame) {
    count += detector.update(now, scene) ? 1 : 0;
  }
  return count;
}

TEST(KidnapDetector, TellsOnceAfterASecondOfAnotherScene) {
  KidnapDetector detector({});
  StampUs now = 0;
  EXPECT_EQ(told(detector, now, {5, 0, 0, 0}, 3.0), 0);
  EXPECT_EQ(told(detector, now, {0, 4, 1, 3}, 0.9), 0);
  EXPECT_EQ(told(detector, now, {0, 4, 1, 3}, 0.3), 1);
}

TEST(KidnapDetector, TakesAnOcclusionForNone) {
  KidnapDetector detector({});
  StampUs now = 0;
  EXPECT_EQ(told(detector, now, {0, 0, 8, 6}, 30.0), 0);
}

// What another robot's outlines pass by looks bare in some images: seen behind one that drove along for 10 s.
TEST(KidnapDetector, TakesAnOcclusionBesideWhichAPlaceLooksBareForNone) {
  KidnapDetector detector({});
  StampUs now = 0;
  for (int i = 0; i < 10; ++i) {
    EXPECT_EQ(told(detector, now, {0, 1, 3, 8}, 0.5), 0);
    EXPECT_EQ(told(detector, now, {0, 2, 2, 11}, 0.5), 0);
    EXPECT_EQ(told(detector, now, {1, 0, 2, 9}, 0.2), 0);
  }
}

TEST(KidnapDetector, TakesTheRemovalOfOneObjectForNone) {
  KidnapDetector detector({});
  StampUs now = 0;
  EXPECT_EQ(told(detector, now, {4, 4, 0, 3}, 30.0), 0);
}

TEST(KidnapDetector, WantsToSeeSomethingNew) {
  KidnapDetector detector({});
  StampUs now = 0;
  EXPECT_EQ(told(detector, now, {0, 8, 0, 1}, 30.0), 0);  // the light went out, say
}

TEST(KidnapDetector, ForgetsDoubtsWhenTheSceneAgreesAgain) {
  KidnapDetector detector({});
  StampUs now = 0;
  for (int i = 0; i < 20; ++i) {
    EXPECT_EQ(told(detector, now, {0, 4, 0, 3}, 0.5), 0);
    EXPECT_EQ(told(detector, now, {4, 0, 0, 0}, 0.7), 0);
  }
}

TEST(KidnapDetector, CountsNoTimeInWhichNothingIsExpected) {
  KidnapDetector detector({});
  StampUs now = 0;
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(told(detector, now, {0, 4, 0, 3}, 0.4), 0);
    EXPECT_EQ(told(detector, now, {0, 0, 0, 3}, 5.0), 0);
  }
  EXPECT_EQ(told(detector, now, {0, 4, 0, 3}, 0.5), 1);  // 0.4 + 0.4 s before
}

// Elements of the new place must not settle the doubt whether this is the old one.
TEST(KidnapDetector, TellsSinceWhenItDoubts) {
  KidnapDetector detector({});
  StampUs now = 0;
  told(detector, now, {5, 0, 0, 0}, 1.0);
  EXPECT_EQ(detector.doubtSince(), std::nullopt);
  const StampUs agreed = now - kFrame;
  told(detector, now, {0, 4, 1, 3}, 0.5);
  EXPECT_EQ(detector.doubtSince(), agreed);
  told(detector, now, {0, 0, 0, 3}, 20.0);
  EXPECT_EQ(detector.doubtSince(), agreed);
  told(detector, now, {5, 0, 0, 0}, 1.0);
  EXPECT_EQ(detector.doubtSince(), std::nullopt);
}

TEST(KidnapDetector, DropsDoubtsThatNothingSettles) {
  KidnapDetector detector({});
  StampUs now = 0;
  told(detector, now, {5, 0, 0, 0}, 1.0);
  told(detector, now, {0, 4, 1, 3}, 0.5);
  told(detector, now, {0, 0, 0, 3}, 40.0);
  EXPECT_EQ(detector.doubtSince(), std::nullopt);
  EXPECT_EQ(detector.evidence_s(), 0.0);
}

TEST(KidnapDetector, CanBeOff) {
  KidnapDetector::Params off;
  off.enabled = false;
  KidnapDetector detector(off);
  StampUs now = 0;
  EXPECT_EQ(told(detector, now, {0, 8, 0, 8}, 30.0), 0);
}

}  // namespace
}  // namespace vismem
