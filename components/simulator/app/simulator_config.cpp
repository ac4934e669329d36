#include "simulator/app/simulator_config.h"

#include <limits>
#include <sstream>

#include "common/geometry/angles.h"

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

void readBase(ConfigReader r, BaseParams& p) {
  p.limits.max_speed_mps = r.real("MaximumSpeed_mps", p.limits.max_speed_mps, 0.01, 5.0);
  p.limits.max_turn_rate_radps =
      degToRad(r.real("MaximumTurnRate_degps", radToDeg(p.limits.max_turn_rate_radps), 1.0, 720.0));
  p.limits.watchdog_s = r.real("Watchdog_s", p.limits.watchdog_s, 0.05, 60.0);
  p.acceleration_mps2 = r.real("Acceleration_mps2", p.acceleration_mps2, 0.01, 50.0);
  p.turn_acceleration_radps2 =
      degToRad(r.real("TurnAcceleration_degps2", radToDeg(p.turn_acceleration_radps2), 1.0, 10000.0));
  p.radius_m = r.real("Radius_m", p.radius_m, 0.01, 2.0);
  p.wheel_base_m = r.real("WheelBase_m", p.wheel_base_m, 0.01, 2.0);
}

void readPanTilt(ConfigReader r, PanTiltParams& p) {
  PanTiltLimits& l = p.limits;
  l.max_pan_rad = r.angleDeg("Pan.Maximum_deg", radToDeg(l.max_pan_rad), 0.0, 180.0);
  l.min_pan_rad = r.angleDeg("Pan.Minimum_deg", radToDeg(l.min_pan_rad), -180.0, 0.0);
  l.max_tilt_rad = r.angleDeg("Tilt.Maximum_deg", radToDeg(l.max_tilt_rad), 0.0, 90.0);
  l.min_tilt_rad = r.angleDeg("Tilt.Minimum_deg", radToDeg(l.min_tilt_rad), -90.0, 0.0);
  l.max_pan_rate_radps = degToRad(r.real("Pan.Rate_degps", radToDeg(l.max_pan_rate_radps), 1.0, 2000.0));
  l.max_tilt_rate_radps = degToRad(r.real("Tilt.Rate_degps", radToDeg(l.max_tilt_rate_radps), 1.0, 2000.0));
  p.acceleration_radps2 =
      degToRad(r.real("Acceleration_degps2", radToDeg(p.acceleration_radps2), 1.0, 100000.0));
}

void readOdometry(ConfigReader r, OdometryErrorParams& p) {
  enum class Preset { kNone, kDefault };
  const Preset preset =
      r.choice("Preset", Preset::kDefault, {{"none", Preset::kNone}, {"default", Preset::kDefault}});
  p = preset == Preset::kNone ? noOdometryError() : defaultOdometryError();
  p.radius_sigma = r.real("RadiusError", p.radius_sigma, 0.0, 0.2);
  p.base_sigma = r.real("BaseError", p.base_sigma, 0.0, 0.2);
  p.travel_sigma_sqrtm = r.real("TravelNoise_m", p.travel_sigma_sqrtm, 0.0, 0.2);
  p.tick_m = r.real("Tick_m", p.tick_m, 0.0, 0.1);
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
  readBase(r.group("Base"), s.base);
  readPanTilt(r.group("PanTilt"), s.pan_tilt);
  readOdometry(r.group("Odometry"), s.odometry);
  return c;
}

}  // namespace vismem
