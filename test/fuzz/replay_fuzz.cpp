// A replay_server under somebody who writes its configuration, its recording and its commands: bags are
// whole, their messages may hold anything. Whatever comes, it says what is wrong or plays in order. Tests C2.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/config/config_error.h"
#include "common/image_codec/image_codec.h"
#include "common/recording/bag_encoder.h"
#include "fuzz/byte_reader.h"
#include "fuzz/replay_parts.h"
#include "replay_server/app/config.h"
#include "replay_server/core/log_ports.h"

namespace {

using namespace vismem;

constexpr int kMostMessages = 40;
constexpr int kMostCommands = 32;
constexpr StampUs kBegin = 5 * kSecondUs;

class BytesSink : public ByteSink {
 public:
  void write(ByteView more) override { bytes.insert(bytes.end(), more.begin(), more.end()); }
  void overwrite(std::uint64_t offset, ByteView over) override {
    std::copy(over.begin(), over.end(), bytes.begin() + static_cast<std::ptrdiff_t>(offset));
  }
  void truncate(std::uint64_t size) override { bytes.resize(size); }
  void sync() override {}

  Bytes bytes;
};

/// One of several.
template <std::size_t N>
std::string pick(ByteReader& in, const std::array<const char*, N>& words) {
  return words[in.byte() % N];
}

constexpr std::array kFrames{"odom", "base_footprint", "base_link", "camera_optical_frame", "/head", "map",
                             ""};
constexpr std::array kJoints{"pan", "tilt", "head_yaw", "head_pitch", ""};

/// Mostly small numbers, at times those that break arithmetic.
double anyNumber(ByteReader& in) {
  constexpr std::array kOdd{0.0,      -0.0,      1e-320,
                            1e300,    -1e300,    9.3e18,
                            HUGE_VAL, -HUGE_VAL, std::numeric_limits<double>::quiet_NaN()};
  const std::uint8_t kind = in.byte();
  return kind < 24 ? kOdd[kind % kOdd.size()] : in.real(-4.0, 4.0);
}

RosPose anyPose(ByteReader& in) {
  RosPose pose;
  pose.position = {anyNumber(in), anyNumber(in), anyNumber(in)};
  if (in.coin()) pose.orientation = {anyNumber(in), anyNumber(in), anyNumber(in), anyNumber(in)};
  return pose;
}

/// A JPEG and a PNG of 16x12 pixels, once.
const std::array<Bytes, 2>& pictures() {
  static const std::array<Bytes, 2> made = [] {
    cv::Mat image(12, 16, CV_8UC3, cv::Scalar(20, 90, 200));
    image.colRange(4, 9).setTo(cv::Scalar(250, 250, 250));
    std::array<Bytes, 2> files;
    cv::imencode(".jpg", image, files[0]);
    cv::imencode(".png", image, files[1]);
    return files;
  }();
  return made;
}

RosImage rawImage(ByteReader& in, const RosHeader& header) {
  constexpr std::array kEncodings{
      "rgb8",        "bgr8",        "rgba8",  "bgra8",       "mono8", "bayer_rggb8", "bayer_bggr8",
      "bayer_gbrg8", "bayer_grbg8", "yuv422", "yuv422_yuy2", "yuyv",  "mono16",      ""};
  constexpr std::array<std::uint32_t, 14> kBytes{3, 3, 4, 4, 1, 1, 1, 1, 1, 2, 2, 2, 2, 1};
  RosImage image;
  image.header = header;
  const std::size_t kind = in.byte() % kEncodings.size();
  image.encoding = kEncodings[kind];
  image.width = 16;
  image.height = 12;
  if (in.byte() < 64) {
    image.width = static_cast<std::uint32_t>(in.integer(0, 40));
    image.height = in.coin() ? static_cast<std::uint32_t>(in.integer(0, 40)) : 0xFFFFFFFFu - in.byte();
  }
  image.step = image.width * kBytes[kind] + (in.byte() < 64 ? in.byte() : 0u);
  const std::size_t size = std::min<std::size_t>(std::size_t{image.step} * image.height, 8192);
  image.data.assign(in.byte() < 32 ? size / 2 : size, in.byte());
  for (int i = 0; i < 8 && !image.data.empty(); ++i) image.data[in.byte() % image.data.size()] = in.byte();
  return image;
}

RosCompressedImage compressedImage(ByteReader& in, const RosHeader& header) {
  RosCompressedImage image{header, in.coin() ? "jpeg" : "png", pictures()[in.byte() % 2]};
  if (in.coin()) return image;
  for (int i = 0; i < 4; ++i)
    image.data[static_cast<std::size_t>(in.integer(0, 65535)) % image.data.size()] = in.byte();
  if (in.byte() < 64) image.data.resize(image.data.size() * in.byte() / 255);
  return image;
}

RosCameraInfo cameraInfo(ByteReader& in, const RosHeader& header) {
  RosCameraInfo info;
  info.header = header;
  info.width = in.byte() < 16 ? in.byte() : 16u;
  info.height = in.byte() < 16 ? in.byte() : 12u;
  info.k = {20, 0, 7.5, 0, 20, 5.5, 0, 0, 1};
  if (in.byte() < 32) info.k[in.byte() % 9] = anyNumber(in);
  if (in.byte() < 32) info.distortion_model = "equidistant";
  for (int i = in.integer(0, 6); i > 0; --i) info.d.push_back(0.01 * anyNumber(in));
  return info;
}

RosJointState jointState(ByteReader& in, const RosHeader& header) {
  RosJointState joints{header, {}, {}};
  for (int i = in.integer(0, 3); i > 0; --i) {
    joints.names.push_back(pick(in, kJoints));
    if (in.byte() > 16) joints.positions.push_back(anyNumber(in));
  }
  if (in.coin()) return {header, {"pan", "tilt"}, {anyNumber(in), anyNumber(in)}};
  return joints;
}

/// One message of one of the topics, sometimes cut or with other bytes.
void addMessage(ByteReader& in, BagEncoder& bag, StampUs stamp_us) {
  const RosHeader header{in.byte() < 8 ? 0 : stamp_us,
                         in.coin() ? "camera_optical_frame" : pick(in, kFrames)};
  BagChannel channel;
  Bytes bytes;
  switch (in.byte() % 7) {
    case 0:
      channel = {in.coin() ? "/camera/image_raw" : "/other/image_raw", kRawImageType};
      bytes = serialize(rawImage(in, header));
      break;
    case 1:
      channel = {in.coin() ? "/camera/image_raw/compressed" : "/camera/image_raw", kCompressedImageType};
      bytes = serialize(compressedImage(in, header));
      break;
    case 2:
      channel = {in.coin() ? "/camera/camera_info" : "/info", kCameraInfoType};
      bytes = serialize(cameraInfo(in, header));
      break;
    case 3: {
      RosOdometry odometry{header, "base_footprint", anyPose(in), {}, anyNumber(in), anyNumber(in)};
      channel = {in.byte() < 240 ? "/odom" : "/odom2", kOdometryType};
      bytes = serialize(odometry);
      break;
    }
    case 4:
      channel = {"/joint_states", kJointStateType};
      bytes = serialize(jointState(in, header));
      break;
    case 5: {
      std::vector<RosTransform> transforms;
      for (int i = in.integer(1, 3); i > 0; --i)
        transforms.push_back({{stamp_us, pick(in, kFrames)}, pick(in, kFrames), anyPose(in)});
      channel = {in.coin() ? "/tf" : "/tf_static", kTransformType};
      bytes = serialize(transforms);
      break;
    }
    default:
      channel = {"/ground_truth/pose", kPoseType};
      bytes = serialize(RosPoseWithCovariance{header, anyPose(in), {}});
  }
  const std::uint8_t harm = in.byte();
  if (harm < 8) bytes.resize(bytes.size() * in.byte() / 256);
  if (harm >= 8 && harm < 24)
    bytes[static_cast<std::size_t>(in.integer(0, 65535)) % bytes.size()] = in.byte();
  bag.add(channel, stamp_us, bytes);
}

Bytes recording(ByteReader& in) {
  BytesSink sink;
  BagEncoder bag(sink, in.coin() ? BagCompression::kNone : BagCompression::kLz4);
  StampUs stamp_us = kBegin;
  // What nearly every robot has, so that most inputs come as far as playing.
  const std::uint8_t lacks = in.byte();
  for (int i = 0; i < 3; ++i, stamp_us += 20'000) {
    const RosHeader header{stamp_us, "odom"};
    if (lacks >= 8) bag.add({"/odom", kOdometryType}, stamp_us, serialize(RosOdometry{header, "", {}, {}}));
    if (lacks >= 16) {
      bag.add({"/joint_states", kJointStateType}, stamp_us,
              serialize(RosJointState{header, {"pan", "tilt"}, {0.1, 0.2}}));
    }
  }
  for (int i = in.integer(1, kMostMessages); i > 0 && in.left() > 0; --i) {
    addMessage(in, bag, stamp_us);
    stamp_us += in.byte() < 8 ? -3 * kSecondUs : 1'000 * in.byte();
    stamp_us = std::max<StampUs>(stamp_us, 0);
    if (in.byte() < 64) bag.closeChunk();
  }
  bag.finish();
  return std::move(sink.bytes);
}

/// Keys with values that fit, nearly fit, or do not.
ReplayServerConfig configuration(ByteReader& in, const std::string& file) {
  constexpr std::array kKeys{"Topics.Image",
                             "Topics.CameraInfo",
                             "Topics.Odometry",
                             "Topics.Joints",
                             "Frames.Robot",
                             "Frames.Camera",
                             "Frames.Odom",
                             "Joints.Pan",
                             "Joints.Tilt",
                             "Joints.TiltUp",
                             "MaximumGap_s",
                             "Camera.Fixed",
                             "Camera.FieldOfView_deg",
                             "Rate",
                             "Loop",
                             "Start"};
  constexpr std::array kValues{"/camera/image_raw",
                               "/camera/image_raw/compressed",
                               "/camera/camera_info",
                               "/odom",
                               "/joint_states",
                               "base_footprint",
                               "odom",
                               "camera_optical_frame",
                               "pan",
                               "tilt",
                               "auto",
                               "negative",
                               "0.5",
                               "90",
                               "yes",
                               "no",
                               "now",
                               "paused",
                               "client",
                               "1e9",
                               "-1",
                               "nan",
                               ""};
  Properties properties;
  properties.set("ReplayServer.File", file);
  properties.set("ReplayServer.Camera.FieldOfView_deg", "60");
  for (int i = in.integer(0, 4); i > 0; --i) {
    const std::string key = pick(in, kKeys);
    properties.set("ReplayServer." + key, pick(in, kValues));
  }
  ConfigReader reader(properties);
  ConfigReader group = reader.group("ReplayServer");
  ReplayServerConfig config = readReplayServerConfig(group);
  reader.finish();
  return config;
}

void require(bool holds, const char* what) {
  if (!holds) throw std::logic_error(what);
}

/// A client that does anything, and sees that what it gets is in order.
class Client {
 public:
  Client(LogPlayer& player, ByteReader& in) : player_(player), in_(in) {}

