// Tests C1, C2. A minute of the simulated robot in lock-step, recorded, and evaluated again from the
// recording alone.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "common/recording/robot_log.h"
#include "evaluation/app/evaluation.h"
#include "support/build_paths.h"
#include "support/temporary_folder.h"

namespace vismem {
namespace {

/// Lines of a TUM trajectory: t x y z qx qy qz qw.
std::vector<std::array<double, 8>> readTum(const std::string& file) {
  std::vector<std::array<double, 8>> poses;
  std::ifstream lines(file);
  for (std::string line; std::getline(lines, line);) {
    if (line.empty() || line.front() == '#') continue;
    std::istringstream fields(line);
    std::array<double, 8> pose{};
    for (double& value : pose) fields >> value;
    poses.push_back(pose);
  }
  return poses;
}

TEST(LockstepRoundTrip, ARecordedMinuteGivesTheSameTrajectory) {
  const TemporaryFolder folder;
  EvaluationOptions run;
  run.world = VISMEM_SOURCE_DIR "/cfg/worlds/corridor.world";
  run.map = VISMEM_SOURCE_DIR "/cfg/maps/corridor.csv";
  run.out = folder / "run";
  run.record = folder / "recording";
  run.seed = 3;
  run.seconds = 60.0;
  const nlohmann::json first = evaluate(run);
  EvaluationOptions replay;
  replay.bag = folder / "recording";
  replay.map = run.map;
  replay.out = folder / "replay";
  replay.seed = 3;
  const nlohmann::json second = evaluate(replay);
  EXPECT_EQ(RobotLog::open(replay.bag.string()).notes(), std::vector<std::string>{});

  for (const char* name : {"odometry.tum", "trajectory.tum", "truth.tum"}) {
    const auto expected = readTum(folder / (std::string("run/") + name));
    const auto found = readTum(folder / (std::string("replay/") + name));
    ASSERT_GT(expected.size(), 500u) << name;
    ASSERT_EQ(found.size(), expected.size()) << name;
    double worst_m = 0.0;
    double worst_rad = 0.0;
    for (std::size_t i = 0; i < expected.size(); ++i) {
      ASSERT_EQ(found[i][0], expected[i][0]) << name << ": stamp of line " << i;
      worst_m = std::max(worst_m, std::hypot(found[i][1] - expected[i][1], found[i][2] - expected[i][2]));
      const double turn =
          2.0 * (std::atan2(found[i][6], found[i][7]) - std::atan2(expected[i][6], expected[i][7]));
      worst_rad = std::max(worst_rad, std::abs(std::remainder(turn, 2.0 * M_PI)));
    }
    std::cout << name << ": " << expected.size() << " poses, at most " << worst_m << " m and " << worst_rad
              << " rad apart\n";
    EXPECT_LE(worst_m, 1e-6) << name;
    EXPECT_LE(worst_rad, 1e-6) << name;
  }
  EXPECT_EQ(first.at("memory_segments"), second.at("memory_segments"));
  EXPECT_EQ(first.at("frames"), second.at("frames"));
}

}  // namespace
}  // namespace vismem
