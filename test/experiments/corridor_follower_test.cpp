// Tests E2.
#include "experiments/core/corridor_follower.h"

#include <gtest/gtest.h>

#include <vector>

namespace vismem {
namespace {

std::vector<Segment2> straightCorridor() {
  return {{{-1.0, 0.8}, {4.0, 0.8}}, {{-1.0, -0.8}, {4.0, -0.8}}};
}

TEST(CorridorFollower, DrivesStraightBetweenTwoWalls) {
  CorridorFollower follower({});
  const ArcCommand command = follower.follow(straightCorridor(), {});
  EXPECT_DOUBLE_EQ(command.v_mps, CorridorFollower::Params{}.speed_mps);
  EXPECT_DOUBLE_EQ(command.w_radps, 0.0);
  EXPECT_NEAR(command.free_m, CorridorFollower::Params{}.reach_m, 1e-9);
}

TEST(CorridorFollower, TurnsAwayFromANearWall) {
  // The wall on the left is 0.4 m away, that on the right 1.2 m.
  const std::vector<Segment2> walls{{{-1.0, 0.4}, {4.0, 0.4}}, {{-1.0, -1.2}, {4.0, -1.2}}};
  CorridorFollower follower({});
  EXPECT_LT(follower.follow(walls, {}).w_radps, 0.0);
}

TEST(CorridorFollower, StandsWhereAWallIsNotKnown) {
  const std::vector<Segment2> left_only{straightCorridor().front()};
  CorridorFollower follower({});
  const ArcCommand command = follower.follow(left_only, {});
  EXPECT_EQ(command.v_mps, 0.0);
  EXPECT_EQ(command.w_radps, 0.0);
}

TEST(CorridorFollower, AnUncertainWallIsASideButNoObstacle) {
  const std::vector<Segment2> walls = straightCorridor();
  // The right wall is unconfirmed, and so is one across the way.
  const std::vector<Segment2> uncertain{walls[1], {{1.0, -0.8}, {1.0, 0.8}}};
  const std::vector<Segment2> left_only{walls[0]};
  CorridorFollower follower({});
  EXPECT_GT(follower.follow(left_only, uncertain).v_mps, 0.0);
  std::vector<Segment2> blocked = walls;
  blocked.push_back(uncertain[1]);
  CorridorFollower another({});
  EXPECT_EQ(another.follow(blocked, {}).v_mps, 0.0) << "a confirmed wall across the way";
}

}  // namespace
}  // namespace vismem
