// Tests M3, M4.
#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "active_visual_memory/memory_scene.h"

namespace vismem {
namespace {

const std::vector<Segment3> kCross{{{1.0, -0.3, 0}, {1.0, 0.3, 0}}, {{1.2, 0.2, 0}, {1.8, 0.2, 0}}};

TEST(SegmentMemoryUpkeep, PiecesSeenFirstAreJoinedWhenTheWholeIsSeen) {
  AttentiveVisualMemory memory(standard());
  const std::vector<Segment3> pieces{{{1.0, -0.3, 0}, {1.0, -0.1, 0}}, {{1.0, 0.1, 0}, {1.0, 0.3, 0}}};
  StampUs t = 0;
  for (int i = 0; i < 5; ++i, t += 33'333) {
    const auto o = at(t);
    memory.update(o, images(o, pieces));
  }
  EXPECT_EQ(memory.elements().size(), 2u);
  for (int i = 0; i < 5; ++i, t += 33'333) {
    const auto o = at(t);
    memory.update(o, images(o, {kCross[0]}));
  }
  EXPECT_EQ(memory.elements().size(), 1u);
}

TEST(SegmentMemoryUpkeep, AVerticalEdgeDoesNotBendTheFootOfItsWall) {
  // It stands at the corner of the wall, whose foot is known to rest. The robot passes where the foot lies
  // nearly along the viewing ray, as the place of the vertical edge on the floor always does.
  const Segment3 foot{{1.0, 0.8, 0}, {1.9, 0.8, 0}};
  const Segment3 vertical{{1.0, 0.8, 0}, {1.0, 0.8, 1.2}};
  AttentiveVisualMemory memory(standard());
  StampUs t = 0;
  for (int i = 0; i <= 60; ++i, t += 33'333) {
    const auto o = at(t, {-0.2 + 0.01 * i, 0.0, 0.0}, degToRad(35.0));
    memory.update(o, images(o, {foot}));
  }
  ASSERT_EQ(memory.elements().size(), 1u);
  ASSERT_TRUE(memory.elements()[0].plane.isVerified());
  for (int i = 0; i <= 30; ++i, t += 33'333) {
    const auto o = at(t, {-0.2, 0.6 + 0.006 * i, 0.0}, degToRad(10.0));
    memory.update(o, images(o, {foot, vertical}));
    const Segment2 known = memory.elements()[0].line.segment();
    EXPECT_LT((known.a - foot.a.head<2>()).norm(), 0.03) << "image " << i;
    EXPECT_LT((known.b - foot.b.head<2>()).norm(), 0.03) << "image " << i;
  }
}

TEST(SegmentMemoryUpkeep, StaysWithinItsBound) {
  AttentiveVisualMemoryParams p = standard();
  p.memory.retention.max_elements = 5;
  AttentiveVisualMemory memory(p);
  std::vector<Segment3> many;
  for (int i = 0; i < 10; ++i) many.push_back({{0.8 + 0.15 * i, -0.2, 0}, {0.8 + 0.15 * i, 0.2, 0}});
  for (int i = 0; i < 10; ++i) {
    const auto o = at(i * 33'333);
    memory.update(o, images(o, many));
    EXPECT_LE(memory.elements().size(), 5u);
  }
}

/// Renders a floor: dark above the far edge of a marking, bright nearer, or plain.
cv::Mat picture(bool marking, int grey_cover = -1) {
  cv::Mat image(240, 320, CV_8UC3, cv::Scalar(60, 60, 60));
  if (marking) image.rowRange(110, 240).setTo(cv::Scalar(180, 180, 180));
  if (grey_cover >= 0) image.setTo(cv::Scalar(grey_cover, 0, grey_cover));
  return image;
}

struct Life {
  double seconds_alive;
  std::size_t left;
};
/// @param rests  whether the edge is known to lie on the floor.
Life afterwards(const cv::Mat& later, double seconds, bool rests = true) {
  AttentiveVisualMemoryParams params = standard();
  params.memory.confirmation.by_parallax = !rests;
  AttentiveVisualMemory memory(params);
  // The edge between row 109 and 110, brighter below: walking to the left of the picture, left is down.
  const std::vector<ImageSegment> edge{{{{250, 109.5}, {70, 109.5}}, "edge", 120.0}};
  StampUs t = 0;
  for (int i = 0; i < 60; ++i, t += 33'333) {
    auto o = at(t);
    o.frame.image = picture(true);
    memory.update(o, edge);
  }
  EXPECT_EQ(memory.elements().size(), 1u);
  const StampUs begin = t;
  while (toSeconds(t - begin) < seconds && !memory.elements().empty()) {
    auto o = at(t);
    o.frame.image = later;
    memory.update(o, {});
    t += 33'333;
  }
  return {toSeconds(t - begin), memory.elements().size()};
}

TEST(SegmentMemoryUpkeep, AFreePlaceIsForgottenWithinTwoSeconds) {
  const Life life = afterwards(picture(false), 10.0);
  EXPECT_EQ(life.left, 0u);
  EXPECT_LE(life.seconds_alive, 2.0);
}

TEST(SegmentMemoryUpkeep, AnOcclusionFreezesLife) {
  EXPECT_EQ(afterwards(picture(false, 200), 30.0).left, 1u);
}

TEST(SegmentMemoryUpkeep, AnEdgeTheDetectorMissesStays) {
  EXPECT_EQ(afterwards(picture(true), 30.0).left, 1u);
}

TEST(SegmentMemoryUpkeep, AnEdgeNotKnownToRestIsForgottenWhereItIsNotSeen) {
  // A robot that drove on may still fill the place.
  const Life life = afterwards(picture(false, 200), 10.0, false);
  EXPECT_EQ(life.left, 0u);
  EXPECT_LE(life.seconds_alive, 2.0);
}

TEST(SegmentMemoryUpkeep, AnEdgeIsForgottenWhereAnEdgeOfAnotherLabelIsSeen) {
  // Noise named the foot of a wall as a line for a while.
  AttentiveVisualMemoryParams params = standard();
  params.memory.confirmation.by_parallax = false;
  AttentiveVisualMemory memory(params);
  const Segment2 place{{250, 109.5}, {70, 109.5}};
  StampUs t = 0;
  const auto see = [&](const Label& label) {
    for (int i = 0; i < 60; ++i, t += 33'333) {
      auto o = at(t);
      o.frame.image = picture(true);
      memory.update(o, std::vector<ImageSegment>{{place, label, 120.0}});
    }
  };
  see("line");
  see("foot");
  ASSERT_EQ(memory.elements().size(), 1u);
  EXPECT_EQ(memory.elements()[0].value.label, "foot");
}

}  // namespace
}  // namespace vismem
