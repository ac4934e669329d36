// A floor of 240 m with alike wings and three loops: time and shape. Tests B6.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <random>

#include "common/geometry/angles.h"
#include "drive_score.h"
#include "mapper/core/drive_mapper.h"
#include "synthetic_drive.h"

namespace vismem {
namespace {

/// Closings with the errors of races where the way comes by a place again after 20 m.
std::vector<Closing> closingsOf(const SyntheticDrive& floor, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::vector<Closing> closings;
  double next_m = 0.0;
  for (int to = 0; to < static_cast<int>(floor.truth.size()); ++to) {
    const double way = floor.record.keyframes[static_cast<std::size_t>(to)].way_m;
    if (way < next_m) continue;
    for (int from = 0; from < to; ++from) {
      if (way - floor.record.keyframes[static_cast<std::size_t>(from)].way_m < 20.0) break;
      const Pose2 between =
          inverse(floor.truth[static_cast<std::size_t>(from)]) * floor.truth[static_cast<std::size_t>(to)];
      if (between.position().norm() > 0.2 || std::abs(between.theta) > 0.3) continue;
      Closing closing{from, to,
                      between * Pose2{0.02 * normal(random), 0.02 * normal(random), 0.01 * normal(random)},
                      Eigen::Vector3d(0.0009, 0.0009, 0.0002).asDiagonal()};
      closings.push_back(closing);
      next_m = way + 1.0;
      break;
    }
  }
  return closings;
}

TEST(LargeFloor, KeepsItsShapeAndSolvesInSeconds) {
  const SyntheticDrive floor = drive(threeBlocks(), threeLoops(), {});
  const auto closings = closingsOf(floor, 1);
  ASSERT_GT(closings.size(), 20u);
  DriveMapperParams params;
  params.graph.odometry.turn_noise = 0.008;
  const DriveMap map = mapDriveAgain(floor.record, closings, params);
  ASSERT_EQ(map.problem, "");
  const MapScore score = scoreOf(map.state, threeBlocks(), floor);
  RecordProperty("solver_ms", static_cast<int>(1000 * map.seconds));
  RecordProperty("worst_piece_mm", static_cast<int>(1000 * score.worst_piece_rms_m));
  RecordProperty("ends_mm", static_cast<int>(1000 * score.ends_rms_m));
  std::printf("solver %.2f s, ends RMS %.1f cm, worst 5 m piece %.1f cm, %zu landmarks\n", map.seconds,
              100.0 * score.ends_rms_m, 100.0 * score.worst_piece_rms_m, map.state.landmarks.size());
  EXPECT_GT(score.ends, 100);
  EXPECT_LT(score.worst_piece_rms_m, 0.10);
}

// Where the visits of a place lie decimetres apart, a merge brings others near enough.
TEST(LargeFloor, MergesTheVisitsOfAPlaceWithoutClosings) {
  for (const std::uint64_t seed : {1, 3}) {
    SyntheticDriveParams noisy;
    noisy.seed = seed;
    noisy.pixel_sigma = 2.0;
    const SyntheticDrive floor = drive(threeBlocks(), threeLoops(), noisy);
    DriveMapperParams params;
    params.graph.odometry.turn_noise = 0.008;
    const DriveMap map = mapDrive(floor.record, {}, params);
    const MapScore score = scoreOf(map.state, threeBlocks(), floor);
    EXPECT_LT(score.edges.duplicates(), 1.05) << "seed " << seed;
    EXPECT_GT(map.seen_again, 100) << "seed " << seed;
    EXPECT_LT(score.worst_piece_rms_m, 0.10) << "seed " << seed;
  }
}

}  // namespace
}  // namespace vismem
