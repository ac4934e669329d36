/// @file The visual memory on rendered images of a simulated robot, in lock-step.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <optional>
#include <sstream>
#include <utility>
#include <vector>

#include "common/routes/route_follower.h"
#include "common/segment_map/segment_map.h"
#include "common/vision/palette.h"
#include "evaluation/core/lockstep.h"
#include "simulator/core/simulation.h"
#include "support/build_paths.h"

namespace vismem {
namespace {

const std::string kProject = VISMEM_SOURCE_DIR;

Route roomRoute() {
  const std::string file = kProject + "/cfg/worlds/room.route";
  std::ifstream stream(file);
  std::ostringstream text;
  text << stream.rdbuf();
  return parseRoute(text.str(), file);
}

/// A robot in `room` with a camera of 10 Hz, its memory, and an operator that drives it along the room's
/// route.
class RoomRun {
 public:
  explicit RoomRun(std::uint64_t seed, const Pose2& start)
      : simulation_(config(seed, start)),
        palette_(std::make_shared<Palette>(loadPalette(kProject + "/cfg/maps/room.palette"))),
        memory_(MemoryPipelineParams::standard(), palette_),
        localizer_(localizerPreset(LocalizationMode::kDefault),
                   loadSegmentMap(kProject + "/cfg/maps/room.csv"), seed),
        run_(simulation_, assembler(simulation_), memory_, &localizer_),
        operator_(roomRoute(), {}) {
    run_.setDriver([this](MobileBase& base) {
      if (!driving_) return;
      const DriveCommand command = operator_.drive(simulation_.truth().T_world_robot);
      base.setVelocity(command.v_mps, command.w_radps);
    });
  }

  void drive(bool driving) { driving_ = driving; }
  void kidnap(const Pose2& place) {
    ASSERT_TRUE(simulation_.kidnap(place).ok());
    operator_.lost();
  }

  /// @return stamps at which the memory was set aside.
  std::vector<StampUs> run(double seconds) {
    std::vector<StampUs> set_aside;
    const StampUs end = simulation_.now() + toStampUs(seconds);
    while (simulation_.now() < end) {
      run_.step([&](const LockstepFrame& frame) {
        if (frame.memory.kidnapped) set_aside.push_back(frame.observation.frame.stamp_us);
        snapshot_ = frame.memory.update.snapshot;
      });
    }
    return set_aside;
  }

  StampUs now() const { return simulation_.now(); }
  const MemorySnapshot& snapshot() const { return *snapshot_; }

 private:
  static SimulationConfig config(std::uint64_t seed, const Pose2& start) {
    SimulationConfig config;
    config.world = loadWorld(kProject + "/cfg/worlds/room.world").world;
    config.seed = seed;
    config.start = start;
    config.cameras.front().rate_hz = 10.0;
    return config;
  }
  static ObservationAssembler::Params assembler(const Simulation& simulation) {
    ObservationAssembler::Params params;
    params.mount = simulation.config().mount();
    return params;
  }

  Simulation simulation_;
  std::shared_ptr<const Palette> palette_;
  MemoryPipeline memory_;
  Localizer localizer_;
  Lockstep run_;
  SimulatedOperator operator_;
  bool driving_ = false;
  std::shared_ptr<const MemorySnapshot> snapshot_;
};

TEST(RenderedMemory, IsSetAsideSoonAfterTheRobotWasMovedByHand) {
  for (const std::uint64_t seed : {1, 2, 3, 5}) {
    RoomRun room(seed, {0.0, 0.2, 0.0});
    room.drive(true);
    EXPECT_TRUE(room.run(20.0).empty()) << "seed " << seed;
    room.drive(false);
    room.run(1.0);
    const StampUs moved = room.now();
    room.kidnap({-0.9, 0.4, 2.5});
    const auto set_aside = room.run(15.0);
    ASSERT_EQ(set_aside.size(), 1U) << "seed " << seed;
    std::printf("seed %d: set aside after %.1f s\n", static_cast<int>(seed), toSeconds(set_aside[0] - moved));
    EXPECT_LT(toSeconds(set_aside[0] - moved), 12.0) << "seed " << seed;
    EXPECT_EQ(room.snapshot().epoch, 1U);
  }
}

TEST(RenderedMemory, IsKeptWhileTheRobotDrivesAndHoldsTheShapesOnTheFloor) {
  RoomRun room(1, {0.0, 0.2, 0.0});
  room.drive(true);
  EXPECT_TRUE(room.run(40.0).empty());
  // In the room's frame, moved to the robot's start; odometry drifts by a few decimetres in this time.
  const std::vector<std::pair<PrimitiveKind, Eigen::Vector2d>> painted{
      {PrimitiveKind::kParallelogram, {-1.5, 0.9}}, {PrimitiveKind::kParallelogram, {0.975, 0.825}},
      {PrimitiveKind::kTriangle, {-1.77, -0.8}},    {PrimitiveKind::kArrow, {-0.35, -1.1}},
      {PrimitiveKind::kCircle, {1.5, -0.8}},
  };
  for (const auto& [kind, place] : painted) {
    double nearest = 10.0;
    for (const Primitive& shape : room.snapshot().primitives) {
      if (shape.kind == kind) nearest = std::min(nearest, (shape.centre - place).norm());
    }
    EXPECT_LT(nearest, 0.7) << "kind " << static_cast<int>(kind);
  }
}

}  // namespace
}  // namespace vismem
