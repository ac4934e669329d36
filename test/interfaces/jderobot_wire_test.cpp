// The wire contract of JdeRobot 5.6.7: type ids, and the order of class members as bytes.
// Tests C4.
#include <Ice/Ice.h>
#include <avm/base.h>
#include <avm/camera.h>
#include <avm/localization.h>
#include <avm/pantilt.h>
#include <avm/replay.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <jderobot/camera.h>
#include <jderobot/encoders.h>
#include <jderobot/pose3dencoders.h>
#include <jderobot/pose3dmotors.h>

#include <algorithm>
#include <cstring>
#include <initializer_list>
#include <vector>

namespace {

class Wire : public ::testing::Test {
 protected:
  /// Bytes of an object as it travels; encoding 1.0 leaves no room for optional members.
  std::vector<Ice::Byte> bytesOf(const Ice::ValuePtr& value) {
    Ice::OutputStream out(communicator.communicator(), Ice::Encoding_1_0);
    out.write(value);
    out.writePendingValues();
    std::vector<Ice::Byte> bytes;
    out.finished(bytes);
    return bytes;
  }

  static std::vector<Ice::Byte> floats(std::initializer_list<float> values) {
    std::vector<Ice::Byte> bytes(values.size() * sizeof(float));
    std::size_t at = 0;
    for (const float value : values) {
      std::memcpy(bytes.data() + at, &value, sizeof value);
      at += sizeof value;
    }
    return bytes;
  }

  static bool contains(const std::vector<Ice::Byte>& bytes, const std::vector<Ice::Byte>& part) {
    return std::search(bytes.begin(), bytes.end(), part.begin(), part.end()) != bytes.end();
  }

