/// @file The messages of a ROS 1 bag as plain values. This header has no ROS types and is C++17: the message
/// headers of Debian 12 do not compile as C++20 (DESIGN 4). Use RobotLog (robot_log.h) unless you need a bag
/// as such.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace vismem {

/// What is wrong with a recording, in one line: file, topic where there is one, what was found and what was
/// expected.
class RecordingError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct BagTopic {
  std::string name;
  std::string type;  ///< "sensor_msgs/Image"
  std::size_t messages = 0;
};

/// All stamps are those of the messages' headers [us], or the time of recording where a header has none (0).
struct BagImageHeader {
  std::int64_t stamp_us = 0;
  std::string frame_id;
  std::string encoding;  ///< raw: "rgb8"; compressed: the field `format`, "jpeg"
  bool compressed = false;
  int width = 0;  ///< 0 when compressed: not known before decoding
  int height = 0;
};

struct BagImage {
  BagImageHeader header;
  std::size_t step = 0;  ///< bytes of a row, raw images only
  std::vector<std::uint8_t> data;
};

struct BagCameraInfo {
  std::int64_t stamp_us = 0;
  int width = 0;
  int height = 0;
  std::string model;      ///< of the distortion: "plumb_bob"; may be empty
  std::vector<double> d;  ///< distortion parameters, any number
  double k[9] = {};       ///< camera matrix, row by row
};

struct BagOdometry {
  std::int64_t stamp_us = 0;
  double x = 0.0, y = 0.0;  ///< [m]
  double qx = 0.0, qy = 0.0, qz = 0.0, qw = 0.0;
  double v_mps = 0.0, w_radps = 0.0;
};

struct BagJoints {
  std::int64_t stamp_us = 0;
  std::vector<std::string> names;
  std::vector<double> positions;  ///< [rad]; may be shorter than names
};

/// The pose of `child` in `parent`.
struct BagTransform {
  std::int64_t stamp_us = 0;
  std::string parent;  ///< without a leading slash
  std::string child;
  double x = 0.0, y = 0.0, z = 0.0;  ///< [m]
  double qx = 0.0, qy = 0.0, qz = 0.0, qw = 0.0;
  bool is_static = false;  ///< from a topic called tf_static: holds at any time
};

/// A bag opened for reading. Every function throws RecordingError. *Single-threaded.*
class BagFile {
 public:
  /// Reads the index only. @throws RecordingError for a file that is missing, no bag, or cut off.
  explicit BagFile(const std::string& file);
  ~BagFile();
  BagFile(BagFile&&) noexcept;
  BagFile& operator=(BagFile&&) noexcept;

  const std::string& file() const;
  const std::vector<BagTopic>& topics() const;  ///< sorted by name

  /// Of a topic of type sensor_msgs/Image or sensor_msgs/CompressedImage, in order of recording. Reads the
  /// topic through once, because a bag's index does not know header stamps.
  std::vector<BagImageHeader> imageHeaders(const std::string& topic);
  /// @param index into imageHeaders(topic), which was called before.
  BagImage readImage(const std::string& topic, std::size_t index);
  std::vector<BagCameraInfo> cameraInfos(const std::string& topic);
  std::vector<BagOdometry> odometry(const std::string& topic);
  std::vector<BagJoints> joints(const std::string& topic);
  /// Of all topics with transforms.
  std::vector<BagTransform> transforms();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The types of messages that this library reads.
inline constexpr const char* kRawImageType = "sensor_msgs/Image";
inline constexpr const char* kCompressedImageType = "sensor_msgs/CompressedImage";
inline constexpr const char* kCameraInfoType = "sensor_msgs/CameraInfo";
inline constexpr const char* kOdometryType = "nav_msgs/Odometry";
inline constexpr const char* kJointStateType = "sensor_msgs/JointState";

}  // namespace vismem
