/// @file Which parts of a robot a bag can play, and what is needed for those it cannot. See C1.
#pragma once

#include <string>
#include <vector>

#include "common/recording/robot_log.h"

namespace vismem {

/// One part that a recording plays: images, calibration, odometry, camera pose.
struct BagRole {
  std::string name;
  std::string topic;                    ///< what plays it; empty: nothing does
  std::vector<std::string> candidates;  ///< topics of fitting types
  std::string key;                      ///< of replay_server: "ReplayServer.Topics.Image"
  std::string needed;                   ///< what would be needed; empty while it is played
};

struct BagAdvice {
  std::vector<BagRole> roles;
  bool playable = false;
  std::string problem;                 ///< why it is not; of the first role that is missing
  std::vector<std::string> arguments;  ///< for replay_server: "--ReplayServer.Topics.Image=/front/image_raw"
  RobotLogOptions options;             ///< the same
};

/// Tries to open the bag as replay_server would; where several topics fit, takes the one with most messages.
/// @param wanted what the user has said already. @throws RecordingError when the bag itself cannot be opened.
BagAdvice adviseOn(const std::vector<std::string>& files, const RobotLogOptions& wanted);

/// Reads "image=/front/image_raw,odometry=/odom": roles image, camera_info, odometry, joints, and robot,
/// camera, odom (frames), pan, tilt (names of joints). @return empty, or what is wrong: role and those that
/// exist.
std::string applyTopics(const std::string& text, RobotLogOptions& options);

}  // namespace vismem
