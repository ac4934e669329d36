#include "replay_server/app/config.h"

#include <filesystem>

#include "common/config/config_error.h"
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
    } catch (const ConfigError&) {
      reader.problem("File", "is a folder without a recording, must hold NAME.bag");
    }
    return;
  }
  config.files = {reader.requireFile("File", kExpected).string()};
}

}  // namespace

ReplayServerConfig readReplayServerConfig(ConfigReader& reader) {
  ReplayServerConfig config;
  reader.describe(basic("File", "a bag, a folder with the parts of one, or several with commas between"));
  readFiles(reader, config);
  RobotLogOptions& log = config.log;
  const auto name = [&reader](const char* key, const char* meaning) {
    return reader.describe(expert(key, meaning)).text(key, "");
  };
  log.image_topic = name("Topics.Image", "of the images; empty: found by type");
  log.camera_info_topic = name("Topics.CameraInfo", "of the lens; empty: the one beside the images");
  log.odometry_topic = name("Topics.Odometry", "of the odometry; empty: found by type");
  log.joint_topic = name("Topics.Joints", "of pan and tilt; empty: found by type");
  log.robot_frame =
      name("Frames.Robot", "on the floor under the robot; empty: base_footprint, else base_link");
  log.camera_frame = name("Frames.Camera", "x right, y down, z forward; empty: that of the images");
  log.pan_joint = name("Joints.Pan", "a joint; empty: head_yaw or pan");
  log.tilt_joint = name("Joints.Tilt", "a joint; empty: head_pitch or tilt");
  reader.describe(
      expert("Joints.TiltUp", "sign of the recorded tilt looking up; auto: negative for head_pitch"));
  log.tilt_sign = reader.choice("Joints.TiltUp", 0, {{"auto", 0}, {"positive", 1}, {"negative", -1}});
  reader.describe(expert("MaximumGap_s", "transforms further apart are not interpolated between"));
  log.max_gap_us = toStampUs(reader.real("MaximumGap_s", toSeconds(log.max_gap_us), 0.001, 10.0));
  log.odom_frame = name("Frames.Odom", "of a bag whose odometry is in its transforms only; empty: odom");
  reader.describe(
      expert("Camera.Fixed", "the camera does not turn; the memory's configuration says where it is"));
  log.fixed_camera = reader.boolean("Camera.Fixed", false);
  reader.describe(expert("Camera.FieldOfView_deg", "horizontal, of a camera without CameraInfo; 0: unknown"));
  log.fov_rad = reader.angleDeg("Camera.FieldOfView_deg", 0.0, 0.0, 179.0);
  reader.describe(basic("Rate", "seconds of the recording per second"));
  config.player.rate = reader.real("Rate", config.player.rate, 0.01, 1000.0);
  reader.describe(basic("Loop", "restart at the end"));
  config.player.loop = reader.boolean("Loop", config.player.loop);
  reader.describe(basic("Start", "with the first client of the camera, at once, or on command"));
  config.player.start = reader.choice(
      "Start", config.player.start,
      {{"client", ReplayState::kWaiting}, {"now", ReplayState::kPlaying}, {"paused", ReplayState::kPaused}});
  return config;
}

}  // namespace vismem
