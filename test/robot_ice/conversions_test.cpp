// Conversions of common/robot_ice: every field in both directions, JdeRobot's units and signs.
// Tests C4.
#include "common/robot_ice/conversions.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <opencv2/imgcodecs.hpp>

#include "common/geometry/angles.h"
#include "common/image_codec/image_codec.h"
#include "common/robot_ice/base_ice.h"
#include "common/robot_ice/frame_codec.h"
#include "common/robot_ice/md5.h"
#include "common/robot_ice/pantilt_ice.h"
#include "common/robot_ice/replay_ice.h"
#include "common/robot_ice/simulation_ice.h"

namespace vismem {
namespace {

using ::testing::HasSubstr;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

std::string md5Of(const std::string& text) {
  return md5Hex({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

/// The test suite of RFC 1321, appendix A.5; the last is longer than one block.
TEST(Md5, MatchesTheRfc) {
  EXPECT_EQ(md5Of(""), "d41d8cd98f00b204e9800998ecf8427e");
  EXPECT_EQ(md5Of("abc"), "900150983cd24fb0d6963f7d28e17f72");
  EXPECT_EQ(md5Of("message digest"), "f96b697d7cb7938d525a2f31aaf161d0");
  EXPECT_EQ(md5Of("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789"),
            "d174ab98d277d9f5a5611c2c9f419d9f");
  EXPECT_EQ(md5Of("12345678901234567890123456789012345678901234567890123456789012345678901234567890"),
            "57edf4a22be3c955ac49da2e2107b67a");
}

TEST(Conversions, PosesComeBack) {
  const Pose3 pose = poseFromXyzRpy(1, -2, 0.5, 0.1, -0.2, 2.5);
  const auto back = fromIce(toIce(pose));
  ASSERT_TRUE(back);
  EXPECT_TRUE(back->isApprox(pose, 1e-12));
  const Pose2 flat{1.5, -2.5, 3.0};
  EXPECT_EQ(fromIce(toIce(flat)), flat);
}

TEST(Conversions, RefusesPosesThatAreNotRigid) {
  avm::Pose3 pose = toIce(Pose3::Identity());
  pose.qw = 0.5;
  EXPECT_FALSE(fromIce(pose));
  pose.qw = kNaN;
  EXPECT_FALSE(fromIce(pose));
  pose.qw = 1.0;
  pose.position.y = kNaN;
  EXPECT_FALSE(fromIce(pose));
}

TEST(Conversions, IntrinsicsAndCovariancesComeBack) {
  const CameraIntrinsics intrinsics{320, 240, 1, 2, 3, 4, 5, 6, 7, 8, 9};
  EXPECT_EQ(fromIce(toIce(intrinsics)), intrinsics);
  Eigen::Matrix3d P;
  P << 1, 2, 3, 2, 4, 5, 3, 5, 6;
  EXPECT_EQ(fromIce(toIce(P)), P);
}

TEST(Conversions, SamplesAndLimitsComeBack) {
  const PanTiltSample angles = fromIce(toIce(PanTiltSample{11, 12, 0.3, -0.4}));
  EXPECT_EQ(angles.stamp_us, 11);
  EXPECT_EQ(angles.seq, 12U);
  EXPECT_EQ(angles.pan_rad, 0.3);
  EXPECT_EQ(angles.tilt_rad, -0.4);

  const OdometrySample odometry = fromIce(toIce(OdometrySample{21, 22, {1, 2, 3}, 0.4, 0.5}));
  EXPECT_EQ(odometry.stamp_us, 21);
  EXPECT_EQ(odometry.seq, 22U);
  EXPECT_EQ(odometry.T_odom_robot, (Pose2{1, 2, 3}));
  EXPECT_EQ(odometry.v_mps, 0.4);
  EXPECT_EQ(odometry.w_radps, 0.5);

  const TruthSample truth = fromIce(toIce(TruthSample{31, 32, {4, 5, 6}, true, 7}));
  EXPECT_EQ(truth.stamp_us, 31);
  EXPECT_EQ(truth.seq, 32U);
  EXPECT_EQ(truth.T_world_robot, (Pose2{4, 5, 6}));
  EXPECT_TRUE(truth.in_collision);
  EXPECT_EQ(truth.kidnaps, 7U);

  const PanTiltLimits limits = fromIce(toIce(PanTiltLimits{-1, 2, -3, 4, 5, 6}));
  EXPECT_EQ(limits.min_pan_rad, -1);
  EXPECT_EQ(limits.max_pan_rad, 2);
  EXPECT_EQ(limits.min_tilt_rad, -3);
  EXPECT_EQ(limits.max_tilt_rad, 4);
  EXPECT_EQ(limits.max_pan_rate_radps, 5);
  EXPECT_EQ(limits.max_tilt_rate_radps, 6);

  const BaseLimits base = fromIce(toIce(BaseLimits{1, 2, 3}));
  EXPECT_EQ(base.max_speed_mps, 1);
  EXPECT_EQ(base.max_turn_rate_radps, 2);
  EXPECT_EQ(base.watchdog_s, 3);
}

TEST(Conversions, StatusesComeBack) {
  const SimulationStatus simulation = fromIce(toIce(SimulationStatus{"corridor", 7, 8, true, 2.0, 1.5}));
  EXPECT_EQ(simulation.world, "corridor");
  EXPECT_EQ(simulation.seed, 7U);
  EXPECT_EQ(simulation.stamp_us, 8);
  EXPECT_TRUE(simulation.paused);
  EXPECT_EQ(simulation.speed, 2.0);
  EXPECT_EQ(simulation.real_speed, 1.5);
  for (const auto state :
       {ReplayState::kWaiting, ReplayState::kPlaying, ReplayState::kPaused, ReplayState::kFinished}) {
    const ReplayStatus replay = fromIce(toIce(ReplayStatus{state, "a.bag", 1, 2, 3, 4.0, true}));
    EXPECT_EQ(replay.state, state);
    EXPECT_EQ(replay.file, "a.bag");
    EXPECT_EQ(replay.first_us, 1);
    EXPECT_EQ(replay.last_us, 2);
    EXPECT_EQ(replay.stamp_us, 3);
    EXPECT_EQ(replay.rate, 4.0);
    EXPECT_TRUE(replay.loop);
  }
  for (const auto state : {SourceState::kWaiting, SourceState::kRunning, SourceState::kFinished}) {
    EXPECT_EQ(fromIce(toIce(state)), state);
  }
}

/// 1.5 m = 1500 mm; -90 degrees = 270 degrees on JdeRobot's wire.
TEST(Conversions, EncodersAreMillimetresAndPositiveDegrees) {
  const jderobot::EncodersData data = toEncoders({1.5, -0.25, degToRad(-90)});
  EXPECT_FLOAT_EQ(data.robotx, 1500.F);
  EXPECT_FLOAT_EQ(data.roboty, -250.F);
  EXPECT_FLOAT_EQ(data.robottheta, 270.F);
  EXPECT_NEAR(data.robotcos, 0.0, 1e-6);
  EXPECT_FLOAT_EQ(data.robotsin, -1.F);
  EXPECT_LT(toEncoders({0, 0, -1e-12}).robottheta, 360.F);
}

TEST(Conversions, RejectionBecomesAnException) {
  EXPECT_FALSE(toIce(PortReply::accepted()).adjusted);
  EXPECT_EQ(toIce(PortReply::adjusted("to 1 m/s")).message, "to 1 m/s");
  try {
    toIce(PortReply::rejected("motors are off"));
    FAIL() << "must throw";
  } catch (const avm::Refused& refused) {
    EXPECT_EQ(refused.reason, "motors are off");
  }
}

Frame colourFrame() {
  Frame frame;
  frame.stamp_us = 1'250'000;
  frame.seq = 42;
  frame.image = cv::Mat(4, 6, CV_8UC3, cv::Scalar(200, 100, 50));  // R, G, B
  frame.intrinsics = {6, 4, 10, 11, 2.5, 1.5, 0.1, 0.2, 0.3, 0.4, 0.5};
  frame.T_robot_camera = poseFromXyzRpy(0.1, 0.2, 0.45, 0.1, 0.2, 0.3);
  return frame;
}

TEST(FrameCodec, RawFramesComeBackExactly) {
  const Frame frame = colourFrame();
  const EncodedFrame encoded(frame, 85);
  const FrameResult back = decodeFrame(encoded.result(FrameFormat::kRgb8));
  ASSERT_EQ(back.state, SourceState::kRunning) << back.message;
  EXPECT_EQ(back.frame->stamp_us, 1'250'000);
  EXPECT_EQ(back.frame->seq, 42U);
  EXPECT_EQ(back.frame->intrinsics, frame.intrinsics);
  ASSERT_TRUE(back.frame->T_robot_camera);
  EXPECT_TRUE(back.frame->T_robot_camera->isApprox(*frame.T_robot_camera, 1e-12));
  EXPECT_EQ(cv::norm(back.frame->image, frame.image, cv::NORM_INF), 0.0);
}

TEST(FrameCodec, PartOfAnImageIsSentWithoutItsNeighbours) {
  Frame frame;
  const cv::Mat whole = (cv::Mat_<std::uint8_t>(2, 3) << 1, 2, 3, 4, 5, 6);
  frame.image = whole.colRange(0, 2);
  const EncodedFrame encoded(frame, 85);
  EXPECT_EQ(encoded.result(FrameFormat::kGray8).image.pixels, (jderobot::ByteSeq{1, 2, 4, 5}));
}

TEST(FrameCodec, JpegKeepsTheOrderOfColours) {
  const EncodedFrame encoded(colourFrame(), 95);
  const FrameResult back = decodeFrame(encoded.result(FrameFormat::kJpeg));
  ASSERT_EQ(back.state, SourceState::kRunning) << back.message;
  const auto pixel = back.frame->image.at<cv::Vec3b>(1, 1);
  EXPECT_NEAR(pixel[0], 200, 4);  // the encoder's loss on a flat picture
  EXPECT_NEAR(pixel[1], 100, 4);
  EXPECT_NEAR(pixel[2], 50, 4);
}

TEST(FrameCodec, Yuy2ComesBackInItsColoursAndOddWidth) {
  Frame frame = colourFrame();
  frame.image = frame.image.colRange(0, 5);
  const EncodedFrame encoded(frame, 85);
  const avm::FrameResult& result = encoded.result(FrameFormat::kYuy2);
  EXPECT_EQ(result.image.pixels.size(), 3U * 4U * 4U);
  const FrameResult back = decodeFrame(result);
  ASSERT_TRUE(back.frame) << back.message;
  ASSERT_EQ(back.frame->image.size(), cv::Size(5, 4));
  const auto pixel = back.frame->image.at<cv::Vec3b>(3, 4);
  EXPECT_NEAR(pixel[0], 200, 3);  // 219 steps for 256 values, twice
  EXPECT_NEAR(pixel[1], 100, 3);
  EXPECT_NEAR(pixel[2], 50, 3);
}

Frame nativeFrame(NativeFormat format, std::vector<std::uint8_t> bytes, int stride = 0) {
  Frame frame;
  frame.seq = 7;
  frame.native = std::make_shared<NativeImage>(NativeImage{format, 6, 4, stride, std::move(bytes)});
  return frame;
}

TEST(FrameCodec, ACapturedJpegPassesThroughAndIsDecodedOnceForAllOthers) {
  const std::vector<std::uint8_t> captured = encodeJpeg(colourFrame().image, 95);
  const EncodedFrame encoded(nativeFrame(NativeFormat::kJpeg, captured), 10);
  EXPECT_EQ(encoded.width(), 6);
  EXPECT_EQ(encoded.height(), 4);
  EXPECT_EQ(encoded.result(FrameFormat::kJpeg).image.pixels, captured);
  EXPECT_EQ(encoded.jderobotImage(FrameFormat::kJpeg)->pixelData, captured);
  EXPECT_EQ(encoded.decodings(), 0);
  const FrameResult pixels = decodeFrame(encoded.result(FrameFormat::kRgb8));
  ASSERT_TRUE(pixels.frame) << pixels.message;
  EXPECT_NEAR(pixels.frame->image.at<cv::Vec3b>(1, 1)[0], 200, 4);
  encoded.result(FrameFormat::kGray8);
  encoded.result(FrameFormat::kYuy2);
  EXPECT_EQ(encoded.decodings(), 1);
}

TEST(FrameCodec, CapturedYuyvPassesThroughWithoutItsPadding) {
  std::vector<std::uint8_t> captured(4 * 16, 0);
  std::vector<std::uint8_t> tight;
  for (std::size_t i = 0; i < captured.size(); ++i) {
    if (i % 16 < 12) tight.push_back(captured[i] = static_cast<std::uint8_t>(100 + i));
  }
  const EncodedFrame encoded(nativeFrame(NativeFormat::kYuyv, captured, 16), 85);
  EXPECT_EQ(encoded.result(FrameFormat::kYuy2).image.pixels, tight);
  EXPECT_EQ(encoded.decodings(), 0);
}

TEST(FrameCodec, ACapturedPictureThatCannotBeDecodedIsAReason) {
  const EncodedFrame encoded(nativeFrame(NativeFormat::kYuyv, std::vector<std::uint8_t>(20)), 85);
  EXPECT_EQ(encoded.result(FrameFormat::kRgb8).state, avm::SourceState::Waiting);
  EXPECT_EQ(encoded.result(FrameFormat::kRgb8).message, "the picture of the camera has 20 bytes of 48");
  EXPECT_EQ(encoded.result(FrameFormat::kYuy2).state, avm::SourceState::Waiting);
  EXPECT_FALSE(encoded.jderobotImage(FrameFormat::kRgb8));
  const EncodedFrame nothing(Frame{}, 85);
  EXPECT_EQ(nothing.result(FrameFormat::kJpeg).message, "the picture of the camera is empty");
}

TEST(FrameCodec, EncodesOncePerFormat) {
  const EncodedFrame encoded(colourFrame(), 85);
  EXPECT_EQ(encoded.encodings(), 0);
  const avm::FrameResult* first = &encoded.result(FrameFormat::kJpeg);
  EXPECT_EQ(first, &encoded.result(FrameFormat::kJpeg));
  EXPECT_EQ(encoded.encodings(), 1);
  encoded.result(FrameFormat::kGray8);
  EXPECT_EQ(encoded.encodings(), 2);
}

TEST(FrameCodec, JdeRobotsImageCarriesTimeSizeAndMd5) {
  const EncodedFrame encoded(colourFrame(), 85);
  const auto image = encoded.jderobotImage(FrameFormat::kRgb8);
  EXPECT_EQ(image->timeStamp.seconds, 1);
  EXPECT_EQ(image->timeStamp.useconds, 250'000);
  EXPECT_EQ(image->description->width, 6);
  EXPECT_EQ(image->description->height, 4);
  EXPECT_EQ(image->description->size, 72);
  EXPECT_EQ(image->description->format, "RGB8");
  EXPECT_EQ(image->description->md5sum, md5Hex(image->pixelData));
  EXPECT_EQ(image->pixelData[0], 200);
}

TEST(FrameCodec, RefusesFramesThatDoNotFit) {
  const EncodedFrame encoded(colourFrame(), 85);
  const avm::FrameResult good = encoded.result(FrameFormat::kRgb8);
  const auto messageOf = [&good](const std::function<void(avm::Frame&)>& spoil) {
    avm::FrameResult bad = good;
    spoil(bad.image);
    const FrameResult result = decodeFrame(bad);
    EXPECT_EQ(result.state, SourceState::kWaiting);
    EXPECT_FALSE(result.frame);
    return result.message;
  };
  EXPECT_THAT(messageOf([](avm::Frame& f) { f.pixels.pop_back(); }), HasSubstr("71 bytes (must be 72)"));
  EXPECT_THAT(messageOf([](avm::Frame& f) { f.width = -6; }), HasSubstr("size -6x4"));
  EXPECT_THAT(messageOf([](avm::Frame& f) { f.format = "BGR8"; }), HasSubstr("unknown format \"BGR8\""));
  EXPECT_THAT(messageOf([](avm::Frame& f) { f.format = "YUY2"; }), HasSubstr("72 bytes (must be 48)"));
  EXPECT_THAT(messageOf([](avm::Frame& f) { f.cameraModel.fx = kNaN; }), HasSubstr("not finite"));
  EXPECT_THAT(messageOf([](avm::Frame& f) { f.cameraOnRobot.qx = 3; }), HasSubstr("pose"));
  EXPECT_THAT(messageOf([](avm::Frame& f) { f.format = "JPEG"; }), HasSubstr("is no JPEG file"));
  const auto jpeg = encoded.result(FrameFormat::kJpeg).image.pixels;
  EXPECT_THAT(messageOf([&](avm::Frame& f) {
                f.format = "JPEG";
                f.pixels.assign(jpeg.begin(), jpeg.end() - 10);
              }),
              HasSubstr("is a JPEG file cut short"));
  EXPECT_THAT(messageOf([&](avm::Frame& f) {
                f.format = "JPEG";
                f.pixels = jpeg;
                f.width = 5;
              }),
              HasSubstr("another size than announced"));
}

}  // namespace
}  // namespace vismem
