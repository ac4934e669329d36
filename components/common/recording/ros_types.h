/// @file Definitions and checksums of the ROS messages that a recording of ours holds. C++17: it is filled
/// from ROS's own headers, which do not compile as C++20.
#pragma once

#include <string>

namespace vismem {

/// Checksum and full definition of a message's type, which a bag carries with every topic.
struct RosType {
  std::string name;
  std::string md5;
  std::string definition;
};

/// @param name "sensor_msgs/Image". @return null for a type that no recording of ours holds.
const RosType* findRosType(const std::string& name);

}  // namespace vismem
