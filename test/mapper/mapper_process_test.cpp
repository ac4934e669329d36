// The live mapper as a process: a simulated drive in lock-step, maps on request. Tests B6, C2, C3.
#include <Ice/Ice.h>
#include <avm/mapper.h>
#include <avm/simulation.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "common/geometry/segment.h"
#include "common/segment_map/segment_map.h"
#include "support/build_paths.h"
#include "support/component_process.h"
#include "support/eventually.h"
#include "support/ice_client.h"
#include "support/temporary_folder.h"

namespace vismem {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

std::string cfg(const std::string& name) {
  return "--Ice.Config=" VISMEM_SOURCE_DIR "/cfg/sim/" + name + ".cfg";
}

/// Share of the mapped length that lies within 5 cm of an edge of its label.
double shareOnTruth(const SegmentMap& map, const Pose2& T_world_map, const SegmentMap& truth) {
  constexpr double kNear_m = 0.05;
  constexpr double kStep_m = 0.02;
  int near = 0;
  int all = 0;
  for (const MapSegment& row : map.segments) {
    const Segment2 edge = transform(T_world_map, row.world.floor());
    for (double t = 0.0; t < edge.length(); t += kStep_m, ++all) {
      const Eigen::Vector2d p = edge.a + t * (edge.b - edge.a).normalized();
      near += std::any_of(truth.segments.begin(), truth.segments.end(), [&](const MapSegment& each) {
        return each.label == row.label && distanceToSegment(p, each.world.floor()) <= kNear_m;
      });
    }
  }
  return all == 0 ? 0.0 : static_cast<double>(near) / all;
}

class MapperProcessTest : public testing::Test {
 protected:
  std::unique_ptr<ComponentProcess> start(const std::string& name, std::vector<std::string> arguments) {
    ChildProcess::Options options;
    options.working_directory = VISMEM_SOURCE_DIR;
    auto process = std::make_unique<ComponentProcess>(name, std::move(arguments), std::move(options));
    EXPECT_TRUE(process->waitUntilReady());
    return process;
  }

  /// A robot that goes along one side of the ring and waits for memory and mapper with every image.
  void startRobot() {
    std::ofstream(folder_ / "drive.scenario")
        << "scenario 1\nat 0 drive way=open speed_mps=0.3 points_m=3,2.25;-3,2.25\n";
    simulator_ =
        start("simulator", {cfg("simulator"), "--Simulator.Endpoints=tcp -h 127.0.0.1 -p 0",
                            "--Simulator.Paused=yes", "--Simulator.Seed=3", "--Simulator.Camera.Rate_hz=10",
                            "--Simulator.Scenario=" + (folder_ / "drive.scenario")});
    memory_ = start("active_visual_memory",
                    {cfg("active_visual_memory"), "--ActiveVisualMemory.Endpoints=tcp -h 127.0.0.1 -p 0",
                     "--ActiveVisualMemory.Camera.Proxy=" + simulator_->proxy("cameraA"),
                     "--ActiveVisualMemory.PanTilt.Proxy=" + simulator_->proxy("PanTilt"),
                     "--ActiveVisualMemory.Odometry.Proxy=" + simulator_->proxy("Encoders")});
    mapper_ = start("mapper", {cfg("mapper"), "--Mapper.Endpoints=tcp -h 127.0.0.1 -p 0",
                               "--Mapper.VisualMemory.Proxy=" + memory_->proxy("VisualMemory"),
                               "--Mapper.Camera.Proxy=" + simulator_->proxy("cameraA"),
                               "--Mapper.Folder=" + (folder_ / "maps")});
    control_ = ice_.find<avm::MapperPrx>(*mapper_, "Mapper");
    simulation_ = ice_.find<avm::SimulationPrx>(*simulator_, "Simulation");
  }
  void driveUntil(double way_m) {
    simulation_->setLockStep(2);
    simulation_->setPaused(false);
    EXPECT_TRUE(eventually([&] { return control_->status().wayM >= way_m; })) << control_->status().message;
    simulation_->setLockStep(0);
    simulation_->setPaused(true);
  }
  /// @param name as of avm::Mapper::build.
  avm::MapReport built(const std::string& name) {
    const int before = control_->status().built;
    control_->build(name);
    EXPECT_TRUE(eventually([&] { return control_->status().built > before; }));
    return control_->status().last;
  }

