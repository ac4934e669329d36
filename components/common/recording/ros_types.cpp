#include "common/recording/ros_types.h"

#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <nav_msgs/Odometry.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/JointState.h>
#include <std_msgs/String.h>
#include <tf2_msgs/TFMessage.h>
#include <visualization_msgs/MarkerArray.h>

#include <vector>

namespace vismem {
namespace {

template <typename Message>
RosType typeOf() {
  using namespace ros::message_traits;
  return {datatype<Message>(), md5sum<Message>(), definition<Message>()};
}

const std::vector<RosType>& types() {
  static const std::vector<RosType> known = [] {
    std::vector<RosType> list{
        typeOf<sensor_msgs::Image>(),      typeOf<sensor_msgs::CompressedImage>(),
        typeOf<sensor_msgs::CameraInfo>(), typeOf<sensor_msgs::JointState>(),
        typeOf<nav_msgs::Odometry>(),      typeOf<geometry_msgs::PoseWithCovarianceStamped>(),
        typeOf<tf2_msgs::TFMessage>(),     typeOf<visualization_msgs::MarkerArray>(),
        typeOf<std_msgs::String>()};
    // The message of the first tf is the same under another name.
    RosType old = typeOf<tf2_msgs::TFMessage>();
    old.name = "tf/tfMessage";
    list.push_back(old);
    return list;
  }();
  return known;
}

}  // namespace

const RosType* findRosType(const std::string& name) {
  for (const RosType& type : types()) {
    if (type.name == name) return &type;
  }
  return nullptr;
}

}  // namespace vismem
