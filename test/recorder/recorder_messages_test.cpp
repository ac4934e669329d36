// Tests C1. What the components publish, as the messages of a recording.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "common/recording/ros_messages.h"
#include "common/recording/ros_types.h"
#include "recorder/ice/estimate_messages.h"

namespace vismem {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Key;
using ::testing::Not;

/// Messages by topic.
class Collected {
 public:
  Emit emit() {
    return [this](RecordedMessage message) {
      EXPECT_NE(findRosType(message.topic->channel.type), nullptr) << message.topic->channel.type;
      all[message.topic->channel.topic].push_back(message);
    };
  }
  const RecordedMessage& only(const std::string& topic) const {
    EXPECT_EQ(all.count(topic), 1u) << topic;
    return all.at(topic).front();
  }
  nlohmann::json json(const std::string& topic) const {
    return nlohmann::json::parse(parseString(*only(topic).bytes));
  }

  std::map<std::string, std::vector<RecordedMessage>> all;
};

avm::Frame frame(const std::string& format, std::size_t bytes) {
  avm::Frame f{};
  f.stampUs = 1'234'567;
  f.seq = 3;
  f.format = format;
  f.width = 3;
  f.height = 2;
  f.cameraModel = {3, 2, 10.0, 11.0, 1.0, 0.5, 0.1, 0.2, 0.3, 0.4, 0.5};
  f.hasCameraPose = false;
  for (std::size_t i = 0; i < bytes; ++i) f.pixels.push_back(static_cast<std::uint8_t>(i));
  return f;
}

TEST(CameraMessages, KeepImagesAsTheyWereCaptured) {
  const CameraMessages camera("/camera", ImageStorage::kCaptured);
  const std::map<std::string, std::pair<std::string, std::size_t>> raw{
      {"RGB8", {"rgb8", 18}}, {"GRAY8", {"mono8", 6}}, {"YUY2", {"yuv422_yuy2", 16}}};
  for (const auto& [format, expected] : raw) {
    Collected out;
    EXPECT_EQ(camera.convert(frame(format, expected.second), out.emit()), "");
    const RosImage image = parseImage(*out.only("/camera/image_raw").bytes);
    EXPECT_EQ(image.encoding, expected.first);
    EXPECT_EQ(image.header.stamp_us, 1'234'567);
    EXPECT_EQ(image.header.frame_id, "camera_optical_frame");
    EXPECT_EQ(image.step * 2, expected.second);
    EXPECT_EQ(image.data, frame(format, expected.second).pixels);
    const RosCameraInfo info = parseCameraInfo(*out.only("/camera/camera_info").bytes);
    EXPECT_EQ(info.k[0], 10.0);
    EXPECT_EQ(info.k[4], 11.0);
    EXPECT_EQ(info.d, (std::vector<double>{0.1, 0.2, 0.3, 0.4, 0.5}));
    EXPECT_THAT(out.all, Not(Contains(Key("/tf"))));
  }
  Collected out;
  EXPECT_EQ(camera.convert(frame("JPEG", 40), out.emit()), "");
  const RosCompressedImage jpeg = parseCompressedImage(*out.only("/camera/image_raw/compressed").bytes);
  EXPECT_EQ(jpeg.format, "jpeg");
  EXPECT_EQ(jpeg.data, frame("JPEG", 40).pixels);
}

TEST(CameraMessages, StorePngAndPoses) {
  Collected out;
  avm::Frame f = frame("RGB8", 18);
  f.hasCameraPose = true;
  f.cameraOnRobot = {{0.1, 0.2, 0.3}, 0.5, 0.5, -0.5, 0.5};
  EXPECT_EQ(CameraMessages("/front", ImageStorage::kPng).convert(f, out.emit()), "");
  const RosCompressedImage png = parseCompressedImage(*out.only("/front/image_raw/compressed").bytes);
  EXPECT_EQ(png.format, "png");
  ASSERT_GT(png.data.size(), 8u);
  EXPECT_EQ(png.data[1], 'P');
  const auto transforms = parseTransforms(*out.only("/tf").bytes);
  ASSERT_EQ(transforms.size(), 1u);
  EXPECT_EQ(transforms[0].header.frame_id, "base_footprint");
  EXPECT_EQ(transforms[0].child_frame_id, "front_optical_frame");
  EXPECT_EQ(transforms[0].pose.position.z, 0.3);
  EXPECT_EQ(transforms[0].pose.orientation.y, -0.5);
}

TEST(CameraMessages, RefuseImagesWhoseSizeIsWrong) {
  Collected out;
  const CameraMessages camera("/camera", ImageStorage::kRaw);
  EXPECT_THAT(camera.convert(frame("RGB8", 17), out.emit()), HasSubstr("with 17 bytes (expected RGB8"));
  EXPECT_THAT(camera.convert(frame("BGR8", 18), out.emit()), HasSubstr("format BGR8"));
  avm::Frame f = frame("RGB8", 18);
  f.width = -3;
  EXPECT_THAT(camera.convert(f, out.emit()), HasSubstr("-3x2"));
  EXPECT_TRUE(out.all.empty());
}

TEST(SensorMessages, OdometryAndJoints) {
  Collected out;
  convertOdometry({2'000'000, 7, {1.0, 2.0, M_PI / 2}, 0.3, 0.4}, out.emit());
  const RosOdometry odometry = parseOdometry(*out.only("/odom").bytes);
  EXPECT_EQ(odometry.header.stamp_us, 2'000'000);
  EXPECT_EQ(odometry.header.frame_id, "odom");
  EXPECT_EQ(odometry.child_frame_id, "base_footprint");
  EXPECT_EQ(odometry.pose.position.y, 2.0);
  EXPECT_NEAR(odometry.pose.orientation.z, std::sqrt(0.5), 1e-15);
  EXPECT_EQ(odometry.v_mps, 0.3);
  EXPECT_EQ(odometry.w_radps, 0.4);
  EXPECT_EQ(parseTransforms(*out.only("/tf").bytes)[0].child_frame_id, "base_footprint");
  convertPanTilt({2'500'000, 8, 0.5, -0.25}, out.emit());
  const RosJointState joints = parseJointState(*out.only("/joint_states").bytes);
  EXPECT_EQ(joints.names, (std::vector<std::string>{"pan", "tilt"}));
  EXPECT_EQ(joints.positions, (std::vector<double>{0.5, -0.25}));
}

TEST(EstimateMessages, MapToOdomJoinsBothPoses) {
  Collected out;
  avm::PoseEstimate estimate{};
  estimate.stampUs = 5;
  estimate.hasPose = true;
  estimate.robotInWorld = {3.0, 4.0, M_PI};
  estimate.robotInOdom = {1.0, 0.0, M_PI / 2};
  estimate.covariance = {1.0, 2.0, 3.0, 4.0, 5.0, 6.0};
  estimate.reliability = 0.75;
  estimate.races.push_back({9, {3.0, 4.0, M_PI}, 0.8, 1.0, 2, 3, true});
  convertEstimate(estimate, out.emit());
  // Odom is turned by pi - pi/2 = pi/2: the robot's (1, 0) in odom is (0, 1) from odom's origin in the world.
  const RosTransform transform = parseTransforms(*out.only("/tf").bytes)[0];
  EXPECT_EQ(transform.header.frame_id, "map");
  EXPECT_EQ(transform.child_frame_id, "odom");
  EXPECT_NEAR(transform.pose.position.x, 3.0, 1e-12);
  EXPECT_NEAR(transform.pose.position.y, 3.0, 1e-12);
  EXPECT_NEAR(transform.pose.orientation.z, std::sin(M_PI / 4), 1e-12);
  const RosPoseWithCovariance pose = parsePoseWithCovariance(*out.only("/localization/pose").bytes);
  EXPECT_EQ(pose.pose.position.x, 3.0);
  EXPECT_EQ(pose.covariance[0], 1.0);
  EXPECT_EQ(pose.covariance[1], 2.0);
  EXPECT_EQ(pose.covariance[5], 3.0);
  EXPECT_EQ(pose.covariance[7], 4.0);
  EXPECT_EQ(pose.covariance[31], 5.0);
  EXPECT_EQ(pose.covariance[35], 6.0);
  EXPECT_EQ(out.json("/localization/estimate").at("races").at(0).at("id"), 9);
  estimate.hasPose = false;
  Collected none;
  convertEstimate(estimate, none.emit());
  EXPECT_THAT(none.all, Not(Contains(Key("/localization/pose"))));
}

TEST(EstimateMessages, MemoryGazeTruthAndComponents) {
  Collected out;
  avm::MemoryUpdate update{};
  update.snapshot.stampUs = update.analysis.stampUs = 77;
  update.snapshot.revision = 4;
  avm::MemorySegment segment{};
  segment.id = 12;
  segment.a = {1.0, 2.0, 0.0};
  segment.b = {3.0, 4.0, 0.0};
  segment.label = "line\xFF";  // a palette's name may be any bytes
  segment.life = std::nan("");
  update.snapshot.segments.push_back(segment);
  update.analysis.cameraOnRobot = {{0.0, 0.0, 0.4}, 1.0, 0.0, 0.0, 0.0};
  convertMemory(update, out.emit());
  EXPECT_EQ(out.json("/memory/snapshot").at("segments").at(0).at("id"), 12);
  EXPECT_EQ(out.json("/memory/analysis").at("stamp_us"), 77);
  EXPECT_THAT(out.all, Contains(Key("/memory/segments")));
  EXPECT_EQ(parseTransforms(*out.only("/tf").bytes)[0].child_frame_id, "memory_camera");

  avm::GazeStatus gaze{};
  gaze.stampUs = 78;
  gaze.mode = avm::GazeMode::Fixate;
  gaze.state = avm::GazeState::Track;
  gaze.hasTarget = true;
  gaze.target.target.isPlace = true;
  convertGaze(gaze, out.emit());
  EXPECT_EQ(out.json("/gaze/status").at("mode"), "fixate");

  TruthMessages truth;
  truth.convert({1, 1, {1.0, 2.0, 0.0}, false, 0}, out.emit());
  truth.convert({2, 2, {1.0, 2.0, 0.0}, false, 0}, out.emit());
  truth.convert({3, 3, {5.0, 2.0, 0.0}, false, 1}, out.emit());
  EXPECT_EQ(out.all["/ground_truth/pose"].size(), 3u);
  EXPECT_EQ(out.all["/ground_truth/state"].size(), 2u) << "only when it changed";

  avm::ComponentStatus status{};
  status.name = "localization";
  status.state = avm::ComponentState::Degraded;
  status.reason = "camera is away";
  convertComponent(status, 99, out.emit());
  EXPECT_EQ(out.json("/components/localization").at("reason"), "camera is away");
  EXPECT_EQ(out.only("/components/localization").stamp_us, 99);
}

}  // namespace
}  // namespace vismem
