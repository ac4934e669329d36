#include "replay_server/app/config.h"

#include <filesystem>

#include "common/config/text_fields.h"

namespace vismem {

namespace {

namespace fs = std::filesystem;

/// One file or folder, or several with commas between.
void readFiles(ConfigReader& reader, ReplayServerConfig& config) {
  constexpr const char* kExpected = "a recording: ROS 1 bag";
  const std::string named = reader.isSet("File") ? reader.text("File", "") : "";
  if (named.find(',') != std::string::npos) {
    for (const std::string_view part : splitAt(named, ',')) {
      const std::string name(trimmed(part));
      if (name.empty()) continue;
      config.files.push_back(reader.locate("File", name).string());
      std::error_code error;
      if (!fs::exists(config.files.back(), error)) {
        reader.problem("File", "no such file or folder: " + config.files.back());
      }
    }
    return;
  }
  std::error_code error;
  if (!named.empty() && fs::is_directory(reader.locate("File", named), error)) {
    config.files = {reader.existingPath("File").string()};
    try {
      bagsOf(config.files.front());
    } catch (const RecordingError&) {
      reader.problem("File", "is a folder without a recording, must hold NAME.bag");
    }
    return;
  }
  config.files = {reader.requireFile("File", kExpected).string()};
}

}  // namespace

ReplayServerConfig readReplayServerConfig(ConfigReader& reader) {
  ReplayServerConfig config;
  readFiles(reader, config);
  RobotLogOptions& log = config.log;
  log.image_topic = reader.text("Topics.Image", "");
  log.camera_info_topic = reader.text("Topics.CameraInfo", "");
  log.odometry_topic = reader.text("Topics.Odometry", "");
  log.joint_topic = reader.text("Topics.Joints", "");
  log.robot_frame = reader.text("Frames.Robot", "");
  log.camera_frame = reader.text("Frames.Camera", "");
  log.pan_joint = reader.text("Joints.Pan", "");
  log.tilt_joint = reader.text("Joints.Tilt", "");
  log.tilt_sign = reader.choice("Joints.TiltUp", 0, {{"auto", 0}, {"positive", 1}, {"negative", -1}});
  log.max_gap_us = toStampUs(reader.real("MaximumGap_s", toSeconds(log.max_gap_us), 0.001, 10.0));
  log.odom_frame = reader.text("Frames.Odom", "");
  log.fixed_camera = reader.boolean("Camera.Fixed", false);
  log.fov_rad = reader.angleDeg("Camera.FieldOfView_deg", 0.0, 0.0, 179.0);
  config.player.rate = reader.real("Rate", config.player.rate, 0.01, 1000.0);
  config.player.loop = reader.boolean("Loop", config.player.loop);
  config.player.start = reader.choice(
      "Start", config.player.start,
      {{"client", ReplayState::kWaiting}, {"now", ReplayState::kPlaying}, {"paused", ReplayState::kPaused}});
  return config;
}

}  // namespace vismem
