/// @file The standard ROS messages that recordings are made of, as plain values, and their bytes. Pure.
/// All stamps are those of the messages' headers [us]; 0 is also ROS's way to say that there is none.
/// Fields that ROS has and these values lack are written as 0 and passed over when read.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "common/recording/bag_format.h"

namespace vismem {

struct RosHeader {
  std::int64_t stamp_us = 0;
  std::string frame_id;
};

struct RosQuaternion {
  double x = 0.0, y = 0.0, z = 0.0, w = 1.0;
};
struct RosPoint {
  double x = 0.0, y = 0.0, z = 0.0;  ///< [m]
};
struct RosPose {
  RosPoint position;
  RosQuaternion orientation;
};
/// Of (x, y, z, rotation about x, y, z), row by row [m^2, m rad, rad^2].
using RosCovariance = std::array<double, 36>;

/// sensor_msgs/Image
struct RosImage {
  RosHeader header;
  std::uint32_t height = 0;
  std::uint32_t width = 0;
  std::string encoding;    ///< "rgb8"
  std::uint32_t step = 0;  ///< bytes of a row
  Bytes data;
};

/// sensor_msgs/CompressedImage
struct RosCompressedImage {
  RosHeader header;
  std::string format;  ///< "jpeg", "png"
  Bytes data;
};

/// sensor_msgs/CameraInfo
struct RosCameraInfo {
  RosHeader header;
  std::uint32_t height = 0;
  std::uint32_t width = 0;
  std::string distortion_model = "plumb_bob";
  std::vector<double> d;       ///< distortion: k1, k2, p1, p2, k3
  std::array<double, 9> k{};   ///< camera matrix, row by row
  std::array<double, 9> r{};   ///< rectification
  std::array<double, 12> p{};  ///< projection
};

/// sensor_msgs/JointState
struct RosJointState {
  RosHeader header;
  std::vector<std::string> names;
  std::vector<double> positions;  ///< [rad]; may be shorter than names
};

/// nav_msgs/Odometry
struct RosOdometry {
  RosHeader header;
  std::string child_frame_id;
  RosPose pose;
  RosCovariance pose_covariance{};
  double v_mps = 0.0;    ///< forward
  double w_radps = 0.0;  ///< counter-clockwise
};

/// geometry_msgs/PoseWithCovarianceStamped
struct RosPoseWithCovariance {
  RosHeader header;
  RosPose pose;
  RosCovariance covariance{};
};

/// One item of a tf2_msgs/TFMessage: the pose of `child_frame_id` in the header's frame.
struct RosTransform {
  RosHeader header;
  std::string child_frame_id;
  RosPose pose;
};

/// visualization_msgs/Marker
struct RosMarker {
  enum class Type : std::int32_t {
    kArrow = 0,
    kSphere = 2,
    kLineStrip = 4,
    kLineList = 5,
    kPoints = 8,
    kText = 9
  };
  enum class Action : std::int32_t { kAdd = 0, kDeleteAll = 3 };
  RosHeader header;
  std::string ns;  ///< with `id` names the marker
  std::int32_t id = 0;
  Type type = Type::kLineList;
  Action action = Action::kAdd;
  RosPose pose;
  RosPoint scale{0.02, 0.02, 0.02};  ///< x is the width of lines [m]
  std::array<float, 4> rgba{1.0F, 1.0F, 1.0F, 1.0F};
  std::vector<RosPoint> points;
  std::vector<std::array<float, 4>> colors;  ///< none, or one a point
  std::string text;
};

Bytes serialize(const RosImage& message);
Bytes serialize(const RosCompressedImage& message);
Bytes serialize(const RosCameraInfo& message);
Bytes serialize(const RosJointState& message);
Bytes serialize(const RosOdometry& message);
Bytes serialize(const RosPoseWithCovariance& message);
/// tf2_msgs/TFMessage
Bytes serialize(const std::vector<RosTransform>& message);
/// visualization_msgs/MarkerArray
Bytes serialize(const std::vector<RosMarker>& message);
/// std_msgs/String
Bytes serialize(const std::string& message);

// All throw RecordingError for bytes that are no such message.
RosImage parseImage(ByteView bytes);
/// Without its data: enough for the beginning of a message. @throws RecordingError when that is too short.
RosImage parseImageHeader(ByteView begin);
RosCompressedImage parseCompressedImage(ByteView bytes);
RosCompressedImage parseCompressedImageHeader(ByteView begin);
RosCameraInfo parseCameraInfo(ByteView bytes);
RosJointState parseJointState(ByteView bytes);
RosOdometry parseOdometry(ByteView bytes);
RosPoseWithCovariance parsePoseWithCovariance(ByteView bytes);
/// geometry_msgs/PoseStamped: no covariance.
RosPoseWithCovariance parsePose(ByteView bytes);
std::vector<RosTransform> parseTransforms(ByteView bytes);
std::string parseString(ByteView bytes);

inline constexpr const char* kRawImageType = "sensor_msgs/Image";
inline constexpr const char* kCompressedImageType = "sensor_msgs/CompressedImage";
inline constexpr const char* kCameraInfoType = "sensor_msgs/CameraInfo";
inline constexpr const char* kOdometryType = "nav_msgs/Odometry";
inline constexpr const char* kJointStateType = "sensor_msgs/JointState";
inline constexpr const char* kTransformType = "tf2_msgs/TFMessage";
/// As tf2_msgs/TFMessage, of the first tf; read only.
inline constexpr const char* kOldTransformType = "tf/tfMessage";
inline constexpr const char* kPoseType = "geometry_msgs/PoseWithCovarianceStamped";
/// Read only.
inline constexpr const char* kPlainPoseType = "geometry_msgs/PoseStamped";

/// Whether BagFile::poses reads messages of this type.
inline bool isPoseType(const std::string& type) {
  return type == kPoseType || type == kPlainPoseType || type == kOdometryType;
}
inline constexpr const char* kMarkersType = "visualization_msgs/MarkerArray";
inline constexpr const char* kStringType = "std_msgs/String";

}  // namespace vismem