  void act() {
    switch (in_.byte() % 12) {
      case 0:
      case 1:
        return look();
      case 2:
        return follow(player_.base());
      case 3:
        return follow(player_.panTilt());
      case 4:
        player_.seek(stamp());
        return;
      case 5:
        player_.step(in_.coin() ? in_.integer(-5, 5) : std::numeric_limits<int>::min() + in_.byte());
        return;
      case 6:
        player_.setRate(anyNumber(in_));
        return;
      case 7:
        player_.setRange(stamp(), stamp());
        return;
      case 8:
        player_.setPlayLength(stamp());
        return;
      case 9:
        player_.setLoop(in_.coin());
        return;
      case 10:
        in_.coin() ? player_.play() : player_.pause();
        return;
      default:
        player_.consumerArrived();
        player_.contents();
        command();
        player_.base().setVelocity(anyNumber(in_), anyNumber(in_));
    }
  }

 private:
  /// Mostly of the log.
  StampUs stamp() {
    const std::uint8_t kind = in_.byte();
    if (kind < 4) return std::numeric_limits<StampUs>::min() + kind;
    if (kind < 8) return std::numeric_limits<StampUs>::max() - kind;
    return kBegin + 1'000 * in_.integer(-3'000, 6'000);
  }
  std::chrono::milliseconds patience() { return std::chrono::milliseconds(in_.byte()); }

