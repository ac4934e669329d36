/// @file Which parts of a robot a bag can play, and what is needed for those it cannot. See C1.
#pragma once

#include <optional>
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
  std::string note = {};                ///< more about the candidates; may be empty
};

struct BagAdvice {
  std::vector<BagRole> roles;
  std::optional<RobotLog> log;         ///< the recording, opened; empty when it cannot be played
  std::string problem;                 ///< why it cannot: all roles that are missing, a line each
  std::string truth;                   ///< topic of the true poses; empty: none
  std::vector<std::string> arguments;  ///< for replay_server: "--ReplayServer.Topics.Image=/front/image_raw"
  RobotLogOptions options;             ///< the same
};

/// Tries to open the bag as replay_server would. Where several topics fit, takes the one with most messages,
/// of several with nearly as many the first by name; of odometries the one that alone is in its frame, else
/// none.
/// @param wanted what the user has said already.
BagAdvice adviseOn(BagFile bag, const RobotLogOptions& wanted);

/// Reads "image=/front/image_raw,odometry=/odom": roles image (or images), camera_info, odometry, joints,
/// truth, and robot, camera, odom (frames), pan, tilt (names of joints); fov=60 [deg] and fixed=yes stand for
/// a calibration and a camera's pose that the bag lacks. @return empty, or what is wrong: role and those that
/// exist.
std::string applyTopics(const std::string& text, RobotLogOptions& options);

/// What applyTopics reads; empty for options that name nothing.
std::string topicsText(const RobotLogOptions& options);

/// The names as keys of replay_server: "--ReplayServer.Topics.Image=/front/image_raw". The truth has none.
std::vector<std::string> replayArguments(const RobotLogOptions& options);

}  // namespace vismem
