#include "replay_server/app/config.h"

namespace vismem {

ReplayServerConfig readReplayServerConfig(ConfigReader& reader) {
  ReplayServerConfig config;
  config.file = reader.requireFile("File", "a recording: ROS 1 bag").string();
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
  config.player.rate = reader.real("Rate", config.player.rate, 0.01, 1000.0);
  config.player.loop = reader.boolean("Loop", config.player.loop);
  config.player.start = reader.choice(
      "Start", config.player.start,
      {{"client", ReplayState::kWaiting}, {"now", ReplayState::kPlaying}, {"paused", ReplayState::kPaused}});
  return config;
}

}  // namespace vismem
