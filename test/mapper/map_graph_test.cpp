// The graph of a drive against a drive with known truth. Tests B6.
#include "mapper/core/map_graph.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "common/geometry/angles.h"
#include "common/geometry/projection.h"
#include "drive_score.h"
#include "mapper/core/drive_mapper.h"
#include "synthetic_drive.h"

namespace vismem {
namespace {

constexpr double kRing_m = 30.0;

OdometryErrors wheels() {
  OdometryErrors errors;
  errors.turn_noise = 0.008;
  return errors;
}

DriveMapperParams mapperParams() {
  DriveMapperParams params;
  params.graph.odometry = wheels();
  return params;
}

/// RMS of the robot's places after rigid alignment [m].
double placeError(const MapState& state, const SyntheticDrive& drive) {
  const Pose2 T = placesOnTruth(state, drive);
  double sum = 0.0;
  for (std::size_t k = 0; k < drive.truth.size(); ++k) {
    sum += (transform(T, state.poses[k].position()) - drive.truth[k].position()).squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(drive.truth.size()));
}

/// RMS of the closed ends of the map from the true ends of the edges, after rigid alignment [m].
double endError(const MapState& state, const std::vector<TrueFloorEdge>& edges, const SyntheticDrive& drive) {
  const MapScore score = scoreOf(state, edges, drive);
  EXPECT_GT(score.ends, 40);
  return score.ends_rms_m;
}

TEST(InitialState, UnconfirmedElementsAreLandmarksOnlyWhereThatIsSaid) {
  SyntheticDrive ring = drive(ringOfCorridors(), ringWay(kRing_m), {});
  const std::size_t all = initialState(ring.record, {}).landmarks.size();
  ring.record.elements.begin()->second.confirmed = false;
  EXPECT_EQ(initialState(ring.record, {}).landmarks.size(), all - 1);
  EXPECT_EQ(initialState(ring.record, {.confirmed_only = false}).landmarks.size(), all);
}

TEST(MapGraph, FindsTheLastingErrorsOfTheWheels) {
  SyntheticDriveParams params;
  params.scale_error = 0.02;
  params.turn_per_rad = -0.015;
  params.turn_per_m = 0.02;
  const SyntheticDrive ring = drive(ringOfCorridors(), ringWay(kRing_m), params);
  MapState state = initialState(ring.record, {});
  ASSERT_TRUE(solveGraph(ring.record, mapperParams().graph, {}, state).usable);
  // Corrections: the inverse of the errors. The noise of 120 increments leaves the tolerances.
  EXPECT_NEAR(state.odometry[0], -0.0196, 0.006);
  EXPECT_NEAR(state.odometry[1], 0.0152, 0.012);
  EXPECT_NEAR(state.odometry[2], -0.02, 0.006);
}

// Few images show an edge: what fits them by chance makes the noise look smaller, but not without end.
TEST(MapGraph, MeasuresTheNoiseOfTheImages) {
  for (const double sigma_px : {0.2, 1.0}) {
    SyntheticDriveParams params;
    params.pixel_sigma = sigma_px;
    const SyntheticDrive ring = drive(ringOfCorridors(), ringWay(kRing_m), params);
    MapState state = initialState(ring.record, {});
    GraphParams graph = mapperParams().graph;
    for (int i = 0; i < 6; ++i) graph = measured(graph, solveGraph(ring.record, graph, {}, state));
    EXPECT_NEAR(graph.across_px, sigma_px, 0.5 * sigma_px);
    EXPECT_NEAR(graph.along_px, sigma_px, 0.5 * sigma_px);
  }
}

TEST(MapGraph, OneLapWithoutAnyEdgeSeenAgainIsStraightened) {
  const SyntheticDrive ring = drive(ringOfCorridors(), ringWay(kRing_m), {});
  MapState odometry = initialState(ring.record, {});
  EXPECT_GT(placeError(odometry, ring), 0.3);
  const DriveMap map = mapDrive(ring.record, {}, mapperParams());
  EXPECT_EQ(map.problem, "");
  EXPECT_LT(placeError(map.state, ring), 0.10);
  EXPECT_LT(endError(map.state, ringOfCorridors(), ring), 0.05);
}

/// Largest error of a heading about the first pose [rad].
double headingError(const MapState& state, const SyntheticDrive& drive) {
  double worst = 0.0;
  for (std::size_t k = 0; k < drive.truth.size(); ++k) {
    const double turned = angleDifference(state.poses[k].theta, state.poses[0].theta);
    const double truth = angleDifference(drive.truth[k].theta, drive.truth[0].theta);
    worst = std::max(worst, std::abs(angleDifference(turned, truth)));
  }
  return worst;
}

// Feet turn a robot by some degrees a metre: at the end of a lap dead reckoning is wrong by a quarter turn.
TEST(AlignHeadings, TheWallsOfAPlaceKeepTheHeadingOfARobotOnLegs) {
  for (const std::uint64_t seed : {1, 2, 3, 4}) {
    SyntheticDriveParams walk;
    walk.seed = seed;
    walk.turn_noise_rad = 0.025;
    walk.turn_per_m = 0.06;
    const SyntheticDrive ring = drive(ringOfCorridors(), ringWay(kRing_m), walk);
    OdometryErrors feet;
    feet.turn_noise = 0.05;
    feet.turn_per_m = 0.06;
    MapState state = initialState(ring.record, {});
    EXPECT_GT(headingError(state, ring), 0.7) << "seed " << seed;
    EXPECT_TRUE(alignHeadings(ring.record, feet, {}, state));
    EXPECT_LT(headingError(state, ring), 0.2) << "seed " << seed;
  }
}

TEST(AlignHeadings, APlaceWithoutRightAnglesChangesNothing) {
  const double s = std::sqrt(0.5);
  const std::vector<Pose2> way = wayThrough({{-3.0, 0.0}, {0.33, 0.0}, {0.33 + 5.0 * s, 5.0 * s}}, 8.0);
  const SyntheticDrive wing = drive(slantedWing(), way, {});
  MapState state = initialState(wing.record, {});
  const std::vector<Pose2> reckoned = state.poses;
  EXPECT_FALSE(alignHeadings(wing.record, {}, {}, state));
  EXPECT_EQ(state.poses, reckoned);
}

// Research, 4.3: a kernel on line residuals before the graph is near takes the drift for outliers.
TEST(MapGraph, AKernelOnLinesFromTheStartIsWorseThanAfterALeastSquaresSolve) {
  SyntheticDriveParams params;
  params.turn_per_m = 0.03;
  const SyntheticDrive ring = drive(ringOfCorridors(), ringWay(kRing_m), params);
  MapState early = initialState(ring.record, {});
  GraphParams graph = mapperParams().graph;
  solveGraph(ring.record, graph, {.kernel = 0.5}, early);
  MapState late = initialState(ring.record, {});
  solveGraph(ring.record, graph, {}, late);
  solveGraph(ring.record, graph, {.kernel = 0.5}, late);
  EXPECT_LT(placeError(late, ring), 0.12);
  EXPECT_LT(placeError(late, ring), placeError(early, ring));
}

TEST(MapGraph, RightAnglesDoNotBendAPlaceThatHasNone) {
  const std::vector<TrueFloorEdge> edges = slantedWing();
  const double s = std::sqrt(0.5);
  const std::vector<Pose2> way = wayThrough({{-5.0, 0.0}, {0.33, 0.0}, {0.33 + 5.0 * s, 5.0 * s}}, 10.0);
  const SyntheticDrive wing = drive(edges, way, {});
  DriveMapperParams params = mapperParams();
  const double with = placeError(mapDrive(wing.record, {}, params).state, wing);
  params.right_angles = false;
  const double without = placeError(mapDrive(wing.record, {}, params).state, wing);
  EXPECT_LT(with, without + 0.01);
  EXPECT_LT(with, 0.06);
}

// Research, section 9: most of a building has right angles, one wing has not.
TEST(MapGraph, RightAnglesLeaveAWingAt45DegreesAsItIs) {
  for (const std::uint64_t seed : {1, 2}) {
    SyntheticDriveParams wheels_err;
    wheels_err.seed = seed;
    const SyntheticDrive floor = drive(cornerWithSlantedWing(), wayIntoSlantedWing(), wheels_err);
    DriveMapperParams params = mapperParams();
    const DriveMap map = mapDrive(floor.record, {}, params);
    params.right_angles = false;
    const double without = placeError(mapDrive(floor.record, {}, params).state, floor);
    EXPECT_LT(placeError(map.state, floor), without + 0.01) << "seed " << seed;
    EXPECT_LT(placeError(map.state, floor), 0.06) << "seed " << seed;
    // Both walls of the wing, at 45 degrees to the first corridor.
    double slanted_m = 0.0;
    double first = 0.0;
    double longest_m = 0.0;
    for (const LineLandmark& landmark : map.state.landmarks) {
      const Segment2 world = map.state.worldSegment(landmark);
      if (world.length() <= longest_m) continue;
      longest_m = world.length();
      first = world.direction();
    }
    for (const LineLandmark& landmark : map.state.landmarks) {
      const Segment2 world = map.state.worldSegment(landmark);
      const double angle = lineAngleDifference(world.direction(), first);
      if (std::abs(radToDeg(angle) - 45.0) < 2.0) slanted_m += world.length();
    }
    EXPECT_GT(slanted_m, 5.0) << "seed " << seed;
  }
}

/// What an image shows of a segment that lies in the frame of its robot.
std::optional<LineSighting> sightingOf(const Keyframe& keyframe, const Segment2& robot, std::uint64_t id) {
  const auto px = projectSegment(keyframe.intrinsics, keyframe.T_robot_camera,
                                 {{robot.a.x(), robot.a.y(), 0.0}, {robot.b.x(), robot.b.y(), 0.0}});
  if (!px || px->length() < 5.0) return std::nullopt;
  LineSighting sighting;
  sighting.element = id;
  sighting.px = *px;
  return sighting;
}

/// Somebody walks before the robot, and the memory took the foot for an edge of the floor.
void walkAhead(SyntheticDrive& drive, double across_mps, std::uint64_t id) {
  ElementSummary& walker = drive.record.elements[id];
  walker.label = "door_foot";
  walker.confirmed = true;
  constexpr int kFirst = 20;
  for (int k = kFirst; k < kFirst + 30; ++k) {
    Keyframe& keyframe = drive.record.keyframes[static_cast<std::size_t>(k)];
    const double left = -0.15 + across_mps * (k - kFirst - 15);
    const Segment2 foot{{1.6, left}, {1.6, left + 0.3}};
    const auto sighting = sightingOf(keyframe, foot, id);
    if (!sighting) continue;
    keyframe.sightings.push_back(*sighting);
    if (walker.sightings++ == 0) walker.first_keyframe = k;
    walker.last_keyframe = k;
    walker.robot = foot;
  }
  ASSERT_GT(walker.sightings, 5);
}

// Research, section 9: people walk along while the map is made.
TEST(MapGraph, WhoWalksAlongIsNoEdgeAndBendsNothing) {
  const SyntheticDrive alone = drive(ringOfCorridors(), ringWay(kRing_m), {});
  const double error = endError(mapDrive(alone.record, {}, mapperParams()).state, ringOfCorridors(), alone);
  for (const double across_mps : {0.0, 0.05}) {
    constexpr std::uint64_t kWalker = 9999;
    SyntheticDrive visited = alone;
    walkAhead(visited, across_mps, kWalker);
    const DriveMap map = mapDrive(visited.record, {}, mapperParams());
    for (const LineLandmark& landmark : map.state.landmarks)
      EXPECT_EQ(std::count(landmark.elements.begin(), landmark.elements.end(), kWalker), 0)
          << "across " << across_mps;
    EXPECT_LT(endError(map.state, ringOfCorridors(), visited), error + 0.01) << "across " << across_mps;
  }
}

TEST(MapGraph, SolvesTheTiltOfTheCameraWithTheMap) {
  SyntheticDriveParams tilted;
  tilted.mount_pitch_rad = degToRad(0.5);
  const SyntheticDrive ring = drive(ringOfCorridors(), ringWay(kRing_m), tilted);
  const DriveMap map = mapDrive(ring.record, {}, mapperParams());
  // Mount and camera share a pitch that the head's turns tell apart only weakly: their sum counts ahead.
  EXPECT_NEAR(radToDeg(map.state.camera_tilt[1] - map.state.camera_tilt[2]), 0.5, 0.12);
  EXPECT_LT(endError(map.state, ringOfCorridors(), ring), 0.06);
  // Without it the map is wrong.
  DriveMapperParams stiff = mapperParams();
  stiff.graph.tilt.mount_rad = stiff.graph.tilt.camera_rad = 0.0;
  EXPECT_GT(endError(mapDrive(ring.record, {}, stiff).state, ringOfCorridors(), ring),
            1.5 * endError(map.state, ringOfCorridors(), ring));
}

// Research, section 9: without ends nothing measures the way along a corridor but the wheels.
TEST(MapGraph, EndsKeepTheLengthOfACorridor) {
  const auto lengthError = [](const SyntheticDrive& corridor, bool ends) {
    MapState state = initialState(corridor.record, {});
    solveGraph(corridor.record, mapperParams().graph, {.ends = ends}, state);
    const auto length = [](const auto& from, const auto& to) {
      return (to.position() - from.position()).norm();
    };
    return std::abs(length(state.poses.front(), state.poses.back()) -
                    length(corridor.truth.front(), corridor.truth.back()));
  };
  constexpr int kDrives = 60;
  double with = 0.0;
  double without = 0.0;
  for (std::uint64_t seed = 1; seed <= kDrives; ++seed) {
    SyntheticDriveParams params;
    params.scale_error = 0.05;
    params.seed = seed;
    const SyntheticDrive corridor =
        drive(straightCorridor(), wayThrough({{-6.0, 0.0}, {6.0, 0.0}}, 12.0), params);
    with += std::pow(lengthError(corridor, true), 2) / kDrives;
    without += lengthError(corridor, false) / kDrives;
  }
  // One drive errs by 9 cm.
  EXPECT_LT(std::sqrt(with), 0.031);
  EXPECT_GT(without, 0.15);
}

/// Two images of one edge ahead, seen from 0.5 to 2 m; its end a lies under the camera.
DriveRecord edgeFromUnderTheCamera(const LineLandmark& edge, bool censored_a) {
  DriveRecord record;
  for (int k = 0; k < 2; ++k) {
    Keyframe keyframe = lookDown();
    keyframe.way_m = 0.05 * k;
    keyframe.T_odom_robot.x = keyframe.way_m;
    const Pose3 T_world_camera = toPose3(keyframe.T_odom_robot) * keyframe.T_robot_camera;
    const auto px = [&](double x) {
      return projectToIdeal(keyframe.intrinsics, T_world_camera.inverse() * Eigen::Vector3d(x, 0.1, 0.0));
    };
    keyframe.sightings.push_back({edge.elements.front(), {*px(0.5), *px(2.0)}, k == 0 || censored_a, false});
    record.keyframes.push_back(keyframe);
  }
  return record;
}

TEST(MapGraph, AnEndUnderTheCameraIsNotTheOneThatAnImageShowed) {
  LineLandmark edge;
  edge.elements = {1};
  edge.label = "skirting";
  edge.reference = {1.0, 0.1};
  // At a depth of 3 cm in the second image: 1 cm of floor is hundreds of pixels there.
  edge.a = {-1.15, true};
  edge.b = {1.0, true};
  edge.seen = {{0, 0}, {1, 0}};
  const auto shift = [&](bool censored_a) {
    const DriveRecord record = edgeFromUnderTheCamera(edge, censored_a);
    MapState state;
    for (const Keyframe& keyframe : record.keyframes) {
      state.poses.push_back(keyframe.T_odom_robot);
      state.frame_tilts.emplace_back(Eigen::Vector2d::Zero());
    }
    state.landmarks = {edge};
    EXPECT_TRUE(solveGraph(record, mapperParams().graph, {}, state).usable);
    return (state.poses[1].position() - record.keyframes[1].T_odom_robot.position()).norm() +
           std::abs(state.landmarks[0].a.t_m - edge.a.t_m);
  };
  EXPECT_LT(shift(true), 0.001);
  EXPECT_LT(shift(false), 0.001);
}

TEST(MapGraph, TheSameRecordGivesTheSameMap) {
  const SyntheticDrive ring = drive(ringOfCorridors(), ringWay(12.0), {});
  const DriveMap one = mapDrive(ring.record, {}, mapperParams());
  const DriveMap two = mapDrive(ring.record, {}, mapperParams());
  ASSERT_EQ(one.state.landmarks.size(), two.state.landmarks.size());
  for (std::size_t k = 0; k < one.state.poses.size(); ++k) EXPECT_EQ(one.state.poses[k], two.state.poses[k]);
}

TEST(MapGraph, CountsTheEdgesThatALaterVisitSawAgain) {
  const SyntheticDrive part = drive(ringOfCorridors(), ringWay(12.0), {});
  EXPECT_EQ(mapDrive(part.record, {}, mapperParams()).seen_again, 0);
  const SyntheticDrive more = drive(ringOfCorridors(), ringWay(kRing_m + 6.0), {});
  EXPECT_GE(mapDrive(more.record, {}, mapperParams()).seen_again, 5);
}

TEST(MapGraph, StatesAnHonestSigmaOfEnds) {
  double chi2 = 0.0;
  int ends = 0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    SyntheticDriveParams params;
    params.seed = seed;
    const SyntheticDrive hall = drive(ringOfCorridors(), ringWay(6.0), params);
    const DriveMap map = mapDrive(hall.record, {}, mapperParams());
    for (const LineLandmark& landmark : map.state.landmarks) {
      if (!landmark.a.closed || !landmark.b.closed || landmark.sigma_a_m <= 0.0) continue;
      // The length of an edge needs no alignment.
      double nearest = 1e9;
      for (const TrueFloorEdge& edge : ringOfCorridors()) {
        const double off = landmark.segment().length() - edge.world.length();
        if (std::abs(off) < std::abs(nearest)) nearest = off;
      }
      chi2 += nearest * nearest / (std::pow(landmark.sigma_a_m, 2) + std::pow(landmark.sigma_b_m, 2));
      ++ends;
    }
  }
  ASSERT_GT(ends, 30);
  EXPECT_LT(chi2 / ends, 4.0);
}

}  // namespace
}  // namespace vismem
