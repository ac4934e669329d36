// Tests M3, M4.
#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/core.hpp>

#include "active_visual_memory/memory_scene.h"

namespace vismem {
namespace {

TEST(SegmentMemoryExtent, SplitsALineInWhichImagesShowAGap) {
  AttentiveVisualMemoryParams params = standard();
  params.memory.gap_votes = 3;
  AttentiveVisualMemory memory(params);
  AttentiveVisualMemory::StepResult result;
  StampUs t = 0;
  const std::vector<Segment3> whole{{{1.0, -0.3, 0}, {1.0, 0.3, 0}}};
  const std::vector<Segment3> split{{{1.0, -0.3, 0}, {1.0, 0.05, 0}}, {{1.0, 0.10, 0}, {1.0, 0.3, 0}}};
  cv::Mat image;
  const auto show = [&](const std::vector<Segment3>& world, int times) {
    for (int i = 0; i < times; ++i, t += 33'333) {
      auto o = at(t);
      o.frame.image = image;
      result = memory.update(o, images(o, world));
    }
  };
  show(whole, 5);
  show(split, 10);
  ASSERT_EQ(memory.elements().size(), 1U) << "a break of the detector's is none";
  image = cv::Mat(240, 320, CV_8UC1, cv::Scalar(200));  // nothing in it where it is looked at
  show(split, 10);
  ASSERT_EQ(memory.elements().size(), 2U);
  // A worse image that bridges the gap does not join them again.
  show(whole, 5);
  ASSERT_EQ(memory.elements().size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    const auto near = [&](const Eigen::Vector2d& p, const Eigen::Vector3d& q) {
      return (p - q.head<2>()).norm() < 0.01;
    };
    const Segment2 known = memory.elements()[i].value.odom.floor();
    EXPECT_TRUE(std::any_of(split.begin(), split.end(),
                            [&](const Segment3& s) { return near(known.a, s.a) && near(known.b, s.b); }))
        << known.a.transpose() << " .. " << known.b.transpose();
  }
}

TEST(SegmentMemoryExtent, ALineExtendsByPiecesOfItsLabelOnly) {
  AttentiveVisualMemory memory(standard());
  StampUs t = 0;
  const std::vector<Segment3> paint{{{1.0, -0.3, 0}, {1.0, 0.0, 0}}};
  // The same line and a joint of tiles that goes on from its end.
  const std::vector<Segment3> with_joint{{{1.0, -0.3, 0}, {1.0, 0.3, 0}}};
  const auto length_after = [&](const std::vector<Segment3>& world, const Label& label) {
    for (int i = 0; i < 5; ++i, t += 33'333) {
      const auto o = at(t);
      auto seen = images(o, world);
      for (ImageSegment& segment : seen) segment.label = label;
      memory.update(o, seen);
    }
    EXPECT_EQ(memory.elements().size(), 1U);
    EXPECT_EQ(memory.elements()[0].value.label, "line");
    return memory.elements()[0].value.odom.floor().length();
  };
  EXPECT_NEAR(length_after(paint, "line"), 0.3, 0.01);
  EXPECT_NEAR(length_after(with_joint, kUnknownLabel), 0.3, 0.01);
  EXPECT_NEAR(length_after(with_joint, "line"), 0.6, 0.01);
}

TEST(SegmentMemoryExtent, SplitsALineAtEachOfItsGaps) {
  AttentiveVisualMemoryParams params = standard();
  params.memory.gap_votes = 3;
  AttentiveVisualMemory memory(params);
  StampUs t = 0;
  const std::vector<Segment3> whole{{{1.3, -0.6, 0}, {1.3, 0.6, 0}}};
  const std::vector<Segment3> split{
      {{1.3, -0.6, 0}, {1.3, -0.25, 0}}, {{1.3, -0.20, 0}, {1.3, 0.20, 0}}, {{1.3, 0.25, 0}, {1.3, 0.6, 0}}};
  const auto show = [&](const std::vector<Segment3>& world, int times) {
    for (int i = 0; i < times; ++i, t += 33'333) {
      auto o = at(t);
      o.frame.image = cv::Mat(240, 320, CV_8UC1, cv::Scalar(200));
      memory.update(o, images(o, world));
    }
  };
  show(whole, 5);
  ASSERT_EQ(memory.elements().size(), 1U);
  show(split, 10);
  ASSERT_EQ(memory.elements().size(), 3U);
  for (const Segment3& truth : split) {
    EXPECT_TRUE(std::any_of(memory.elements().begin(), memory.elements().end(), [&](const MemoryElement& e) {
      return (e.value.odom.a - truth.a).norm() < 0.01 && (e.value.odom.b - truth.b).norm() < 0.01;
    })) << truth.a.transpose();
  }
}

// Fusion moves the origin of a line's coordinate to its middle.
TEST(SegmentMemoryExtent, ShortensALineThatGrowsAtItsOtherEnd) {
  AttentiveVisualMemory memory(standard());
  StampUs t = 0;
  const auto show = [&](double from_m, double to_m) {
    auto o = at(t += 33'333);
    o.frame.image = cv::Mat(240, 320, CV_8UC1, cv::Scalar(200));
    memory.update(o, images(o, {{{1.3, from_m, 0}, {1.3, to_m, 0}}}));
  };
  for (int i = 0; i < 10; ++i) show(-0.5, -0.1);
  for (int i = 0; i < 6; ++i) show(-0.3, -0.1 + 0.12 * i);
  ASSERT_EQ(memory.elements().size(), 1U);
  const Segment2 known = memory.elements()[0].value.odom.floor();
  EXPECT_NEAR(std::min(known.a.y(), known.b.y()), -0.3, 0.01);
  EXPECT_NEAR(std::max(known.a.y(), known.b.y()), 0.5, 0.01);
}

/// How many elements a line becomes of which something hides a piece from either of two places.
std::size_t elementsWhenHidden(double from_left_m, double from_right_m) {
  AttentiveVisualMemoryParams params = standard();
  params.memory.gap_votes = 3;
  AttentiveVisualMemory memory(params);
  StampUs t = 0;
  for (const auto& [y, hidden] : {std::pair(0.25, from_left_m), std::pair(-0.25, from_right_m)}) {
    const std::vector<Segment3> seen{{{1.5, -0.5, 0}, {1.5, hidden - 0.05, 0}},
                                     {{1.5, hidden + 0.05, 0}, {1.5, 0.5, 0}}};
    for (int i = 0; i < 10; ++i, t += 33'333) {
      auto o = at(t, {0.0, y, 0.0});
      auto observed = images(o, seen);
      if (t < 100'000) observed = images(o, {{{1.5, -0.5, 0}, {1.5, 0.5, 0}}});
      cv::Mat image(240, 320, CV_8UC1, cv::Scalar(200));
      const Pose3 T = toPose3(o.T_odom_robot) * o.T_robot_camera;
      const auto px = projectSegment(o.frame.intrinsics, T, {seen[0].b, seen[1].a});
      const auto [left, right] = std::minmax(px->a.x(), px->b.x());
      image(cv::Rect(cv::Point(static_cast<int>(left), static_cast<int>(px->a.y()) - 20),
                     cv::Point(static_cast<int>(right) + 1, static_cast<int>(px->a.y()) + 20))) = 60;
      o.frame.image = image;
      memory.update(o, observed);
    }
  }
  return memory.elements().size();
}

TEST(SegmentMemoryExtent, AnOccluderSeenFromTwoPlacesAtOnePlaceSplitsTheLine) {
  EXPECT_EQ(elementsWhenHidden(0.1, 0.1), 2U);
  EXPECT_EQ(elementsWhenHidden(0.0, 0.2), 1U) << "the line goes on behind what stands before it";
}

}  // namespace
}  // namespace vismem
