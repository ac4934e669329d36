// Tests M1, M4.
#include "evaluation/core/moving_edges.h"

#include <gtest/gtest.h>

#include "common/geometry/projection.h"
#include "evaluation/floor_view.h"

namespace vismem {
namespace {

const Segment2 kPaint{{-0.4, 0.1}, {0.4, 0.1}};
const Segment2 kFoot{{-0.2, -0.2}, {0.1, -0.2}};

/// A memory of both edges and the image, from straight above, that shows them.
class TwoEdges : public testing::Test {
 protected:
  /// @param shown  of the edges, which the image shows.
  void see(double at_s, const std::vector<Segment2>& shown, bool foot_confirmed) {
    memory.stamp_us = analysis.stamp_us = toStampUs(at_s);
    analysis.observed.clear();
    memory.segments.clear();
    for (const Segment2& edge : {kPaint, kFoot}) {
      MemorySegment segment;
      segment.id = memory.segments.size() + 1;
      segment.odom = onFloor(edge);
      segment.confirmed = segment.id == 1 || foot_confirmed;
      const bool is_shown =
          std::any_of(shown.begin(), shown.end(), [&](const Segment2& s) { return s.a == edge.a; });
      if (is_shown) {
        last_seen_us[segment.id] = memory.stamp_us;
        analysis.observed.push_back({*projectSegment(camera(), lookingDown(), segment.odom), "edge", 50.0});
      }
      segment.last_seen_us = last_seen_us[segment.id];
      memory.segments.push_back(segment);
    }
    analysis.intrinsics = camera();
    analysis.T_robot_camera = lookingDown();
    // The foot is in the lower half of the image.
    edges.add(memory, analysis, [](const Segment2& px) {
      return px.middle().y() > 120.0 ? EdgeOwner::kMoving : EdgeOwner::kStill;
    });
  }

  MemorySnapshot memory;
  ImageAnalysis analysis;
  std::map<std::uint64_t, StampUs> last_seen_us;
  MovingEdges edges;
};

TEST_F(TwoEdges, TheConfirmedOneOfWhatMovesIsFound) {
  for (int i = 1; i <= 3; ++i) see(0.1 * i, {kPaint, kFoot}, true);
  const auto theirs = edges.confirmedOf(memory);
  ASSERT_EQ(theirs.size(), 1u);
  EXPECT_EQ(theirs[0].id, 2u);
  EXPECT_EQ(edges.histories().at(1).still, 3);
  EXPECT_EQ(edges.histories().at(2).moving, 3);
}

TEST_F(TwoEdges, AnUnconfirmedOneDoesNotCount) {
  see(0.1, {kPaint, kFoot}, false);
  EXPECT_TRUE(edges.confirmedOf(memory).empty());
  EXPECT_TRUE(edges.histories().at(2).isOfMoving());
  EXPECT_EQ(edges.longestAfter_s(), 0.0);
}

TEST_F(TwoEdges, TheTimeItStaysConfirmedUnseenIsMeasured) {
  see(0.1, {kPaint, kFoot}, true);
  see(2.6, {kPaint}, true);
  EXPECT_NEAR(edges.longestAfter_s(), 2.5, 1e-9);
}

}  // namespace
}  // namespace vismem