  void command() {
    PanTiltCommand wanted;
    wanted.pan_rad = anyNumber(in_);
    wanted.tilt_rad = anyNumber(in_);
    player_.panTilt().command(wanted);
  }
  void look() {
    const FrameResult result = player_.camera().next(patience());
    if (!result.frame) return;
    const Frame& frame = *result.frame;
    require(frame.stamp_us <= player_.status().stamp_us, "an image from the future");
    require(frame.seq >= next_seq_, "an image twice");
    next_seq_ = frame.seq + 1;
    if (frame.native == nullptr) {
      require(frame.image.cols == frame.intrinsics.width && frame.image.rows == frame.intrinsics.height,
              "an image of another size");
      return;
    }
    decodeImage(*frame.native);
  }
  template <typename Port>
  void follow(Port& port) {
    const auto batch = port.samplesSince(stamp(), patience());
    StampUs last_us = std::numeric_limits<StampUs>::min();
    for (const auto& sample : batch.samples) {
      require(sample.stamp_us > last_us, "samples that do not increase");
      last_us = sample.stamp_us;
    }
    require(last_us <= player_.status().stamp_us, "a sample from the future");
  }

  LogPlayer& player_;
  ByteReader& in_;
  std::uint64_t next_seq_ = 0;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  ByteReader in(data, size);
  try {
    const Bytes bag = recording(in);
    const MemoryFile file(bag.data(), bag.size());
    const ReplayServerConfig config = configuration(in, file.name());
    JumpingClock clock;
    LogPlayer player(RobotLog::open(config.files, config.log), config.player, clock);
    FrameRequest request;
    request.accept_native = in.coin();
    player.camera().configure(request);
    player.panTilt().limits();
    player.log().truth();
    Client client(player, in);
    for (int i = 0; i < kMostCommands && in.left() > 0; ++i) client.act();
  } catch (const RecordingError&) {
    return 0;  // said what is wrong
  } catch (const ConfigError&) {
    return 0;
  }
  return 0;
}
