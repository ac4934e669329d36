// A drive as the mapper records it. Tests B6.
#include "mapper/app/map_making.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <vector>

#include "common/config/text_file.h"
#include "common/geometry/angles.h"
#include "common/geometry/plane.h"
#include "common/segment_map/segment_map.h"
#include "mapper/core/map_output.h"
#include "support/build_paths.h"
#include "support/data_folder.h"
#include "support/temporary_folder.h"

namespace vismem {
namespace {

const std::filesystem::path kCfg = VISMEM_SOURCE_DIR "/cfg";

/// Some seconds of a drive through the room. @param keys of the memory beside those of cfg/replay.
DriveRecord driven(const std::string& keys) {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "robot.cfg")
      << readTextFile(kCfg / "replay" / "evaluate.cfg", "keys of memory and localization") << keys;
  MapMakingOptions options;
  options.drive.world = (kCfg / "worlds" / "room.world").string();
  options.drive.palette = kCfg / "maps" / "room.palette";
  options.drive.config = folder.path() / "robot.cfg";
  options.drive.out = folder.path();
  options.drive.setup = "sim";
  options.drive.camera_rate_hz = 5.0;
  options.drive.seconds = 8.0;
  return recordDrive(options).record;
}

TEST(MapMaking, TheDriveIsThatOfTheCalibratedRobot) {
  const DriveRecord described = driven("");
  const DriveRecord calibrated =
      driven("\nActiveVisualMemory.Wheels.LeftScale = 0.5\nActiveVisualMemory.Wheels.RightScale = 0.5\n");
  ASSERT_GT(described.keyframes.size(), 2U);
  ASSERT_GT(calibrated.keyframes.size(), 1U);
  EXPECT_NEAR(calibrated.keyframes.back().way_m / described.keyframes.back().way_m, 0.5, 0.1);
}

Pose2 poseOf(const nlohmann::json& values) {
  return {values.at(0).get<double>(), values.at(1).get<double>(), values.at(2).get<double>()};
}

// Research, section 9: the second drive begins on the other side, so its map lies half a turn about.
TEST(MapMaking, ASecondSessionHalfATurnAboutIsPlacedInTheFirst) {
  const TemporaryFolder folder;
  MapMakingOptions options;
  options.drive.world = (kCfg / "worlds" / "room.world").string();
  options.drive.palette = kCfg / "maps" / "room.palette";
  options.drive.setup = "sim";
  options.drive.camera_rate_hz = 5.0;
  options.drive.seconds = 25.0;
  options.close = false;
  options.drive.out = folder.path() / "monday";
  const nlohmann::json first = makeMapFromDrive(options);
  ASSERT_FALSE(first.contains("problems")) << first["problems"];
  options.files.since = folder.path() / "monday" / "map.csv";
  options.drive.out = folder.path() / "tuesday";
  options.drive.start = Pose2{0.5, 1.2, 0.0};
  options.drive.seed = 2;
  const nlohmann::json second = makeMapFromDrive(options);
  ASSERT_FALSE(second.contains("problems")) << second["problems"];
  const Pose2 T_old_map = poseOf(second.at("T_old_map"));
  const Pose2 truth =
      inverse(poseOf(first.at("truth").at("T_world_map"))) * poseOf(second.at("truth").at("T_world_map"));
  EXPECT_GT(std::abs(truth.theta), 3.0) << "the frames are not half a turn apart";
  EXPECT_LT(std::abs(angleDifference(T_old_map.theta, truth.theta)), degToRad(1.5));
  EXPECT_LT((T_old_map.position() - truth.position()).norm(), 0.08);
  EXPECT_TRUE(second.at("changes").empty()) << second.at("changes");
}

/// Centre of the first circle in world.
Eigen::Vector2d centreOf(const MapState& state) {
  const CircleLandmark& circle = state.circles.front();
  return transform(state.poses[static_cast<std::size_t>(circle.anchor)], circle.centre);
}

/// Mean of both edges, of the mapped chords.
double radiusOfCircle(const MapState& state) {
  const Eigen::Vector2d centre = centreOf(state);
  std::array<double, 2> sums{};
  std::array<int, 2> counts{};
  for (const LineLandmark& landmark : state.landmarks) {
    if (!landmark.isChord()) continue;
    const Segment2 world = state.worldSegment(landmark);
    const bool is_left = cross2(world.middle() - centre, world.b - world.a) > 0.0;
    sums[is_left] += 0.5 * ((world.middle() - centre).norm() + (world.a - centre).norm());
    ++counts[is_left];
  }
  return 0.5 * (sums[0] / counts[0] + sums[1] / counts[1]);
}

/// Share of the map's length within 0.1 m of the middle of a true line, with the circle's centre at the
/// field's and one of its lines along the map's longest edge.
double shareOnField(const MapState& state, const SegmentMap& field) {
  const Pose2 T_map_world = mapFrameOf(state);
  const Eigen::Vector2d centre = transform(T_map_world, centreOf(state));
  const auto shareAt = [&](double turn_rad) {
    const Pose2 T_field_map = Pose2{0.0, 0.0, turn_rad} * Pose2{-centre.x(), -centre.y(), 0.0};
    int near = 0;
    int all = 0;
    constexpr double kStep_m = 0.02;
    for (const LineLandmark& landmark : state.landmarks) {
      if (landmark.label == kUnknownLabel || landmark.b.t_m <= landmark.a.t_m) continue;
      const Segment2 edge = transform(T_field_map * T_map_world, state.worldSegment(landmark));
      for (double t = 0.0; t < edge.length(); t += kStep_m, ++all) {
        const Eigen::Vector2d p = edge.a + t * (edge.b - edge.a).normalized();
        near += std::any_of(field.segments.begin(), field.segments.end(), [&](const MapSegment& line) {
          return distanceToSegment(p, line.world.floor()) <= 0.1;
        });
      }
    }
    return static_cast<double>(near) / all;
  };
  constexpr double kQuarter = 0.5 * std::numbers::pi;
  return std::max({shareAt(0.0), shareAt(kQuarter), shareAt(2.0 * kQuarter), shareAt(3.0 * kQuarter)});
}

TEST(MapMaking, ARecordedNaoMapsThePartOfItsFieldThatItSaw) {
  const std::filesystem::path folder = dataFolder() / "nao_field_2009";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is not here: set AVM_DATA";
  MapMakingOptions options;
  options.drive.bag = folder / "nao_field_2009.bag";
  options.drive.setup = "nao";
  const RecordedDrive drive = recordDrive(options);
  const DriveMap map = mapDrive(drive.record, drive.updates, drive.params);
  ASSERT_EQ(map.circles, 1);
  EXPECT_NEAR(radiusOfCircle(map.state), 0.6, 0.04);
  EXPECT_GT(shareOnField(map.state, loadSegmentMap(folder / "map.csv")), 0.7);
}

}  // namespace
}  // namespace vismem
