// A minute in every shipped world from an unknown start: the robot never stands, and finds its pose.
#include <cstdio>

#include "evaluation/world_drive.h"

namespace vismem {
namespace {

constexpr double kSeconds = 60.0;

class AMinuteInAWorld : public ::testing::TestWithParam<std::string> {};

TEST_P(AMinuteInAWorld, IsDrivenWithoutAStopAndLocalized) {
  for (const std::uint64_t seed : {51, 52}) {
    const WorldDrive drive = driveWorld(GetParam(), "sim", seed, kSeconds, false);
    std::printf("%s, seed %d: %.1f m, stands %.1f s, settled after %.1f s, error %.3f m%s\n",
                GetParam().c_str(), static_cast<int>(seed), drive.driven_m, drive.longest_stand_s,
                drive.score.settled_after_s.value_or(-1.0), drive.score.position_error_m.value_or(-1.0),
                drive.score.is_twin ? " of the twin" : "");
    EXPECT_GT(drive.driven_m, 10.0) << "seed " << seed;
    // A turn on the spot at the end of an open route takes four seconds.
    EXPECT_LT(drive.longest_stand_s, 6.0) << "seed " << seed;
    EXPECT_LT(drive.from_route_m, 0.35) << "seed " << seed;
    EXPECT_EQ(drive.collisions, 0) << "seed " << seed;
    EXPECT_TRUE(drive.score.recovered) << "seed " << seed;
  }
}

INSTANTIATE_TEST_SUITE_P(EveryWorld, AMinuteInAWorld, ::testing::ValuesIn(shippedWorlds()),
                         [](const auto& world) { return world.param; });

}  // namespace
}  // namespace vismem
