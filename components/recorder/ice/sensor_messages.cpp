#include "recorder/ice/sensor_messages.h"

#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "common/recording/ros_messages.h"
#include "recorder/core/recorder_core.h"

namespace vismem {
namespace {

/// PNG's fastest level: a fifth of the time of the default at a tenth more bytes.
constexpr int kPngLevel = 1;

std::string opticalFrame(const std::string& prefix) {
  return prefix.substr(prefix.find_first_not_of('/') == std::string::npos ? 0
                                                                          : prefix.find_first_not_of('/')) +
         "_optical_frame";
}

RosCameraInfo cameraInfo(const avm::Intrinsics& k, const RosHeader& header) {
  RosCameraInfo info;
  info.header = header;
  info.width = static_cast<std::uint32_t>(k.width);
  info.height = static_cast<std::uint32_t>(k.height);
  info.d = {k.k1, k.k2, k.p1, k.p2, k.k3};
  info.k = {k.fx, 0.0, k.cx, 0.0, k.fy, k.cy, 0.0, 0.0, 1.0};
  info.r = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
  info.p = {k.fx, 0.0, k.cx, 0.0, 0.0, k.fy, k.cy, 0.0, 0.0, 0.0, 1.0, 0.0};
  return info;
}

/// Bytes that an image of a format must have; 0 for JPEG, which says its size itself.
std::size_t expectedBytes(const avm::Frame& frame) {
  const auto width = static_cast<std::size_t>(frame.width);
  const auto height = static_cast<std::size_t>(frame.height);
  if (frame.format == "RGB8") return 3 * width * height;
  if (frame.format == "GRAY8") return width * height;
  if (frame.format == "YUY2") return (width + 1) / 2 * 4 * height;
  return 0;
}

RosPose toRos(const avm::Pose3& pose) {
  return {{pose.position.x, pose.position.y, pose.position.z}, {pose.qx, pose.qy, pose.qz, pose.qw}};
}

}  // namespace

RosTransform planarTransform(std::int64_t stamp_us, const std::string& parent, const std::string& child,
                             const avm::Pose2& pose) {
  return {{stamp_us, parent},
          child,
          {{pose.x, pose.y, 0.0}, {0.0, 0.0, std::sin(0.5 * pose.theta), std::cos(0.5 * pose.theta)}}};
}

CameraMessages::CameraMessages(const std::string& prefix, ImageStorage storage)
    : storage_(storage),
      frame_id_(opticalFrame(prefix)),
      raw_(makeTopic(prefix + "/image_raw", kRawImageType, /*image=*/true)),
      compressed_(makeTopic(prefix + "/image_raw/compressed", kCompressedImageType, /*image=*/true)),
      info_(makeTopic(prefix + "/camera_info", kCameraInfoType)),
      tf_(makeTopic("/tf", kTransformType)) {}

std::string CameraMessages::convertPixels(const avm::Frame& frame, const Emit& emit) const {
  const RosHeader header{frame.stampUs, frame_id_};
  if (storage_ == ImageStorage::kPng && frame.format != "YUY2") {
    const bool grey = frame.format == "GRAY8";
    const cv::Mat pixels(frame.height, frame.width, grey ? CV_8UC1 : CV_8UC3,
                         const_cast<std::uint8_t*>(frame.pixels.data()));
    cv::Mat bgr = pixels;
    if (!grey) cv::cvtColor(pixels, bgr, cv::COLOR_RGB2BGR);
    RosCompressedImage image{header, "png", {}};
    if (!cv::imencode(".png", bgr, image.data, {cv::IMWRITE_PNG_COMPRESSION, kPngLevel})) {
      return "the image cannot be encoded as PNG";
    }
    emit(recordedMessage(compressed_, frame.stampUs, serialize(image)));
    return {};
  }
  RosImage image;
  image.header = header;
  image.width = static_cast<std::uint32_t>(frame.width);
  image.height = static_cast<std::uint32_t>(frame.height);
  image.encoding = frame.format == "RGB8" ? "rgb8" : frame.format == "GRAY8" ? "mono8" : "yuv422_yuy2";
  image.step = static_cast<std::uint32_t>(expectedBytes(frame) / static_cast<std::size_t>(frame.height));
  image.data = frame.pixels;
  emit(recordedMessage(raw_, frame.stampUs, serialize(image)));
  return {};
}

std::string CameraMessages::convert(const avm::Frame& frame, const Emit& emit) const {
  if (frame.width <= 0 || frame.height <= 0) {
    return "an image of " + std::to_string(frame.width) + "x" + std::to_string(frame.height) + " pixels";
  }
  const std::size_t expected = expectedBytes(frame);
  if (frame.format == "JPEG") {
    emit(recordedMessage(compressed_, frame.stampUs,
                         serialize(RosCompressedImage{{frame.stampUs, frame_id_}, "jpeg", frame.pixels})));
  } else if (expected == 0 || frame.pixels.size() != expected) {
    return "an image of the format " + frame.format + " with " + std::to_string(frame.pixels.size()) +
           " bytes (expected RGB8, GRAY8, YUY2 or JPEG with the bytes of " + std::to_string(frame.width) +
           "x" + std::to_string(frame.height) + " pixels)";
  } else if (const std::string wrong = convertPixels(frame, emit); !wrong.empty()) {
    return wrong;
  }
  emit(recordedMessage(info_, frame.stampUs,
                       serialize(cameraInfo(frame.cameraModel, {frame.stampUs, frame_id_}))));
  if (frame.hasCameraPose) {
    const std::vector<RosTransform> transforms{
        {{frame.stampUs, kRobotFrame}, frame_id_, toRos(frame.cameraOnRobot)}};
    emit(recordedMessage(tf_, frame.stampUs, serialize(transforms)));
  }
  return {};
}

void convertOdometry(const avm::OdometrySample& sample, const Emit& emit) {
  static const auto topic = makeTopic("/odom", kOdometryType);
  static const auto tf = makeTopic("/tf", kTransformType);
  const RosTransform transform = planarTransform(sample.stampUs, kOdomFrame, kRobotFrame, sample.robotInOdom);
  RosOdometry odometry;
  odometry.header = transform.header;
  odometry.child_frame_id = kRobotFrame;
  odometry.pose = transform.pose;
  odometry.v_mps = sample.vMps;
  odometry.w_radps = sample.wRadps;
  emit(recordedMessage(topic, sample.stampUs, serialize(odometry)));
  emit(recordedMessage(tf, sample.stampUs, serialize(std::vector<RosTransform>{transform})));
}

void convertPanTilt(const avm::PanTiltSample& sample, const Emit& emit) {
  static const auto topic = makeTopic("/joint_states", kJointStateType);
  const RosJointState joints{{sample.stampUs, ""}, {"pan", "tilt"}, {sample.panRad, sample.tiltRad}};
  emit(recordedMessage(topic, sample.stampUs, serialize(joints)));
}

}  // namespace vismem