  // A holder made without arguments would be empty.
  Ice::CommunicatorHolder communicator{Ice::InitializationData()};
};

TEST_F(Wire, KeepsJdeRobotTypeIds) {
  EXPECT_EQ(jderobot::ImageData::ice_staticId(), "::jderobot::ImageData");
  EXPECT_EQ(jderobot::ImageDescription::ice_staticId(), "::jderobot::ImageDescription");
  EXPECT_EQ(jderobot::CameraDescription::ice_staticId(), "::jderobot::CameraDescription");
  EXPECT_EQ(jderobot::EncodersData::ice_staticId(), "::jderobot::EncodersData");
  EXPECT_EQ(jderobot::PTMotorsData::ice_staticId(), "::jderobot::PTMotorsData");
  EXPECT_EQ(jderobot::PTMotorsParams::ice_staticId(), "::jderobot::PTMotorsParams");
  EXPECT_EQ(jderobot::PTEncodersData::ice_staticId(), "::jderobot::PTEncodersData");
  EXPECT_EQ(jderobot::Pose3DData::ice_staticId(), "::jderobot::Pose3DData");
  EXPECT_EQ(jderobot::Pose3DMotorsData::ice_staticId(), "::jderobot::Pose3DMotorsData");
  EXPECT_EQ(jderobot::Pose3DEncodersData::ice_staticId(), "::jderobot::Pose3DEncodersData");
  EXPECT_EQ(jderobot::DataNotExistException::ice_staticId(), "::jderobot::DataNotExistException");
  EXPECT_EQ(jderobot::HardwareFailedException::ice_staticId(), "::jderobot::HardwareFailedException");
  EXPECT_EQ(jderobot::replayControl::ice_staticId(), "::jderobot::replayControl");
}

TEST_F(Wire, KeepsTheOrderOfMembers) {
  EXPECT_TRUE(contains(bytesOf(std::make_shared<jderobot::EncodersData>(1.f, 2.f, 3.f, 4.f, 5.f)),
                       floats({1, 2, 3, 4, 5})));
  auto motors = std::make_shared<jderobot::PTMotorsData>();
  motors->pan = 1;
  motors->panSpeed = 2;
  motors->tilt = 3;
  motors->tiltSpeed = 4;
  EXPECT_TRUE(contains(bytesOf(motors), floats({1, 2, 3, 4})));
  auto params = std::make_shared<jderobot::PTMotorsParams>();
  params->maxPan = 1;
  params->minPan = 2;
  params->maxTilt = 3;
  params->minTilt = 4;
  params->maxPanSpeed = 5;
  params->maxTiltSpeed = 6;
  EXPECT_TRUE(contains(bytesOf(params), floats({1, 2, 3, 4, 5, 6})));
  auto pose = std::make_shared<jderobot::Pose3DData>();
  pose->x = 1;
  pose->y = 2;
  pose->z = 3;
  pose->h = 4;
  pose->q0 = 5;
  pose->q1 = 6;
  pose->q2 = 7;
  pose->q3 = 8;
  EXPECT_TRUE(contains(bytesOf(pose), floats({1, 2, 3, 4, 5, 6, 7, 8})));
  auto camera = std::make_shared<jderobot::CameraDescription>();
  camera->fdistx = 1;
  camera->fdisty = 2;
  camera->u0 = 3;
  camera->v0 = 4;
  camera->skew = 5;
  camera->posx = 6;
  camera->foax = 9;
  camera->roll = 12;
  EXPECT_TRUE(contains(bytesOf(camera), floats({1, 2, 3, 4, 5, 6, 0, 0, 9, 0, 0, 12})));
  auto moved = std::make_shared<jderobot::Pose3DMotorsData>(1.f, 2.f, 3.f, 4.f, 5.f, 6.f, 7.f, 8.f);
  EXPECT_TRUE(contains(bytesOf(moved), floats({1, 2, 3, 4, 5, 6, 7, 8})));
  EXPECT_EQ(static_cast<int>(jderobot::ReplayerStatus::WAITING), 0);
  EXPECT_EQ(static_cast<int>(jderobot::ReplayerStatus::FINISHED), 3);
}

/// A servant of ours answers an ordinary JdeRobot client's check of the type.
TEST_F(Wire, OwnInterfacesAreJdeRobotsToo) {
  using ::testing::Contains;
  class Localization : public avm::Localization {
   public:
    std::shared_ptr<jderobot::Pose3DData> getPose3DData(const Ice::Current&) override { return nullptr; }
    int setPose3DData(std::shared_ptr<jderobot::Pose3DData>, const Ice::Current&) override { return -1; }
    avm::PoseEstimate latest(const Ice::Current&) override { return {}; }
    avm::MapContents getMap(const Ice::Current&) override { return {}; }
    void nextAsync(long long, std::function<void(const avm::EstimateResult&)>,
                   std::function<void(std::exception_ptr)>, const Ice::Current&) override {}
    avm::CommandReply setPose(avm::Pose2, const Ice::Current&) override { return {}; }
    avm::CommandReply relocalize(const Ice::Current&) override { return {}; }
    void healthMapAsync(avm::HealthMapRequest, std::function<void(const avm::HealthGrid&)> response,
                        std::function<void(std::exception_ptr)>, const Ice::Current&) override {
      response({});
    }
  };
  const Ice::Current current{};
  EXPECT_THAT(Localization().ice_ids(current), Contains("::jderobot::Pose3D"));
  EXPECT_THAT(Localization().ice_ids(current), Contains("::avm::Localization"));
  EXPECT_TRUE((std::is_base_of_v<jderobot::Camera, avm::Camera>));
  EXPECT_TRUE((std::is_base_of_v<jderobot::PTMotors, avm::PanTilt>));
  EXPECT_TRUE((std::is_base_of_v<jderobot::PTEncoders, avm::PanTilt>));
  EXPECT_TRUE((std::is_base_of_v<jderobot::Pose3DMotors, avm::PanTilt>));
  EXPECT_TRUE((std::is_base_of_v<jderobot::Pose3DEncoders, avm::PanTilt>));
  EXPECT_TRUE((std::is_base_of_v<jderobot::Motors, avm::Base>));
  EXPECT_TRUE((std::is_base_of_v<jderobot::Encoders, avm::Odometry>));
  EXPECT_TRUE((std::is_base_of_v<jderobot::Pose3D, avm::Odometry>));
  EXPECT_TRUE((std::is_base_of_v<jderobot::replayControl, avm::Replay>));
}

}  // namespace
