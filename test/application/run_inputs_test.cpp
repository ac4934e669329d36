#include "application/app/run_inputs.h"

#include <gmock/gmock.h>

#include "common/routes/route.h"
#include "support/build_paths.h"

namespace vismem {
namespace {

RunOptions simulation() {
  RunOptions options;
  options.root = VISMEM_SOURCE_DIR;
  options.world = options.root / "cfg/worlds/corridor.world";
  options.route = options.root / "cfg/worlds/corridor.route";
  options.map = options.root / "cfg/maps/corridor.csv";
  return options;
}

TEST(RunInputs, TheShippedRouteMapAndRecordingsLoad) {
  EXPECT_NEAR(loadRoute(simulation().route).length(), 26.0, 1e-9);
  const RunMap map = loadRunMap(simulation().map, simulation().root / "cfg/maps/corridor.palette");
  EXPECT_GE(map.edges.segments.size(), map.map.segments.size());
  RunOptions replay = simulation();
  replay.setup = Setup::kReplay;
  replay.folder = "nao";
  replay.bag = "anywhere/nao_field_2009.bag";
  EXPECT_EQ(judgedImages(replay).first, 40);
  EXPECT_EQ(judgedImages(replay).last, 138);
  replay.bag = "other.bag";
  EXPECT_EQ(judgedImages(replay).first, 1);
  replay.bag = "anywhere/nao_field_2009.bag";
  replay.folder = "replay";
  EXPECT_EQ(judgedImages(replay).first, 1) << "a setup without a list";
}

}  // namespace
}  // namespace vismem
