#include "common/recording/bag_file.h"

#include <nav_msgs/Odometry.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/JointState.h>
#include <tf2_msgs/TFMessage.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <map>
#include <utility>

namespace vismem {
namespace {

constexpr const char* kMagic = "#ROSBAG V2.0";
constexpr const char* kRosTransformTypes[] = {"tf2_msgs/TFMessage", "tf/tfMessage"};

std::int64_t toStamp(const ros::Time& time) {
  return static_cast<std::int64_t>(time.sec) * 1'000'000 +
         (static_cast<std::int64_t>(time.nsec) + 500) / 1000;
}

std::int64_t stampOf(const ros::Time& header, const ros::Time& recorded) {
  return toStamp(header.isZero() ? recorded : header);
}

/// tf2 names have no leading slash, those of the first tf may.
std::string frameName(const std::string& name) {
  return !name.empty() && name.front() == '/' ? name.substr(1) : name;
}

BagImageHeader headerOf(const sensor_msgs::CompressedImage& message, const ros::Time& recorded) {
  BagImageHeader header;
  header.stamp_us = stampOf(message.header.stamp, recorded);
  header.frame_id = frameName(message.header.frame_id);
  header.encoding = message.format;
  header.compressed = true;
  return header;
}

BagImageHeader headerOf(const sensor_msgs::Image& message, const ros::Time& recorded) {
  BagImageHeader header;
  header.stamp_us = stampOf(message.header.stamp, recorded);
  header.frame_id = frameName(message.header.frame_id);
  header.encoding = message.encoding;
  header.width = static_cast<int>(message.width);
  header.height = static_cast<int>(message.height);
  return header;
}

std::string printable(const std::string& bytes) {
  std::string text;
  for (const char c : bytes) text += std::isprint(static_cast<unsigned char>(c)) ? c : '.';
  return text;
}

/// The bag library's own words for a wrong file are of little help: look first.
void checkFile(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw RecordingError(file + ": cannot be opened (expected a ROS 1 bag, version 2.0)");
  std::string begin(std::string(kMagic).size(), '\0');
  stream.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  begin.resize(static_cast<std::size_t>(std::max<std::streamsize>(stream.gcount(), 0)));
  if (begin != kMagic) {
    throw RecordingError(file + ": not a ROS 1 bag: begins with \"" + printable(begin) + "\" (expected \"" +
                         kMagic + "\")");
  }
}

bool isOneOf(const std::string& type, const std::vector<std::string>& types) {
  return std::find(types.begin(), types.end(), type) != types.end();
}

}  // namespace

struct BagFile::Impl {
  std::string file;
  rosbag::Bag bag;
  std::vector<BagTopic> topics;
  std::map<std::string, std::vector<rosbag::MessageInstance>> images;

  template <typename Read>
  auto guarded(const std::string& topic, Read read) -> decltype(read()) {
    try {
      return read();
    } catch (const RecordingError&) {
      throw;
    } catch (const std::exception& error) {
      throw RecordingError(
          file + (topic.empty() ? "" : ": topic " + topic) + ": cannot be read: " + error.what() +
          " (expected a complete ROS 1 bag; one that was cut off can be repaired with \"rosbag "
          "reindex\")");
    }
  }

  std::string typeOf(const std::string& name) const {
    for (const BagTopic& topic : topics) {
      if (topic.name == name) return topic.type;
    }
    throw RecordingError(file + ": no topic " + name);
  }

  template <typename Message>
  boost::shared_ptr<Message> instantiate(const rosbag::MessageInstance& instance) const {
    auto message = instance.instantiate<Message>();
    if (!message) {
      throw RecordingError(file + ": topic " + instance.getTopic() + ": " + instance.getDataType() +
                           " with checksum " + instance.getMD5Sum() + " (expected " +
                           ros::message_traits::datatype<Message>() + " with checksum " +
                           ros::message_traits::md5sum<Message>() + ")");
    }
    return message;
  }

