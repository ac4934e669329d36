#include "active_visual_memory/app/config.h"

#include <algorithm>
#include <vector>

#include "active_visual_memory/app/retired_keys.h"
#include "common/config/parameter_reader.h"
#include "common/geometry/angles.h"

namespace vismem {
namespace {

/// Samples of joints and odometry further apart are not interpolated.
constexpr StampUs kMaxHistoryGap_us = kSecondUs / 2;

/// @param position, @param rotation of the pose [m], [degrees].
Pose3 readPose(ConfigReader& reader, const Key& position, const Key& rotation,
               const std::vector<double>& position_m) {
  const auto p = reader.describe(position).reals(position.name, position_m, -10.0, 10.0);
  const auto r = reader.describe(rotation).reals(rotation.name, {0.0, 0.0, 0.0}, -360.0, 360.0);
  return poseFromXyzRpy(p[0], p[1], p[2], degToRad(r[0]), degToRad(r[1]), degToRad(r[2]));
}

void visit(ParameterVisitor& v, ExtractorParams& p) {
  v.choice<std::string>(expert("Detector", "V3: solis, the detector of the chapter, or Canny and Hough"),
                        p.detector, {{"solis", "solis"}, {"chapter", "chapter"}, {"hough", "hough"}});
  v.flag(expert("ColourEdges", "detect edges between colours of equal brightness"), p.colour_edges);
  v.real(basic("MinimumLength_px", "V4: shorter segments are dropped"), p.minimum_length_px, 2.0, 1000.0);
}

void visit(ParameterVisitor& v, Rig& rig) {
  v.angle(basic("Pan.Minimum_deg", "joint limits; pan is positive to the left"), rig.min_pan_rad, -360.0,
          360.0);
  v.angle(basic("Pan.Maximum_deg", "the same"), rig.max_pan_rad, -360.0, 360.0);
  v.angle(basic("Tilt.Minimum_deg", "the same; tilt is positive upwards"), rig.min_tilt_rad, -90.0, 90.0);
  v.angle(basic("Tilt.Maximum_deg", "the same"), rig.max_tilt_rad, -90.0, 90.0);
  v.require("Pan.Minimum_deg", rig.min_pan_rad < rig.max_pan_rad, "must be less than", "Pan.Maximum_deg");
  v.require("Tilt.Minimum_deg", rig.min_tilt_rad < rig.max_tilt_rad, "must be less than", "Tilt.Maximum_deg");
}

StampUs readDelay(ConfigReader& reader, const Key& key) {
  return toStampUs(reader.describe(key).real(key.name, 0.0, -1.0, 1.0));
}

void readCalibration(ConfigReader& reader, ActiveVisualMemoryConfig& config) {
  ParameterReader v(reader);
  JointCorrection& joints = config.joints;
  v.real(expert("Joints.PanScale", "true over reported pan angle"), joints.pan_scale, 0.5, 2.0);
  v.real(expert("Joints.TiltScale", "true over reported tilt angle"), joints.tilt_scale, 0.5, 2.0);
  joints.delay_us = readDelay(reader, expert("Joints.Delay_s", "delay of the stamps of joint angles"));
  WheelCorrectionParams& wheels = config.wheels;
  v.real(expert("Wheels.ReportedBase_m", "distance of the wheels with which the scales were fitted"),
         wheels.reported_base_m, 0.02, 5.0);
  v.real(expert("Wheels.LeftScale", "true over reported travel of the left wheel"), wheels.model.left_scale,
         0.3, 3.0);
  v.real(expert("Wheels.RightScale", "the same of the right wheel"), wheels.model.right_scale, 0.3, 3.0);
  wheels.model.base_m = wheels.reported_base_m;
  v.real(expert("Wheels.Base_m", "true distance of the wheels; default: as reported"), wheels.model.base_m,
         0.02, 5.0);
  wheels.delay_us = readDelay(reader, expert("Wheels.Delay_s", "delay of the stamps of the odometry"));
  v.angle(expert("Mount.CalibratedTilt_deg",
                 "standard deviation of the mounting's tilt and roll; 0: not calibrated"),
          config.calibrated_tilt_rad, 0.0, 5.0);
}

}  // namespace

CameraMount readCameraMount(ConfigReader& reader) {
  CameraMount mount;
  mount.T_robot_pantilt = readPose(
      reader,
      basic("Mount.PanTilt.Position_m", "crossing of the pan-tilt axes on the robot: forward, left, up"),
      basic("Mount.PanTilt.Rotation_deg", "of the unit on the robot: roll, pitch, yaw"), {0.0, 0.0, 0.45});
  mount.T_head_camera_body = readPose(
      reader, basic("Mount.Camera.Position_m", "of the camera on the head: forward, left, up"),
      basic("Mount.Camera.Rotation_deg", "of the camera on the head: roll, pitch, yaw"), {0.0, 0.0, 0.0});
  return mount;
}

MemoryPipelineParams readMemoryPipeline(ConfigReader& reader) {
  const Key mode = basic("Mode", "default, or chapter as published");
  const bool chapter =
      reader.describe(mode).choice(mode.name, false, {{"default", false}, {"chapter", true}});
  MemoryPipelineParams p = chapter ? MemoryPipelineParams::chapter() : MemoryPipelineParams::standard();
  p.memory.rig.mount = readCameraMount(reader);
  ParameterReader gaze(reader.group("Gaze"));
  visit(gaze, p.memory.rig);
  ParameterReader vision(reader.group("Vision"));
  visit(vision, p.vision);
  ParameterReader memory(reader);
  p.memory.visit(memory);
  // The projector's error of single images is the tilt of single images.
  p.memory.projector.pitch_sigma_rad =
      std::max(p.memory.projector.pitch_sigma_rad, p.memory.memory.estimation.tilt_prior.per_frame_rad);
  acceptRetiredMemoryKeys(reader);
  return p;
}

ActiveVisualMemoryConfig readActiveVisualMemoryConfig(ConfigReader& reader) {
  ActiveVisualMemoryConfig config;
  reader.describe(basic("Camera.Proxy", "the camera, required"));
  config.camera_proxy = reader.requiredText("Camera.Proxy", "the proxy of an avm::Camera");
  reader.describe(basic("Odometry.Proxy", "the odometry, required"));
  config.odometry_proxy = reader.requiredText("Odometry.Proxy", "the proxy of an avm::Odometry");
  reader.describe(
      basic("PanTilt.Proxy", "the pan-tilt unit; empty: images carry the camera's pose, the gaze is off"));
  config.pan_tilt_proxy = reader.text("PanTilt.Proxy", "");
  reader.describe(basic("Palette", "colour classes and labels; empty: labels are unknown"));
  config.palette = reader.existingFile("Palette", "a palette, such as cfg/maps/corridor.palette");
  ParameterReader parameters(reader);
  parameters.flag(basic("EveryFrame", "process every image (recordings) instead of the newest"),
                  config.every_frame);
  parameters.flag(
      basic("Overlay.Enabled", "serve memoryView: the image with observed and predicted segments"),
      config.overlay);
  parameters.real(basic("Overlay.Rate_hz", "highest rate of memoryView"), config.overlay_rate_hz, 0.1, 120.0);
  config.pipeline = readMemoryPipeline(reader);
  readCalibration(reader, config);
  config.assembler.mount = config.pipeline.memory.rig.mount;
  config.assembler.has_pan_tilt = config.hasPanTilt();
  config.assembler.max_gap_us = kMaxHistoryGap_us;
  if (!config.hasPanTilt()) config.pipeline.memory.gaze.initial_mode = GazeMode::kOff;
  return config;
}

}  // namespace vismem
