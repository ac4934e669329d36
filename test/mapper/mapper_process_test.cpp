// The live mapper as a process: a simulated drive in lock-step, maps on request. Tests B6, C2, C3.
#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>

#include "common/geometry/segment.h"
#include "common/segment_map/segment_map.h"
#include "live_mapper.h"

namespace vismem {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

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

/// Along one side of the ring.
const LiveMapper::Drive kSide{"corridor", "3 2.25", "180", "way=open points_m=3,2.25;-3,2.25"};

TEST(MapperProcess, ADriveUnderWayBecomesAMapOnRequest) {
  const TemporaryFolder folder;
  LiveMapper live(folder, kSide);
  live.driveUntil(4.5);
  const avm::MapReport report = live.built("");
  EXPECT_THAT(report.problems, testing::IsEmpty());
  EXPECT_EQ(report.file, folder / "maps/map.csv");
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
    EXPECT_TRUE(fs::exists(folder / "maps/map" + ending)) << ending;

  // The drive goes on, and the next map has more of it.
  live.driveUntil(5.5);
  EXPECT_GE(live.built("again").wayM, 5.5);
  EXPECT_TRUE(fs::exists(folder / "maps/again.csv"));
}

TEST(MapperProcess, WhatWasDrivenSinceTheLastMapIsKeptAtTheEnd) {
  const TemporaryFolder folder;
  LiveMapper live(folder, kSide);
  EXPECT_THROW(live.control().build("../elsewhere"), avm::InvalidArgument);
  live.driveUntil(1.5);
  live.control().restart();
  EXPECT_TRUE(eventually([&] { return live.control().status().wayM < 1.0; }));
  live.driveUntil(1.0);
  live.mapper().signal(SIGTERM);
  EXPECT_EQ(live.mapper().waitForExit(kPatience), 0);
  EXPECT_TRUE(fs::exists(folder / "maps/map_last.drive"));
}

TEST(MapperProcess, WaitsForItsPeersAndSaysSo) {
  const TemporaryFolder folder;
  IceClient ice;
  const auto mapper =
      startComponent("mapper", {simConfiguration("mapper"), "--Mapper.Endpoints=tcp -h 127.0.0.1 -p 0",
                                "--Mapper.VisualMemory.Proxy=VisualMemory:tcp -h 127.0.0.1 -p 1",
                                "--Mapper.Camera.Proxy=cameraA:tcp -h 127.0.0.1 -p 1",
                                "--Mapper.Folder=" + (folder / "maps")});
  const auto control = ice.find<avm::MapperPrx>(*mapper, "Mapper");
  EXPECT_THAT(control->status().message, HasSubstr("no update of the memory"));
  try {
    control->build("");
    FAIL() << "a map of nothing";
  } catch (const avm::Refused& refused) {
    EXPECT_THAT(refused.reason, HasSubstr("nothing is recorded yet"));
  }
}

}  // namespace
}  // namespace vismem
