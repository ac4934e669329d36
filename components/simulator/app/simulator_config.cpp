#include "simulator/app/simulator_config.h"

#include <cmath>
#include <limits>
#include <sstream>

#include "camera_server/core/camera_info.h"
#include "common/config/config_error.h"
#include "common/config/text_file.h"
#include "common/geometry/angles.h"
#include "common/geometry/distortion.h"
#include "common/kinematics/kinematics_config.h"

namespace vismem {
namespace {

Pose3 readPose(ConfigReader& r, const std::string& prefix, const Pose3& fallback) {
  const Eigen::Vector3d& at = fallback.translation();
  const auto p = r.reals(prefix + "Position_m", {at.x(), at.y(), at.z()}, -10.0, 10.0);
  const auto turn = r.reals(prefix + "Rotation_deg", {0.0, 0.0, 0.0}, -360.0, 360.0);
  return poseFromXyzRpy(p[0], p[1], p[2], degToRad(turn[0]), degToRad(turn[1]), degToRad(turn[2]));
}

/// The lens that frames state.
void readStatedLens(ConfigReader& r, SimulatedCameraParams& camera) {
  const auto file = r.existingFile("Calibration", "a calibration of a camera as ROS writes it");
  std::error_code absent;
  if (!std::filesystem::is_regular_file(file, absent)) return;
  try {
    camera.stated_intrinsics =
        parseCameraInfo(readTextFile(file, "a calibration of a camera as ROS writes it"), file.string());
  } catch (const ConfigError& error) {
    for (const auto& problem : error.problems()) r.problem("Calibration", problem);
  }
}

/// The keys of one camera.
void describeCamera(ConfigReader& r) {
  r.describe(
      {basic("Width_px", "of the images"), basic("Height_px", "of the images"),
       basic("HorizontalView_deg", "angle of view, where Pinhole_px is not set"),
       expert("Pinhole_px", "focal lengths and principal point: fx fy cx cy"),
       basic("Distortion", "k1 k2 p1 p2 k3, as in OpenCV"),
       expert("Calibration", "lens that the frames state: a camera_info file of ROS; empty: the true one"),
       basic("Rate_hz", "images a second of simulated time"),
       basic("Latency_s", "from the exposure to the delivery"),
       basic("Noise", "standard deviation of the read noise, in grey levels"),
       basic("ShotNoise", "standard deviation of the photon noise on white, in grey levels"),
       expert("Exposure.Drift", "standard deviation of the log gain of the automatic exposure"),
       expert("Exposure.Time_s", "correlation time of that gain"),
       expert("CalibrationError_deg",
              "true rotation against the mounting: roll, tilt upwards, pan to the left"),
       expert("ReportsPose", "frames carry the camera's pose from the robot's kinematics"),
       expert("Depth", "ground truth: the camera NAME/depth, in millimetres"),
       expert("Objects", "ground truth: the camera NAME/objects, indices of models and bodies")});
}

/// @param camera holds the defaults.
void readCamera(ConfigReader r, SimulatedCameraParams& camera) {
  describeCamera(r);
  CameraIntrinsics& k = camera.intrinsics;
  const int width = static_cast<int>(r.integer("Width_px", k.width, 16, 4096));
  const int height = static_cast<int>(r.integer("Height_px", k.height, 16, 4096));
  const double view_deg = radToDeg(2.0 * std::atan2(0.5 * k.width, k.fx));
  const CameraIntrinsics of_view =
      intrinsicsFromFieldOfView(width, height, r.angleDeg("HorizontalView_deg", view_deg, 5.0, 150.0));
  const auto pinhole = r.reals("Pinhole_px", {of_view.fx, of_view.fy, of_view.cx, of_view.cy}, -1e5, 1e5);
  const auto d = r.reals("Distortion", {k.k1, k.k2, k.p1, k.p2, k.k3}, -2.0, 2.0);
  k = {width, height, pinhole[0], pinhole[1], pinhole[2], pinhole[3], d[0], d[1], d[2], d[3], d[4]};
  readStatedLens(r, camera);
  camera.rate_hz = r.real("Rate_hz", camera.rate_hz, 0.1, 100.0);
  camera.latency_s = r.real("Latency_s", camera.latency_s, 0.0, 5.0);
  ImageErrorParams& e = camera.errors;
  e.gaussian = r.real("Noise", e.gaussian, 0.0, 50.0);
  e.shot = r.real("ShotNoise", e.shot, 0.0, 50.0);
  e.exposure_sigma = r.real("Exposure.Drift", e.exposure_sigma, 0.0, 1.0);
  e.exposure_time_s = r.real("Exposure.Time_s", e.exposure_time_s, 0.05, 3600.0);
  // Tilt up is a negative turn about the axis to the left.
  const auto error = r.reals("CalibrationError_deg", {0.0, 0.0, 0.0}, -45.0, 45.0);
  if (r.isSet("CalibrationError_deg")) {
    camera.T_believed_true =
        poseFromXyzRpy(0.0, 0.0, 0.0, degToRad(error[0]), -degToRad(error[1]), degToRad(error[2]));
  }
  r.alias("TellsPose", "ReportsPose");
  camera.reports_pose = r.boolean("ReportsPose", camera.reports_pose);
  camera.depth = r.boolean("Depth", camera.depth);
  camera.objects = r.boolean("Objects", camera.objects);
  if (const auto problem = checkCamera(camera); !problem.empty()) r.problem("Width_px", problem);
  if (!canUndistort(k)) r.problem("Distortion", "folds the image over itself, must be smaller");
}

/// What the robot reports of joints and wheels, and what is true.
void readMisreports(ConfigReader r, SimulationConfig& s) {
  r.describe({expert("Joints.PanScale", "true angle over reported angle"),
              expert("Joints.TiltScale", "as Joints.PanScale"),
              expert("Joints.Delay_s", "by which the stamps of the joints are late"),
              expert("Wheels.LeftScale", "true travel over reported travel"),
              expert("Wheels.RightScale", "as Wheels.LeftScale"),
              expert("Wheels.ReportedBase_m", "distance of the wheels that the odometry assumes"),
              expert("Wheels.Delay_s", "by which the stamps of the odometry are late")});
  s.joints.pan_scale = r.real("Joints.PanScale", 1.0, 0.5, 2.0);
  s.joints.tilt_scale = r.real("Joints.TiltScale", 1.0, 0.5, 2.0);
  s.joints.delay_us = toStampUs(r.real("Joints.Delay_s", 0.0, 0.0, 1.0));
  WheelModel& wheels = s.wheels.model;
  wheels.left_scale = r.real("Wheels.LeftScale", 1.0, 0.5, 2.0);
  wheels.right_scale = r.real("Wheels.RightScale", 1.0, 0.5, 2.0);
  wheels.base_m = s.base.wheel_base_m;
  s.wheels.reported_base_m = r.real("Wheels.ReportedBase_m", wheels.base_m, 0.01, 2.0);
  s.wheels.delay_us = toStampUs(r.real("Wheels.Delay_s", 0.0, 0.0, 1.0));
}

void readMoreCameras(ConfigReader r, std::vector<SimulatedCameraParams>& cameras) {
  for (const std::string& name : r.children("Cameras")) {
    ConfigReader group = r.group("Cameras." + name);
    group.describe({expert("Carrier", "what it is mounted on"),
                    expert("Position_m", "on it: forward, left, up"),
                    expert("Rotation_deg", "on it: roll, pitch, yaw")});
    SimulatedCameraParams camera = cameras.front();
    camera.stated_intrinsics.reset();
    camera.name = name;
    camera.on_head = group.choice("Carrier", true, {{"head", true}, {"robot", false}});
    camera.T_carrier_camera_body = readPose(group, "", Pose3::Identity());
    readCamera(group, camera);
    cameras.push_back(std::move(camera));
  }
}

void readWalk(ConfigReader r, WalkParams& p) {
  r.describe({expert("Step_s", "length of a step"),
              expert("Pulse", "share of the speed that varies within a step"),
              expert("StepAcceleration_mps", "largest change of the speed from step to step"),
              expert("StepTurnAcceleration_degps", "the same of the rate of turning"),
              expert("Sway.Roll_deg", "amplitude, with a period of two steps"),
              expert("Sway.Pitch_deg", "amplitude, with a period of one step"),
              expert("Sway.Height_m", "amplitude, with a period of one step"),
              expert("Sway.Lateral_m", "amplitude, with a period of two steps"),
              expert("Sway.Irregularity", "relative standard deviation from step to step"),
              expert("Sway.Known", "share of the sway that the robot's kinematics include")});
  p.step_s = r.real("Step_s", p.step_s, 0.05, 5.0);
  p.pulse = r.real("Pulse", p.pulse, 0.0, 1.0);
  p.step_acceleration_mps = r.real("StepAcceleration_mps", p.step_acceleration_mps, 0.001, 5.0);
  p.step_turn_acceleration_radps =
      r.angleDeg("StepTurnAcceleration_degps", radToDeg(p.step_turn_acceleration_radps), 0.1, 720.0);
  p.roll_rad = r.angleDeg("Sway.Roll_deg", radToDeg(p.roll_rad), 0.0, 30.0);
  p.pitch_rad = r.angleDeg("Sway.Pitch_deg", radToDeg(p.pitch_rad), 0.0, 30.0);
  p.height_m = r.real("Sway.Height_m", p.height_m, 0.0, 0.2);
  p.lateral_m = r.real("Sway.Lateral_m", p.lateral_m, 0.0, 0.2);
  p.irregularity = r.real("Sway.Irregularity", p.irregularity, 0.0, 1.0);
  p.known = r.real("Sway.Known", p.known, 0.0, 1.0);
}

/// The keys of the process, of the robot's start and of what it is made of.
void describeSimulation(ConfigReader& r) {
  r.describe({basic("World", "in which the robot moves"),
              basic("ModelPath", "more folders of models, with colons between"),
              basic("Robot", "on wheels, or walking"),
              basic("Seed", "of all chance: the same images and errors again"),
              basic("Start.Position_m", "in the world"),
              basic("Start.Heading_deg", "counter-clockwise from x"),
              basic("Speed", "simulated seconds a second, as far as the machine goes"),
              basic("Paused", "start paused, until Simulation::setPaused"),
              expert("LockStep", "time waits until so many clients want a newer image; 0: real time"),
              expert("RenderThreads", "the images are the same for any number"),
              basic("Scenario", "a file of events (docs/scenarios.md); empty: none"),
              basic("Mount.PanTilt.Position_m", "crossing of the axes on the robot: forward, left, up"),
              basic("Mount.PanTilt.Rotation_deg", "roll, pitch, yaw"),
              basic("Mount.Camera.Position_m", "of the lens on the head: forward, left, up"),
              basic("Mount.Camera.Rotation_deg", "roll, pitch, yaw")});
}

}  // namespace

SimulatorConfig readSimulatorConfig(ConfigReader& config) {
  ConfigReader r = config.group("Simulator");
  describeSimulation(r);
  SimulatorConfig c;
  c.world_file = r.requireFile("World", "a world file in SDF, such as cfg/worlds/corridor.world");
  std::istringstream folders(r.text("ModelPath", ""));
  for (std::string folder; std::getline(folders, folder, ':');) {
    if (folder.empty()) continue;
    c.model_paths.push_back(r.locate("ModelPath", folder));
    std::error_code ignored;
    if (!std::filesystem::is_directory(c.model_paths.back(), ignored))
      r.problem("ModelPath", "no such folder: " + folder);
  }
  c.simulation = r.choice("Robot", false, {{"wheels", false}, {"humanoid", true}}) ? humanoidSimulation()
                                                                                   : SimulationConfig();
  SimulationConfig& s = c.simulation;
  s.seed = static_cast<std::uint64_t>(r.integer("Seed", 1, 0, std::numeric_limits<long>::max()));
  const auto start = r.reals("Start.Position_m", {0.0, 0.0}, -1000.0, 1000.0);
  s.start = {start[0], start[1], r.angleDeg("Start.Heading_deg", 0.0, -360.0, 360.0)};
  c.speed = r.real("Speed", 1.0, 0.01, 1000.0);
  c.paused = r.boolean("Paused", false);
  c.lock_step = static_cast<int>(r.integer("LockStep", 0, 0, 64));
  c.render_threads = static_cast<int>(r.integer("RenderThreads", 1, 1, 64));
  c.scenario = r.existingPath("Scenario");
  s.T_robot_pantilt = readPose(r, "Mount.PanTilt.", s.T_robot_pantilt);
  SimulatedCameraParams& camera = s.cameras.front();
  camera.T_carrier_camera_body = readPose(r, "Mount.Camera.", camera.T_carrier_camera_body);
  readCamera(r.group("Camera"), camera);
  readMoreCameras(r, s.cameras);
  if (s.walk) readWalk(r.group("Walk"), *s.walk);
  readBaseParams(r.group("Base"), s.base);
  readPanTiltParams(r.group("PanTilt"), s.pan_tilt);
  readOdometryErrorParams(r.group("Odometry"), s.odometry);
  readMisreports(r, s);
  return c;
}

}  // namespace vismem
