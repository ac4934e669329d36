// The keys of the simulator, and every shipped configuration and scenario.
#include "simulator/app/simulator_config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "common/config/config_error.h"
#include "simulator/core/scenario.h"
#include "support/build_paths.h"
#include "support/temporary_folder.h"

namespace vismem {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

const fs::path kCfg = VISMEM_SOURCE_DIR "/cfg";

SimulatorConfig read(Properties properties) {
  ConfigReader config(properties);
  for (const char* key : {"Simulator.Endpoints", "Simulator.WebEndpoints", "Ice.*"}) config.known(key);
  SimulatorConfig result = readSimulatorConfig(config);
  config.finish();
  return result;
}

SimulatorConfig parsed(const std::string& lines) {
  return read(Properties::parse(
      "Simulator.World = " + (kCfg / "worlds/corridor.world").string() + "\n" + lines, "test.cfg"));
}

TEST(SimulatorConfig, OfTheSetupSimSaysTheDefaults) {
  const SimulatorConfig config = read(Properties::load(kCfg / "sim/simulator.cfg"));
  const SimulationConfig plain;
  EXPECT_FALSE(config.simulation.walk);
  ASSERT_EQ(config.simulation.cameras.size(), 1U);
  const SimulatedCameraParams& camera = config.simulation.cameras.front();
  const SimulatedCameraParams& standard = plain.cameras.front();
  EXPECT_NEAR(camera.intrinsics.fx, standard.intrinsics.fx, 1e-9);
  EXPECT_EQ(camera.intrinsics.cx, standard.intrinsics.cx);
  EXPECT_EQ(camera.rate_hz, standard.rate_hz);
  EXPECT_EQ(camera.latency_s, standard.latency_s);
  EXPECT_EQ(camera.reports_pose, standard.reports_pose);
  EXPECT_EQ(camera.errors.gaussian, standard.errors.gaussian);
  EXPECT_TRUE(config.simulation.T_robot_pantilt.isApprox(plain.T_robot_pantilt));
  EXPECT_EQ(config.simulation.base.limits.watchdog_s, plain.base.limits.watchdog_s);
  EXPECT_EQ(config.simulation.odometry.radius_sigma, plain.odometry.radius_sigma);
  EXPECT_EQ(config.simulation.odometry.slips_per_m, 0.0);
  EXPECT_EQ(config.lock_step, 0);
  EXPECT_EQ(config.render_threads, 1);
  EXPECT_TRUE(config.scenario.empty());
}

TEST(SimulatorConfig, OfTheHumanoidIsALateCameraThatIsBadlyCalibrated) {
  const SimulatorConfig config = read(Properties::load(kCfg / "humanoid/simulator.cfg"));
  const SimulationConfig plain = humanoidSimulation();
  ASSERT_TRUE(config.simulation.walk);
  EXPECT_NEAR(config.simulation.walk->roll_rad, plain.walk->roll_rad, 1e-12);
  EXPECT_EQ(config.simulation.walk->step_s, plain.walk->step_s);
  EXPECT_EQ(config.simulation.base.limits.watchdog_s, plain.base.limits.watchdog_s);
  EXPECT_EQ(config.simulation.odometry.travel_sigma_sqrtm, plain.odometry.travel_sigma_sqrtm);
  EXPECT_EQ(config.simulation.odometry.slip_m, plain.odometry.slip_m);
  const SimulatedCameraParams& camera = config.simulation.cameras.front();
  EXPECT_TRUE(camera.reports_pose);
  EXPECT_EQ(camera.latency_s, 0.1);
  const Eigen::Vector3d ahead = camera.T_believed_true.linear() * Eigen::Vector3d::UnitX();
  EXPECT_NEAR(std::asin(ahead.z()), degToRad(-0.5), 1e-12) << "further down than it thinks";
}

TEST(SimulatorConfig, MoreCamerasAreLikeTheFirstWhereTheySayNothing) {
  const SimulatorConfig config = parsed(
      "Simulator.Camera.Width_px = 640\n"
      "Simulator.Camera.Height_px = 480\n"
      "Simulator.Camera.HorizontalView_deg = 75\n"
      "Simulator.Camera.Distortion = -0.2 0.05 0 0 0\n"
      "Simulator.Cameras.cameraB.Position_m = 0 -0.12 0\n"
      "Simulator.Cameras.rear.Carrier = robot\n"
      "Simulator.Cameras.rear.Position_m = -0.2 0 0.3\n"
      "Simulator.Cameras.rear.Rotation_deg = 0 0 180\n"
      "Simulator.Cameras.rear.Rate_hz = 5\n"
      "Simulator.Cameras.rear.Depth = yes\n");
  const auto& cameras = config.simulation.cameras;
  ASSERT_EQ(cameras.size(), 3U);
  EXPECT_EQ(cameras[1].name, "cameraB");
  EXPECT_TRUE(cameras[1].on_head);
  EXPECT_EQ(cameras[1].intrinsics.width, 640);
  EXPECT_NEAR(cameras[1].intrinsics.fx, cameras[0].intrinsics.fx, 1e-9);
  EXPECT_EQ(cameras[1].intrinsics.k1, -0.2);
  EXPECT_EQ(cameras[1].T_carrier_camera_body.translation(), Eigen::Vector3d(0, -0.12, 0));
  EXPECT_EQ(cameras[2].name, "rear");
  EXPECT_FALSE(cameras[2].on_head);
  EXPECT_EQ(cameras[2].rate_hz, 5.0);
  EXPECT_TRUE(cameras[2].depth);
  EXPECT_FALSE(cameras[1].depth);
}

TEST(SimulatorConfig, ReportsAndTruthMayDiffer) {
  const TemporaryFolder folder;
  std::ofstream(folder / "lens.yaml") << "image_width: 320\nimage_height: 240\n"
                                         "camera_matrix: {data: [300, 0, 160, 0, 301, 120, 0, 0, 1]}\n";
  const SimulatorConfig config = parsed("Simulator.Camera.Calibration = " + (folder / "lens.yaml") +
                                        "\n"
                                        "Simulator.Cameras.rear.Carrier = robot\n"
                                        "Simulator.PanTilt.Pan.Backlash_deg = 0.3\n"
                                        "Simulator.Joints.TiltScale = 1.02\n"
                                        "Simulator.Joints.Delay_s = 0.03\n"
                                        "Simulator.Wheels.LeftScale = 0.99\n"
                                        "Simulator.Base.WheelBase_m = 0.35\n"
                                        "Simulator.Wheels.ReportedBase_m = 0.33\n");
  const SimulationConfig& s = config.simulation;
  ASSERT_TRUE(s.cameras[0].stated_intrinsics);
  EXPECT_EQ(s.cameras[0].stated_intrinsics->fy, 301.0);
  EXPECT_NEAR(s.cameras[0].intrinsics.fx, SimulationConfig().cameras[0].intrinsics.fx, 1e-9);
  EXPECT_FALSE(s.cameras[1].stated_intrinsics);
  EXPECT_NEAR(s.pan_tilt.backlash_rad.pan_rad, degToRad(0.3), 1e-12);
  EXPECT_EQ(s.joints.tilt_scale, 1.02);
  EXPECT_EQ(s.joints.delay_us, 30'000);
  EXPECT_EQ(s.wheels.model, (WheelModel{0.99, 1.0, 0.35}));
  EXPECT_EQ(s.wheels.reported_base_m, 0.33);
}

TEST(SimulatorConfig, ACalibrationMustFitTheImages) {
  const TemporaryFolder folder;
  std::ofstream(folder / "lens.yaml") << "image_width: 640\nimage_height: 480\n"
                                         "camera_matrix: {data: [300, 0, 160, 0, 300, 120, 0, 0, 1]}\n";
  std::ofstream(folder / "no_lens.yaml") << "image_width: 640\n";
  const auto message = [&](const std::string& file) -> std::string {
    try {
      parsed("Simulator.Camera.Calibration = " + (folder / file) + "\n");
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_THAT(message("lens.yaml"), HasSubstr("calibration for 640x480 pixels (must be 320x240, as its images)"));
  EXPECT_THAT(message("no_lens.yaml"), HasSubstr("missing key \"image_height\""));
  EXPECT_THAT(message("none.yaml"), HasSubstr("none.yaml"));
}

TEST(SimulatorConfig, ReportsPoseIsAcceptedUnderItsOldNameToo) {
  const std::string renamed = "TellsPose";  // the old name
  const SimulatorConfig config =
      parsed("Simulator.Camera." + renamed + " = yes\nSimulator.Cameras.rear." + renamed + " = no\n");
  ASSERT_EQ(config.simulation.cameras.size(), 2U);
  EXPECT_TRUE(config.simulation.cameras[0].reports_pose);
  EXPECT_FALSE(config.simulation.cameras[1].reports_pose);
}

TEST(SimulatorConfig, SaysWhatIsWrong) {
  try {
    parsed(
        "Simulator.Camera.Width_px = 0\n"
        "Simulator.Camera.Rate_hz = nan\n"
        "Simulator.Cameras.b.Latency_s = -1\n"
        "Simulator.Cameras.b.Latenc_s = 1\n"
        "Simulator.Odometry.Preset = perfect\n"
        "Simulator.Walk.Step_s = 1\n");
    FAIL() << "should have been refused";
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), HasSubstr("test.cfg:2: Simulator.Camera.Width_px = 0 (must be 16..4096)"));
    EXPECT_THAT(error.what(), HasSubstr("test.cfg:3: Simulator.Camera.Rate_hz = nan"));
    EXPECT_THAT(error.what(), HasSubstr("test.cfg:4: Simulator.Cameras.b.Latency_s = -1 (must be 0..5)"));
    EXPECT_THAT(error.what(), HasSubstr("test.cfg:5: unknown key \"Simulator.Cameras.b.Latenc_s\""));
    EXPECT_THAT(error.what(), HasSubstr("must be one of: none, default, stage, thrun"));
    EXPECT_THAT(error.what(), HasSubstr("test.cfg:7: unknown key \"Simulator.Walk.Step_s\""))
        << "of a humanoid only";
  }
}

TEST(SimulatorConfig, EveryShippedScenarioReads) {
  int read_ones = 0;
  for (const auto& entry : fs::directory_iterator(kCfg / "scenarios")) {
    std::ostringstream text;
    text << std::ifstream(entry.path()).rdbuf();
    EXPECT_GT(parseScenario(text.str(), entry.path().string()).events.size(), 0U) << entry.path();
    ++read_ones;
  }
  EXPECT_GT(read_ones, 0);
}

}  // namespace
}  // namespace vismem