  TemporaryFolder folder_;
  IceClient ice_;
  std::unique_ptr<ComponentProcess> simulator_;
  std::unique_ptr<ComponentProcess> memory_;
  std::unique_ptr<ComponentProcess> mapper_;
  std::shared_ptr<avm::MapperPrx> control_;
  std::shared_ptr<avm::SimulationPrx> simulation_;
};

TEST_F(MapperProcessTest, ADriveUnderWayBecomesAMapOnRequest) {
  startRobot();
  driveUntil(4.5);
  const avm::MapReport report = built("");
  EXPECT_THAT(report.problems, testing::IsEmpty());
  EXPECT_EQ(report.file, folder_ / "maps/map.csv");
  EXPECT_GE(report.wayM, 4.5);
  const SegmentMap map = loadSegmentMap(report.file);
  EXPECT_EQ(map.segments.size(), static_cast<std::size_t>(report.edges));
  EXPECT_GE(report.edges, 8);
  // The frame of the map begins where the drive did, along the corridor: which way is left open.
  const SegmentMap truth = loadSegmentMap(VISMEM_SOURCE_DIR "/cfg/maps/corridor.csv");
  const Pose2 start{3.0, 2.25, 0.0};
  EXPECT_GE(std::max(shareOnTruth(map, start, truth),
                     shareOnTruth(map, start * Pose2{0.0, 0.0, std::numbers::pi}, truth)),
            0.9);
  for (const char* ending :
       {".palette", ".svg", ".dxf", ".pgm", ".yaml", ".json", ".drive", ".history", ".png"})
    EXPECT_TRUE(fs::exists(folder_ / "maps/map" + ending)) << ending;

  // The drive goes on, and the next map has more of it.
  driveUntil(5.5);
  EXPECT_GE(built("again").wayM, 5.5);
  EXPECT_TRUE(fs::exists(folder_ / "maps/again.csv"));
}

TEST_F(MapperProcessTest, WhatWasDrivenSinceTheLastMapIsKeptAtTheEnd) {
  startRobot();
  EXPECT_THROW(control_->build(""), avm::Refused);
  EXPECT_THROW(control_->build("../elsewhere"), avm::InvalidArgument);
  driveUntil(1.5);
  control_->restart();
  EXPECT_TRUE(eventually([&] { return control_->status().wayM < 1.0; }));
  driveUntil(1.0);
  mapper_->signal(SIGTERM);
  EXPECT_EQ(mapper_->waitForExit(kPatience), 0);
  EXPECT_TRUE(fs::exists(folder_ / "maps/map_last.drive"));
}

TEST_F(MapperProcessTest, WaitsForItsPeersAndSaysSo) {
  mapper_ = start("mapper", {cfg("mapper"), "--Mapper.Endpoints=tcp -h 127.0.0.1 -p 0",
                             "--Mapper.VisualMemory.Proxy=VisualMemory:tcp -h 127.0.0.1 -p 1",
                             "--Mapper.Camera.Proxy=cameraA:tcp -h 127.0.0.1 -p 1",
                             "--Mapper.Folder=" + (folder_ / "maps")});
  control_ = ice_.find<avm::MapperPrx>(*mapper_, "Mapper");
  EXPECT_THAT(control_->status().message, HasSubstr("no update of the memory"));
  try {
    control_->build("");
    FAIL() << "a map of nothing";
  } catch (const avm::Refused& refused) {
    EXPECT_THAT(refused.reason, HasSubstr("nothing is recorded yet"));
  }
}

}  // namespace
}  // namespace vismem
