// Tests E5, E6.
#include "experiments/trials/visible_pieces.h"

#include <gmock/gmock.h>

#include <utility>

#include "common/geometry/projection.h"
#include "experiments/trials/visible_scene.h"

namespace vismem {
namespace {

TEST(VisiblePieces, AreTheProjectionsOfWhatIsInViewBrightSideLeft) {
  const auto pieces = visiblePieces(lines(), kIntrinsics, camera(), openFloor);
  ASSERT_EQ(pieces.size(), 2u);  // the third line lies behind
  const auto whole = projectSegment(kIntrinsics, camera(), lines().segments[0].world);
  ASSERT_TRUE(whole);
  EXPECT_EQ(pieces[0].edge, 0);
  EXPECT_NEAR((pieces[0].px.a - whole->a).norm(), 0.0, 1e-6);
  EXPECT_NEAR((pieces[0].px.b - whole->b).norm(), 0.0, 1e-6);
}

TEST(VisiblePieces, TurnSoThatTheBrighterSideIsLeft) {
  SegmentMap turned = lines();
  std::swap(turned.segments[0].world.a, turned.segments[0].world.b);
  const auto as_drawn = visiblePieces(lines(), kIntrinsics, camera(), openFloor);
  const auto reversed = visiblePieces(turned, kIntrinsics, camera(), openFloor);
  EXPECT_NEAR((as_drawn[0].px.a - reversed[0].px.a).norm(), 0.0, 1e-6);
}

TEST(VisiblePieces, EndWhereSomethingStandsBeforeThem) {
  SegmentMap cross;
  cross.segments = {lines().segments[1]};
  const auto pieces = visiblePieces(cross, kIntrinsics, camera(), floorBehindAPost);
  ASSERT_EQ(pieces.size(), 2u);
  const auto whole = projectSegment(kIntrinsics, camera(), cross.segments[0].world);
  const double third = whole->length() / 3.0;
  EXPECT_NEAR(pieces[0].px.length(), third, 0.5);
  EXPECT_NEAR(pieces[1].px.length(), third, 0.5);
  for (const VisiblePiece& piece : pieces) EXPECT_NE(piece.hidden_a, piece.hidden_b);
}

TEST(VisibleOutlines, RiseFromACornerAsFarAsFloorIsSeenBehindIt) {
  const auto outlines = visibleOutlines(corner(), kIntrinsics, cameraBesideTheCorner(), blockBeforeAWall);
  ASSERT_EQ(outlines.size(), 1u);
  // The line of sight over (2, 0, h) from 0.45 m meets the floor at x = 5 when h = 0.45 (1 - 2 / 5).
  const auto expected =
      projectSegment(kIntrinsics, cameraBesideTheCorner(), {{2.0, 0.0, 0.0}, {2.0, 0.0, 0.27}});
  ASSERT_TRUE(expected);
  EXPECT_TRUE(outlines[0].is_outline);
  // Brighter on the left: the wall lies to the right of it in the image, so it runs down.
  EXPECT_NEAR((outlines[0].px.a - expected->b).norm(), 0.0, 1.0);
  EXPECT_NEAR((outlines[0].px.b - expected->a).norm(), 0.0, 1.0);
}

TEST(VisibleOutlines, AreNoneWhereTheMapHasTheUprightEdgeOrNoFloorIsSeen) {
  SegmentMap with_upright = corner();
  with_upright.segments.push_back({{{2.0, 0.0, 0.0}, {2.0, 0.0, 2.0}}, "door_jamb", 0.0});
  EXPECT_TRUE(visibleOutlines(with_upright, kIntrinsics, cameraBesideTheCorner(), blockBeforeAWall).empty());
  EXPECT_TRUE(visibleOutlines(corner(), kIntrinsics, cameraBesideTheCorner(), openFloor).empty());
}

}  // namespace
}  // namespace vismem
