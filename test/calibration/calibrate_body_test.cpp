// calibrate body and calibrate check as a user runs them, on views of an earlier drive. Tests B5.
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "calibration/app/body_files.h"
#include "calibration/calibrate_run.h"
#include "calibration/simulated_board_robot.h"
#include "common/geometry/angles.h"
#include "support/temporary_folder.h"

namespace vismem {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;
namespace fs = std::filesystem;

std::string textOf(const fs::path& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// A setup as it is described, and the views of a drawn robot that turned its head.
class CalibrateBodyTool : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(folder_.path() / "cfg");
    fs::create_directories(folder_.path() / "out");
    std::ofstream(config()) << "# Measured by hand.\n"
                               "ActiveVisualMemory.Camera.Proxy = cameraA:tcp -h 127.0.0.1 -p 9\n"
                               "ActiveVisualMemory.PanTilt.Proxy = PanTilt:tcp -h 127.0.0.1 -p 9\n"
                               "ActiveVisualMemory.Odometry.Proxy = Encoders:tcp -h 127.0.0.1 -p 9\n"
                               "ActiveVisualMemory.Mount.PanTilt.Position_m = 0 0 0.45  # with a tape\n";
    truth_ = drawnRobot(2);
    SimulatedBoardRobot robot(truth_, 2);
    BodyDriveParams params;
    params.rig.mount = describedMount();
    params.drive = false;
    BodyDrive drive(params);
    std::ofstream(folder_.path() / "out" / "body.json") << toJson(robot.run(drive)).dump();
  }

  fs::path config() const { return folder_.path() / "cfg" / "active_visual_memory.cfg"; }
  std::vector<std::string> arguments() const {
    return {"body", "--setup", folder_ / "cfg", "--out", folder_ / "out"};
  }

  TemporaryFolder folder_;
  TrueRobot truth_;
};

TEST_F(CalibrateBodyTool, ShowsChangesAndWritesThemOnRequestOnly) {
  const std::string before = textOf(config());
  const ToolRun shown = runCalibrate(arguments());
  ASSERT_EQ(shown.code, 0) << shown.out << shown.error;
  EXPECT_THAT(shown.out,
              HasSubstr("-5: ActiveVisualMemory.Mount.PanTilt.Position_m = 0 0 0.45  # with a tape"));
  EXPECT_THAT(shown.out, HasSubstr("Nothing was written: add --write."));
  EXPECT_THAT(shown.out, HasSubstr("not observable"));
  EXPECT_EQ(textOf(config()), before);
  EXPECT_FALSE(shown.summary()["written"].get<bool>());
  EXPECT_FALSE(shown.summary()["parameters"]["wheel base"]["observable"].get<bool>());
  EXPECT_FALSE(shown.summary()["parameters"]["wheel base"].contains("value"));

  std::vector<std::string> write = arguments();
  write.push_back("--write");
  const ToolRun written = runCalibrate(write);
  ASSERT_EQ(written.code, 0) << written.out << written.error;
  const std::string after = textOf(config());
  EXPECT_THAT(after, HasSubstr("# Measured by hand."));
  EXPECT_THAT(after, HasSubstr("ActiveVisualMemory.Mount.CalibratedTilt_deg = "));
  EXPECT_THAT(after, HasSubstr("ActiveVisualMemory.Joints.PanScale = "));
  EXPECT_THAT(after, Not(HasSubstr("Wheels.")));
  EXPECT_EQ(textOf(written.summary()["before"].get<std::string>()), before) << "the old file is kept";
  const json height = written.summary()["camera_at_zero"]["camera height"];
  EXPECT_NEAR(height["value"].get<double>(), 1e3 * trueCameraPose(truth_, {}).translation().z(),
              4.0 * height["sigma"].get<double>());
}

TEST_F(CalibrateBodyTool, NamesWhatIsWrong) {
  std::vector<std::string> known = arguments();
  known.insert(known.end(), {"--known", "height=3"});
  const ToolRun unknown = runCalibrate(known);
  EXPECT_EQ(unknown.code, 2);
  EXPECT_THAT(unknown.error, HasSubstr("--known height=3 (must be NAME=VALUE,DEVIATION"));

  std::ofstream(folder_.path() / "out" / "body.json") << "{}";
  const ToolRun damaged = runCalibrate(arguments());
  EXPECT_EQ(damaged.code, 2);
  EXPECT_THAT(damaged.error, HasSubstr("body.json"));

  fs::remove(folder_.path() / "out" / "body.json");
  const ToolRun without = runCalibrate(arguments());
  EXPECT_EQ(without.code, 2);
  EXPECT_THAT(without.error, HasSubstr("--board is missing"));

  const ToolRun nowhere = runCalibrate({"body", "--setup", folder_ / "nothing", "--out", folder_ / "out"});
  EXPECT_EQ(nowhere.code, 2);
  EXPECT_THAT(nowhere.error, HasSubstr("nothing"));
}

TEST_F(CalibrateBodyTool, TheDailyCheckNeedsARunningRobot) {
  std::ofstream(config(), std::ios::app) << "ActiveVisualMemory.Endpoints = tcp -h 127.0.0.1 -p 9\n";
  const ToolRun run = runCalibrate({"check", "--setup", folder_ / "cfg", "--timeout", "1"});
  EXPECT_EQ(run.code, 1);
  EXPECT_THAT(run.error, HasSubstr("active_visual_memory"));
}

}  // namespace
}  // namespace vismem
