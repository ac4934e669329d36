/// @file The messages of one or several ROS 1 bags as plain values. Use RobotLog (robot_log.h) unless you
/// need a bag as such.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "common/recording/bag_format.h"
#include "common/recording/ros_messages.h"

namespace vismem {

struct BagTopic {
  std::string name;
  std::string type;  ///< "sensor_msgs/Image"
  std::size_t messages = 0;
};

struct BagImageHeader : RosHeader {
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

struct BagTransform : RosTransform {
  bool is_static = false;  ///< from a topic called tf_static: holds at any time
};

/// One bag, or several that continue one another, opened for reading. *Single-threaded.*
class BagFile {
 public:
  /// Reads the index, or makes it where it is missing. @throws RecordingError for a file that is missing or
  /// no bag.
  explicit BagFile(const std::string& file);
  /// @param files in any order: they follow one another by their first message. @throws RecordingError also
  /// when there are none.
  explicit BagFile(const std::vector<std::string>& files);
  ~BagFile();
  BagFile(BagFile&&) noexcept;
  BagFile& operator=(BagFile&&) noexcept;

  /// Its name; of several, the first one's with the number of the others.
  const std::string& file() const;
  const std::vector<BagTopic>& topics() const;  ///< sorted by name
  /// What was damaged, and what was saved, in order of being found: reading adds to it.
  const std::vector<std::string>& notes() const;
  /// Times of recording of the first and last message [us]; 0 for an empty bag.
  std::int64_t beginUs() const;
  std::int64_t endUs() const;
  std::uint64_t bytes() const;                    ///< of all files
  std::vector<std::string> compressions() const;  ///< "none", "bz2", "lz4"

  // Messages in the order in which they were recorded. One that is damaged is left out and noted. All throw
  // RecordingError for a topic of another type, or when no message of a topic that has some can be read. A
  // header without a stamp (0) gets the time of recording; frames have no leading slash.

  /// Of a topic of type sensor_msgs/Image or sensor_msgs/CompressedImage: of every message only its beginning
  /// is read where the bag is not compressed.
  std::vector<BagImageHeader> imageHeaders(const std::string& topic);
  /// @param index into imageHeaders(topic), which was called before. @throws RecordingError when it is
  /// damaged.
  BagImage readImage(const std::string& topic, std::size_t index);
  std::vector<RosCameraInfo> cameraInfos(const std::string& topic);
  std::vector<RosOdometry> odometry(const std::string& topic);
  std::vector<RosJointState> joints(const std::string& topic);
  /// Of a topic of type geometry_msgs/PoseWithCovarianceStamped, geometry_msgs/PoseStamped (its covariance is
  /// 0) or nav_msgs/Odometry.
  std::vector<RosPoseWithCovariance> poses(const std::string& topic);
  /// Of a topic of type std_msgs/String.
  std::vector<std::string> strings(const std::string& topic);
  /// Of all topics with transforms.
  std::vector<BagTransform> transforms();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The bags that a path means: a file itself, or those of a folder, sorted by name (a session's parts, also
/// the one that was being written when the power failed); of several paths with commas between, those of
/// each.
/// @throws ConfigError for a path that is not there, and for a folder without any.
std::vector<std::string> bagsOf(const std::string& path);
/// The bags of several paths, in the order of the paths.
std::vector<std::string> bagsOf(const std::vector<std::string>& paths);

}  // namespace vismem
