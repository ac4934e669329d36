#include "recording/bag_writer.h"

#include <geometry_msgs/PoseStamped.h>
#include <nav_msgs/Odometry.h>
#include <rosbag/bag.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/JointState.h>
#include <tf2_msgs/TFMessage.h>

#include <cmath>

namespace vismem {
namespace {

ros::Time toTime(std::int64_t stamp_us) {
  return ros::Time(static_cast<std::uint32_t>(stamp_us / 1'000'000),
                   static_cast<std::uint32_t>(stamp_us % 1'000'000 * 1000));
}

/// Recorded a little after it was captured: readers must use the header's stamp.
ros::Time recordedAt(std::int64_t stamp_us) {
  return toTime(stamp_us + 3'000);
}

}  // namespace

struct BagWriter::Impl {
  rosbag::Bag bag;
};

BagWriter::BagWriter(const std::string& file, const std::string& compression)
    : impl_(std::make_unique<Impl>()) {
  impl_->bag.open(file, rosbag::bagmode::Write);
  if (compression == "bz2") impl_->bag.setCompression(rosbag::CompressionType::BZ2);
  if (compression == "lz4") impl_->bag.setCompression(rosbag::CompressionType::LZ4);
}
BagWriter::~BagWriter() = default;
void BagWriter::close() {
  impl_->bag.close();
}

void BagWriter::image(const std::string& topic, std::int64_t stamp_us, const std::string& encoding, int width,
                      int height, const std::vector<std::uint8_t>& data, const std::string& frame_id) {
  sensor_msgs::Image message;
  message.header.stamp = toTime(stamp_us);
  message.header.frame_id = frame_id;
  message.encoding = encoding;
  message.width = static_cast<std::uint32_t>(width);
  message.height = static_cast<std::uint32_t>(height);
  message.step = static_cast<std::uint32_t>(data.size() / static_cast<std::size_t>(height));
  message.data = data;
  impl_->bag.write(topic, recordedAt(stamp_us), message);
}

void BagWriter::compressedImage(const std::string& topic, std::int64_t stamp_us,
                                const std::vector<std::uint8_t>& data, const std::string& frame_id) {
  sensor_msgs::CompressedImage message;
  message.header.stamp = toTime(stamp_us);
  message.header.frame_id = frame_id;
  message.format = "png";
  message.data = data;
  impl_->bag.write(topic, recordedAt(stamp_us), message);
}

void BagWriter::cameraInfo(const std::string& topic, std::int64_t stamp_us, int width, int height, double f,
                           const std::string& model, const std::vector<double>& d) {
  sensor_msgs::CameraInfo message;
  message.header.stamp = toTime(stamp_us);
  message.width = static_cast<std::uint32_t>(width);
  message.height = static_cast<std::uint32_t>(height);
  message.distortion_model = model;
  message.D.assign(d.begin(), d.end());
  message.K = {f, 0.0, 0.5 * (width - 1), 0.0, f, 0.5 * (height - 1), 0.0, 0.0, 1.0};
  impl_->bag.write(topic, recordedAt(stamp_us), message);
}

void BagWriter::odometry(const std::string& topic, std::int64_t stamp_us, double x, double y, double theta,
                         const std::string& frame_id) {
  nav_msgs::Odometry message;
  message.header.stamp = toTime(stamp_us);
  message.header.frame_id = frame_id;
  message.pose.pose.position.x = x;
  message.pose.pose.position.y = y;
  message.pose.pose.orientation.z = std::sin(0.5 * theta);
  message.pose.pose.orientation.w = std::cos(0.5 * theta);
  impl_->bag.write(topic, recordedAt(stamp_us), message);
}

void BagWriter::pose(const std::string& topic, std::int64_t stamp_us, double x, double y, double theta) {
  geometry_msgs::PoseStamped message;
  message.header.stamp = toTime(stamp_us);
  message.pose.position.x = x;
  message.pose.position.y = y;
  message.pose.orientation.z = std::sin(0.5 * theta);
  message.pose.orientation.w = std::cos(0.5 * theta);
  impl_->bag.write(topic, recordedAt(stamp_us), message);
}

void BagWriter::joints(const std::string& topic, std::int64_t stamp_us, const std::vector<std::string>& names,
                       const std::vector<double>& positions) {
  sensor_msgs::JointState message;
  message.header.stamp = toTime(stamp_us);
  message.name = names;
  message.position.assign(positions.begin(), positions.end());
  impl_->bag.write(topic, recordedAt(stamp_us), message);
}

void BagWriter::transform(const std::string& topic, std::int64_t stamp_us, const std::string& parent,
                          const std::string& child, double x, double y, double z, double yaw) {
  geometry_msgs::TransformStamped item;
  item.header.stamp = toTime(stamp_us);
  item.header.frame_id = parent;
  item.child_frame_id = child;
  item.transform.translation.x = x;
  item.transform.translation.y = y;
  item.transform.translation.z = z;
  item.transform.rotation.z = std::sin(0.5 * yaw);
  item.transform.rotation.w = std::cos(0.5 * yaw);
  tf2_msgs::TFMessage message;
  message.transforms.push_back(item);
  impl_->bag.write(topic, recordedAt(stamp_us), message);
}

}  // namespace vismem
