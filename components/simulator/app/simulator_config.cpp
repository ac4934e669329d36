#include "simulator/app/simulator_config.h"

#include <limits>
#include <sstream>

#include "common/geometry/angles.h"
#include "common/kinematics/kinematics_config.h"

namespace vismem {
namespace {

void readCamera(ConfigReader r, SimulationConfig& s) {
  const int width = static_cast<int>(r.integer("Width_px", 320, 16, 4096));
  const int height = static_cast<int>(r.integer("Height_px", 240, 16, 4096));
  s.intrinsics = intrinsicsFromFieldOfView(width, height, r.angleDeg("HorizontalView_deg", 60.0, 5.0, 150.0));
  const auto d = r.reals("Distortion", {0.0, 0.0, 0.0, 0.0, 0.0}, -2.0, 2.0);
  s.intrinsics.k1 = d[0];
  s.intrinsics.k2 = d[1];
  s.intrinsics.p1 = d[2];
  s.intrinsics.p2 = d[3];
  s.intrinsics.k3 = d[4];
  s.camera_rate_hz = r.real("Rate_hz", s.camera_rate_hz, 0.1, 100.0);
  s.image_noise = r.real("Noise", s.image_noise, 0.0, 50.0);
}

}  // namespace

SimulatorConfig readSimulatorConfig(ConfigReader& config) {
  ConfigReader r = config.group("Simulator");
  SimulatorConfig c;
  c.world_file = r.requirePath("World", "a world file in SDF, such as cfg/worlds/corridor.world");
  std::istringstream folders(r.text("ModelPath", ""));
  for (std::string folder; std::getline(folders, folder, ':');) {
    if (!folder.empty()) c.model_paths.emplace_back(folder);
  }
  SimulationConfig& s = c.simulation;
  s.seed = static_cast<std::uint64_t>(r.integer("Seed", 1, 0, std::numeric_limits<long>::max()));
  const auto start = r.reals("Start.Position_m", {0.0, 0.0}, -1000.0, 1000.0);
  s.start = {start[0], start[1], r.angleDeg("Start.Heading_deg", 0.0, -360.0, 360.0)};
  c.speed = r.real("Speed", 1.0, 0.01, 1000.0);
  c.paused = r.boolean("Paused", false);
  const auto axes = r.reals("Mount.PanTilt.Position_m", {0.0, 0.0, 0.45}, -10.0, 10.0);
  s.mount.T_robot_pantilt = poseFromXyzRpy(axes[0], axes[1], axes[2], 0.0, 0.0, 0.0);
  const auto lens = r.reals("Mount.Camera.Position_m", {0.0, 0.0, 0.0}, -10.0, 10.0);
  s.mount.T_head_camera_body = poseFromXyzRpy(lens[0], lens[1], lens[2], 0.0, 0.0, 0.0);
  readCamera(r.group("Camera"), s);
  readBaseParams(r.group("Base"), s.base);
  readPanTiltParams(r.group("PanTilt"), s.pan_tilt);
  readOdometryErrorParams(r.group("Odometry"), s.odometry);
  return c;
}

}  // namespace vismem
