// A drive as the mapper records it. Tests B6.
#include "mapper/app/map_making.h"

#include <gtest/gtest.h>

#include <fstream>

#include "common/config/text_file.h"
#include "support/build_paths.h"
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
  const DriveRecord calibrated = driven(
      "\nActiveVisualMemory.Wheels.LeftScale = 0.5\nActiveVisualMemory.Wheels.RightScale = 0.5\n");
  ASSERT_GT(described.keyframes.size(), 2U);
  ASSERT_GT(calibrated.keyframes.size(), 1U);
  EXPECT_NEAR(calibrated.keyframes.back().way_m / described.keyframes.back().way_m, 0.5, 0.1);
}

}  // namespace
}  // namespace vismem
