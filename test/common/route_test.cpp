#include "common/routes/route.h"

#include <gmock/gmock.h>

#include <cmath>
#include <set>

#include "common/config/config_error.h"
#include "common/geometry/angles.h"
#include "common/routes/route_follower.h"

namespace vismem {
namespace {

/// A rectangle of 8 x 5 m: 26 m round, as the corridor.
Route ring() {
  return {{{0, 0}, {8, 0}, {8, 5}, {0, 5}}, true};
}

TEST(Route, PlacesAlongAHandWorkedRing) {
  EXPECT_DOUBLE_EQ(ring().length(), 26.0);
  const RoutePlace corner = placeAlong(ring(), 10.0);  // 8 along the first line, 2 up the second
  EXPECT_NEAR(corner.position.x(), 8.0, 1e-12);
  EXPECT_NEAR(corner.position.y(), 2.0, 1e-12);
  EXPECT_NEAR(corner.heading_rad, degToRad(90.0), 1e-12);
  EXPECT_NEAR(placeAlong(ring(), -1.0).position.y(), 1.0, 1e-12) << "wraps backwards onto the last line";
  EXPECT_NEAR(nearestPlace(ring(), {4.0, 0.3}).along_m, 4.0, 1e-12);
  EXPECT_NEAR(nearestPlace(ring(), {-0.2, 2.0}).along_m, 24.0, 1e-12);
}

TEST(Route, ReadsAFileAndNamesItsProblems) {
  const Route route = parseRoute("closed # ring\nx_m,y_m\n0,0\n 4 , 0 # corner\n\n4,3\n", "a.route");
  EXPECT_TRUE(route.closed);
  ASSERT_EQ(route.points.size(), 3u);
  EXPECT_EQ(route.points[1], Eigen::Vector2d(4, 0));
  try {
    parseRoute("round\nx,y\n0,0\n0,0.01\n1;2\n", "bad.route");
    FAIL() << "no error";
  } catch (const ConfigError& error) {
    EXPECT_THAT(
        error.problems(),
        testing::ElementsAre("bad.route:1: \"round\" (must be closed or open)",
                             "bad.route:2: \"x,y\" (must be the header x_m,y_m)",
                             "bad.route:4: \"0,0.01\" (must be 0.05 m or more from the way-point before)",
                             "bad.route:5: \"1;2\" (must be two finite numbers: x_m,y_m)"));
  }
}

TEST(StartOnRoute, IsTheSameForASeedAndSpreadsOverTheRoute) {
  std::set<int> quarters;
  int backwards = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const RouteStart start = startOnRoute(ring(), seed);
    EXPECT_EQ(start.T_world_robot, startOnRoute(ring(), seed).T_world_robot);
    const RoutePlace place = nearestPlace(ring(), start.T_world_robot.position());
    EXPECT_LE((place.position - start.T_world_robot.position()).norm(), 0.1 + 1e-9) << "seed " << seed;
    quarters.insert(static_cast<int>(place.along_m / 6.5));
    backwards += start.backwards;
    const double heading = place.heading_rad + (start.backwards ? std::numbers::pi : 0.0);
    // Near a corner the nearest line may be the next one: skip those.
    if (std::abs(std::remainder(place.along_m, 1.0)) > 0.11) {
      EXPECT_LE(std::abs(angleDifference(start.T_world_robot.theta, heading)), 0.26 + 1e-9)
          << "seed " << seed;
    }
  }
  EXPECT_EQ(quarters.size(), 4u);
  EXPECT_GT(backwards, 10);
  EXPECT_LT(backwards, 30);
}

/// An ideal differential drive at 30 Hz.
Pose2 moved(const Pose2& pose, const DriveCommand& command, double dt_s) {
  const double turn = command.w_radps * dt_s;
  const double step = command.v_mps * dt_s;
  return {pose.x + step * std::cos(pose.theta + 0.5 * turn),
          pose.y + step * std::sin(pose.theta + 0.5 * turn), wrapAngle(pose.theta + turn)};
}

TEST(SimulatedOperator, DrivesRoundTheRingInBothDirections) {
  for (const bool backwards : {false, true}) {
    const Route route = backwards ? reversed(ring()) : ring();
    const RouteFollowerParams params;
    SimulatedOperator driver(route, params);
    Pose2 pose{4.0, 0.0, backwards ? std::numbers::pi : 0.0};
    double travelled = 0.0;
    double progress = 0.0;
    double along = nearestPlace(route, pose.position()).along_m;
    for (int i = 0; i < 30 * 120; ++i) {
      const DriveCommand command = driver.drive(pose);
      ASSERT_GE(command.v_mps, 0.0);
      ASSERT_LE(command.v_mps, params.speed_mps);
      ASSERT_LE(std::abs(command.w_radps), params.max_turn_rate_radps);
      pose = moved(pose, command, 1.0 / 30.0);
      travelled += command.v_mps / 30.0;
      const RoutePlace place = nearestPlace(route, pose.position());
      // A corridor 1.5 m wide leaves a robot of 0.25 m radius half a metre beside its middle.
      ASSERT_LT((place.position - pose.position()).norm(), 0.25) << "at " << i / 30.0 << " s";
      progress += std::remainder(place.along_m - along, 26.0);
      along = place.along_m;
    }
    // 120 s at 0.3 m/s are 36 m; corners are slower.
    EXPECT_GT(progress, 28.0) << "more than one round";
    EXPECT_GT(travelled, 27.0);
  }
}

TEST(SimulatedOperator, TurnsRoundOnTheSpotWhenItLooksTheOtherWay) {
  SimulatedOperator driver(ring(), {});
  const DriveCommand command = driver.drive({4.0, 0.0, degToRad(170.0)});
  EXPECT_EQ(command.v_mps, 0.0);
  EXPECT_NEAR(command.w_radps, -0.8, 1e-12) << "the shorter way is clockwise";
}

TEST(SimulatedOperator, DrivesAnOpenRouteToAndFro) {
  SimulatedOperator driver({{{0, 0}, {2, 0}}, false}, {});
  Pose2 pose{1.0, 0.0, 0.0};
  double low = 1.0;
  double high = 1.0;
  for (int i = 0; i < 30 * 40; ++i) {
    pose = moved(pose, driver.drive(pose), 1.0 / 30.0);
    low = std::min(low, pose.x);
    high = std::max(high, pose.x);
    ASSERT_LT(std::abs(pose.y), 0.6);
  }
  EXPECT_LT(low, 0.5);
  EXPECT_GT(high, 1.5);
}

TEST(SimulatedOperator, FindsTheRouteAgainAfterAKidnap) {
  SimulatedOperator driver(ring(), {});
  driver.drive({4.0, 0.0, 0.0});
  driver.lost();
  // On the third line (y = 5, towards -x) and looking along it: straight on.
  const DriveCommand command = driver.drive({4.0, 5.0, std::numbers::pi});
  EXPECT_GT(command.v_mps, 0.29);
  EXPECT_NEAR(command.w_radps, 0.0, 1e-6);
}

TEST(SimulatedOperator, RefusesBadParameters) {
  EXPECT_THROW(SimulatedOperator(ring(), {.speed_mps = 0.0}), std::invalid_argument);
  EXPECT_THROW(SimulatedOperator(Route{{{0, 0}}, true}, {}), std::invalid_argument);
}

TEST(ParseRoute, RefusesPlacesThatNoWorldHas) {
  try {
    parseRoute("open\nx_m,y_m\n0,0\n1e30,0\n", "far.route");
    FAIL() << "accepted";
  } catch (const ConfigError& error) {
    EXPECT_EQ(error.problems(),
              std::vector<std::string>{"far.route:4: \"1e30,0\" (must be within 100 km of the origin)"});
  }
}

}  // namespace
}  // namespace vismem
