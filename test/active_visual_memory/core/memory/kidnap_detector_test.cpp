// Tests M10.
#include "active_visual_memory/core/memory/kidnap_detector.h"

#include <gtest/gtest.h>

namespace vismem {
namespace {

constexpr StampUs kFrame = 100'000;

/// Shows one scene for a time. @return number of reported kidnappings.
int reports(KidnapDetector& detector, StampUs& now, const SceneAgreement& scene, double seconds) {
  int count = 0;
  for (const StampUs end = now + toStampUs(seconds); now < end; now += kFrame) {
    count += detector.update(now, scene) ? 1 : 0;
  }
  return count;
}

TEST(KidnapDetector, ReportsOnceAndSoonerTheMoreIsAbsent) {
  KidnapDetector detector({});
  StampUs now = 0;
  EXPECT_EQ(reports(detector, now, {5, 0, 0, 0}, 3.0), 0);
  EXPECT_EQ(reports(detector, now, {0, 2, 1, 3}, 0.9), 0);
  EXPECT_EQ(reports(detector, now, {0, 2, 1, 3}, 0.3), 1);
  EXPECT_EQ(reports(detector, now, {5, 0, 0, 0}, 3.0), 0);
  EXPECT_EQ(reports(detector, now, {0, 8, 1, 3}, 0.5), 0);
  EXPECT_EQ(reports(detector, now, {0, 8, 1, 3}, 0.2), 1);
}

TEST(KidnapDetector, IgnoresAnOcclusion) {
  KidnapDetector detector({});
  StampUs now = 0;
  EXPECT_EQ(reports(detector, now, {0, 0, 8, 6}, 30.0), 0);
}

// Places that another robot's outline passes look free in some images: seen behind one that drove along for
// 10 s.
TEST(KidnapDetector, IgnoresAnOcclusionWithOneFreePlace) {
  KidnapDetector detector({});
  StampUs now = 0;
  for (int i = 0; i < 10; ++i) {
    EXPECT_EQ(reports(detector, now, {0, 1, 3, 8}, 0.5), 0);
    EXPECT_EQ(reports(detector, now, {0, 2, 2, 11}, 0.5), 0);
    EXPECT_EQ(reports(detector, now, {1, 0, 2, 9}, 0.2), 0);
  }
}

TEST(KidnapDetector, IgnoresTheRemovalOfOneObject) {
  KidnapDetector detector({});
  StampUs now = 0;
  EXPECT_EQ(reports(detector, now, {4, 4, 0, 3}, 30.0), 0);
}

TEST(KidnapDetector, NeedsNewSegments) {
  KidnapDetector detector({});
  StampUs now = 0;
  EXPECT_EQ(reports(detector, now, {0, 8, 0, 1}, 30.0), 0);  // the light went out, say
}

TEST(KidnapDetector, DropsASuspicionWhenTheSceneAgreesAgain) {
  KidnapDetector detector({});
  StampUs now = 0;
  for (int i = 0; i < 20; ++i) {
    EXPECT_EQ(reports(detector, now, {0, 2, 0, 3}, 0.5), 0);
    EXPECT_EQ(reports(detector, now, {4, 0, 0, 0}, 0.7), 0);
  }
}

TEST(KidnapDetector, CountsNoTimeInWhichNothingIsExpected) {
  KidnapDetector detector({});
  StampUs now = 0;
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(reports(detector, now, {0, 2, 0, 3}, 0.4), 0);
    EXPECT_EQ(reports(detector, now, {0, 0, 0, 3}, 5.0), 0);
  }
  EXPECT_EQ(reports(detector, now, {0, 2, 0, 3}, 0.5), 1);  // 0.4 + 0.4 s before
}

// A match with elements of the new place must not end the suspicion that it is new.
TEST(KidnapDetector, ReportsTheBeginningOfItsSuspicion) {
  KidnapDetector detector({});
  StampUs now = 0;
  reports(detector, now, {5, 0, 0, 0}, 1.0);
  EXPECT_EQ(detector.suspectSince(), std::nullopt);
  const StampUs agreed = now - kFrame;
  reports(detector, now, {0, 2, 1, 3}, 0.5);
  EXPECT_EQ(detector.suspectSince(), agreed);
  reports(detector, now, {0, 0, 0, 3}, 20.0);
  EXPECT_EQ(detector.suspectSince(), agreed);
  reports(detector, now, {5, 0, 0, 0}, 1.0);
  EXPECT_EQ(detector.suspectSince(), std::nullopt);
}

TEST(KidnapDetector, DropsASuspicionThatNothingSettles) {
  KidnapDetector detector({});
  StampUs now = 0;
  reports(detector, now, {5, 0, 0, 0}, 1.0);
  reports(detector, now, {0, 2, 1, 3}, 0.5);
  reports(detector, now, {0, 0, 0, 3}, 40.0);
  EXPECT_EQ(detector.suspectSince(), std::nullopt);
  EXPECT_EQ(reports(detector, now, {0, 2, 1, 3}, 0.9), 0) << "evidence begins at 0 again";
}

TEST(KidnapDetector, CanBeOff) {
  KidnapDetector::Params off;
  off.enabled = false;
  KidnapDetector detector(off);
  StampUs now = 0;
  EXPECT_EQ(reports(detector, now, {0, 8, 0, 8}, 30.0), 0);
}

}  // namespace
}  // namespace vismem
