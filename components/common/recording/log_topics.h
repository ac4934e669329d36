/// @file Which topic of a bag is the odometry, and which one the truth. See C1.
#pragma once

#include <string>
#include <vector>

#include "common/geometry/pose.h"
#include "common/recording/bag_file.h"
#include "common/robot/samples.h"

namespace vismem {

/// Where the robot truly was.
struct TruePose {
  StampUs stamp_us = 0;
  Pose2 T_world_robot;
};

/// The topic with the true poses.
/// @param named empty: /ground_truth/pose, else /ground_truth, where one of them has poses.
/// @return empty without such a topic.
/// @throws RecordingError for a named topic that is not in the bag or has no poses.
std::string truthTopic(const BagFile& bag, const std::string& named);

/// @param named as for truthTopic. @return empty without a truth. @throws RecordingError.
std::vector<TruePose> readTruth(BagFile& bag, const std::string& named);

/// For people: how many images lie outside samples of odometry or joints, and both ranges.
/// @param what "odometry". @param begin_us, end_us of the samples. @param images stamps, rising, not empty.
/// @return empty while no image lies over a second outside: a recording that is switched off loses the last
/// samples of one topic or another.
std::string coverageNote(const std::string& what, StampUs begin_us, StampUs end_us,
                         const std::vector<StampUs>& images);

/// A topic that may be the odometry, with the frames of its first message.
struct OdometryTopic {
  std::string name;
  std::string parent;
  std::string child;

  /// "/odom (odom -> base_link)".
  std::string text() const { return name + " (" + parent + " -> " + child + ")"; }
};

/// The topics of type nav_msgs/Odometry that have messages, in order of their names, without the truth's.
std::vector<OdometryTopic> odometryTopics(BagFile& bag, const std::string& truth_topic);

/// The only one, or of several the only one in the frame of odometry.
/// @return empty where that does not decide.
std::string chooseOdometry(const std::vector<OdometryTopic>& topics, const std::string& odom_frame);

/// "/odom (odom -> base_link), /ekf (map -> base_link)".
std::string textOf(const std::vector<OdometryTopic>& topics);

}  // namespace vismem