  template <typename Message, typename Visit>
  void forEach(const std::string& topic, Visit visit) {
    guarded(topic, [&] {
      rosbag::View view(bag, [&](const rosbag::ConnectionInfo* info) { return info->topic == topic; });
      for (const rosbag::MessageInstance& instance : view)
        visit(*instantiate<Message>(instance), instance.getTime());
    });
  }
};

BagFile::BagFile(const std::string& file) : impl_(std::make_unique<Impl>()) {
  impl_->file = file;
  checkFile(file);
  impl_->guarded("", [&] {
    impl_->bag.open(file, rosbag::bagmode::Read);
    std::map<std::string, BagTopic> topics;
    rosbag::View view(impl_->bag);
    for (const rosbag::ConnectionInfo* info : view.getConnections()) {
      BagTopic& topic = topics[info->topic];
      topic.name = info->topic;
      topic.type = info->datatype;
    }
    // The index knows the numbers; one view a topic is cheaper than a walk over the messages.
    for (auto& [name, topic] : topics) {
      rosbag::View one(
          impl_->bag, [&wanted = name](const rosbag::ConnectionInfo* info) { return info->topic == wanted; });
      topic.messages = one.size();
      impl_->topics.push_back(topic);
    }
  });
}

BagFile::~BagFile() = default;
BagFile::BagFile(BagFile&&) noexcept = default;
BagFile& BagFile::operator=(BagFile&&) noexcept = default;

const std::string& BagFile::file() const {
  return impl_->file;
}
const std::vector<BagTopic>& BagFile::topics() const {
  return impl_->topics;
}

std::vector<BagImageHeader> BagFile::imageHeaders(const std::string& topic) {
  const bool compressed = impl_->typeOf(topic) == kCompressedImageType;
  std::vector<BagImageHeader> headers;
  std::vector<rosbag::MessageInstance> instances;
  impl_->guarded(topic, [&] {
    rosbag::View view(impl_->bag, [&](const rosbag::ConnectionInfo* info) { return info->topic == topic; });
    for (const rosbag::MessageInstance& instance : view) {
      BagImageHeader header =
          compressed
              ? headerOf(*impl_->instantiate<sensor_msgs::CompressedImage>(instance), instance.getTime())
              : headerOf(*impl_->instantiate<sensor_msgs::Image>(instance), instance.getTime());
      headers.push_back(std::move(header));
      instances.push_back(instance);
    }
  });
  impl_->images.insert_or_assign(topic, std::move(instances));
  return headers;
}

BagImage BagFile::readImage(const std::string& topic, std::size_t index) {
  return impl_->guarded(topic, [&] {
    const rosbag::MessageInstance& instance = impl_->images.at(topic).at(index);
    BagImage image;
    if (impl_->typeOf(topic) == kCompressedImageType) {
      const auto message = impl_->instantiate<sensor_msgs::CompressedImage>(instance);
      image.header = headerOf(*message, instance.getTime());
      image.data = std::move(message->data);
    } else {
      const auto message = impl_->instantiate<sensor_msgs::Image>(instance);
      image.header = headerOf(*message, instance.getTime());
      image.step = message->step;
      image.data = std::move(message->data);
    }
    return image;
  });
}

std::vector<BagCameraInfo> BagFile::cameraInfos(const std::string& topic) {
  std::vector<BagCameraInfo> infos;
  impl_->forEach<sensor_msgs::CameraInfo>(topic,
                                          [&](const sensor_msgs::CameraInfo& message, const ros::Time& time) {
                                            BagCameraInfo info;
                                            info.stamp_us = stampOf(message.header.stamp, time);
                                            info.width = static_cast<int>(message.width);
                                            info.height = static_cast<int>(message.height);
                                            info.model = message.distortion_model;
                                            info.d.assign(message.D.begin(), message.D.end());
                                            std::copy(message.K.begin(), message.K.end(), info.k);
                                            infos.push_back(std::move(info));
                                          });
  return infos;
}

std::vector<BagOdometry> BagFile::odometry(const std::string& topic) {
  std::vector<BagOdometry> samples;
  impl_->forEach<nav_msgs::Odometry>(topic, [&](const nav_msgs::Odometry& message, const ros::Time& time) {
    BagOdometry sample;
    sample.stamp_us = stampOf(message.header.stamp, time);
    sample.x = message.pose.pose.position.x;
    sample.y = message.pose.pose.position.y;
    const auto& q = message.pose.pose.orientation;
    sample.qx = q.x;
    sample.qy = q.y;
    sample.qz = q.z;
    sample.qw = q.w;
    sample.v_mps = message.twist.twist.linear.x;
    sample.w_radps = message.twist.twist.angular.z;
    samples.push_back(sample);
  });
  return samples;
}

std::vector<BagJoints> BagFile::joints(const std::string& topic) {
  std::vector<BagJoints> samples;
  impl_->forEach<sensor_msgs::JointState>(
      topic, [&](const sensor_msgs::JointState& message, const ros::Time& time) {
        BagJoints sample;
        sample.stamp_us = stampOf(message.header.stamp, time);
        sample.names = message.name;
        sample.positions.assign(message.position.begin(), message.position.end());
        samples.push_back(std::move(sample));
      });
  return samples;
}

std::vector<BagTransform> BagFile::transforms() {
  std::vector<BagTransform> transforms;
  const std::vector<std::string> types(std::begin(kRosTransformTypes), std::end(kRosTransformTypes));
  for (const BagTopic& topic : impl_->topics) {
    if (!isOneOf(topic.type, types)) continue;
    const bool is_static = topic.name.find("tf_static") != std::string::npos;
    impl_->forEach<tf2_msgs::TFMessage>(topic.name,
                                        [&](const tf2_msgs::TFMessage& message, const ros::Time& time) {
                                          for (const auto& item : message.transforms) {
                                            BagTransform transform;
                                            transform.stamp_us = stampOf(item.header.stamp, time);
                                            transform.parent = frameName(item.header.frame_id);
                                            transform.child = frameName(item.child_frame_id);
                                            transform.x = item.transform.translation.x;
                                            transform.y = item.transform.translation.y;
                                            transform.z = item.transform.translation.z;
                                            transform.qx = item.transform.rotation.x;
                                            transform.qy = item.transform.rotation.y;
                                            transform.qz = item.transform.rotation.z;
                                            transform.qw = item.transform.rotation.w;
                                            transform.is_static = is_static;
                                            transforms.push_back(std::move(transform));
                                          }
                                        });
  }
  return transforms;
}

}  // namespace vismem
