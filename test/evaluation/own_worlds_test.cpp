// Every shipped world is driven in every simulated setup: along its route, without a collision, and with a
// pose that is right.
#include <cstdio>
#include <tuple>

#include "evaluation/world_drive.h"

namespace vismem {
namespace {

constexpr double kSeconds = 8.0;
/// The operator drives 0.3 m/s, a humanoid 0.25 m/s; corners and the first steps are slower.
constexpr double kLeastDriven_m = 0.8;
/// Pure pursuit cuts corners by a part of its look-ahead distance of 0.45 m.
constexpr double kFarthestFromRoute_m = 0.35;

using Case = std::tuple<std::string, std::string>;  // world, setup
class OwnWorlds : public ::testing::TestWithParam<Case> {};

TEST_P(OwnWorlds, AreDrivenAlongTheirRouteWithARightPose) {
  const auto& [world, setup] = GetParam();
  const WorldDrive drive = driveWorld(world, setup, 1, kSeconds, true);
  std::printf("%s, %s: %.2f m, off the route %.2f m, error %.3f m\n", world.c_str(), setup.c_str(),
              drive.driven_m, drive.from_route_m, drive.score.position_error_m.value_or(-1.0));
  EXPECT_TRUE(drive.problems.empty()) << drive.problems.front();
  EXPECT_GT(drive.driven_m, kLeastDriven_m);
  EXPECT_LT(drive.from_route_m, kFarthestFromRoute_m);
  EXPECT_EQ(drive.collisions, 0);
  EXPECT_TRUE(drive.score.recovered) << "the last pose is not right";
  ASSERT_TRUE(drive.score.position_error_m);
  EXPECT_LT(*drive.score.position_error_m, 0.15);
  EXPECT_LT(*drive.score.heading_error_rad, degToRad(5.0));
}

INSTANTIATE_TEST_SUITE_P(EveryWorld, OwnWorlds,
                         ::testing::Combine(::testing::ValuesIn(shippedWorlds()),
                                            ::testing::Values("sim", "humanoid")),
                         [](const auto& world) {
                           return std::get<0>(world.param) + "_" + std::get<1>(world.param);
                         });

}  // namespace
}  // namespace vismem
