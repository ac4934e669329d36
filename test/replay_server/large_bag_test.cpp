// Tests C2. Seeking in a recording of a gigabyte: every sensor is there at once.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <iostream>
#include <random>

#include "common/recording/bag_encoder.h"
#include "common/recording/file_sink.h"
#include "common/recording/ros_messages.h"
#include "replay_server/app/log_player.h"
#include "support/temporary_folder.h"

namespace vismem {
namespace {

constexpr StampUs kFrame = 33'333;
constexpr StampUs kSample = 20'000;
constexpr std::chrono::milliseconds kNoWait{0};

/// Raw images of 640x480 at 30 Hz, odometry and joints at 50 Hz.
void write(const std::string& file, BagCompression compression, int images) {
  FileSink sink(file, /*durable=*/false);
  BagEncoder bag(sink, compression);
  RosImage image{{0, "camera_optical_frame"}, 480, 640, "rgb8", 640 * 3, Bytes(640 * 480 * 3)};
  std::mt19937 random(1);
  // What no compression makes smaller.
  for (std::uint8_t& byte : image.data) byte = static_cast<std::uint8_t>(random());
  RosCameraInfo info;
  info.width = 640;
  info.height = 480;
  info.d.assign(5, 0.0);
  info.k = {500, 0, 319.5, 0, 500, 239.5, 0, 0, 1};
  StampUs sample_us = 0;
  for (int i = 0; i < images; ++i) {
    const StampUs stamp_us = kSecondUs + i * kFrame;
    for (; sample_us <= stamp_us + kSample; sample_us += kSample) {
      RosOdometry odometry;
      odometry.header = {sample_us, "odom"};
      odometry.pose.orientation.w = 1.0;
      bag.add({"/odom", kOdometryType}, sample_us, serialize(odometry));
      bag.add({"/joint_states", kJointStateType}, sample_us,
              serialize(RosJointState{{sample_us, ""}, {"pan", "tilt"}, {0.1, 0.2}}));
    }
    image.header.stamp_us = info.header.stamp_us = stamp_us;
    image.data[0] = static_cast<std::uint8_t>(i);
    image.data[1] = static_cast<std::uint8_t>(i >> 8);
    bag.add({"/camera/image_raw", kRawImageType}, stamp_us, serialize(image));
    bag.add({"/camera/camera_info", kCameraInfoType}, stamp_us, serialize(info));
    if (bag.openBytes() > 1 << 20) bag.closeChunk();
  }
  bag.finish();
}

TEST(LargeBag, SeeksAnywhereWithinThreeTenthsOfASecond) {
  for (const auto compression : {BagCompression::kNone, BagCompression::kLz4}) {
    const TemporaryFolder folder;
    const std::string file = folder / "large.bag";
    constexpr int kImages = 1200;
    write(file, compression, kImages);
    const auto began = std::chrono::steady_clock::now();
    const auto since = [](std::chrono::steady_clock::time_point begin) {
      return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    };
    SteadyPacingClock clock;
    LogPlayer player(RobotLog::open(file), {1.0, false, ReplayState::kPaused}, clock);
    std::cout << nameOf(compression) << ": opened in " << since(began) << " s";
    std::mt19937 random(2);
    std::uniform_int_distribution<StampUs> anywhere(kSecondUs, kSecondUs + (kImages - 1) * kFrame);
    double slowest_s = 0.0;
    for (int i = 0; i < 50; ++i) {
      const StampUs wanted_us = anywhere(random);
      const auto asked = std::chrono::steady_clock::now();
      ASSERT_TRUE(player.seek(wanted_us).ok());
      const FrameResult frame = player.camera().next(kNoWait);
      const auto odometry = player.base().samplesSince(0, kNoWait);
      const auto joints = player.panTilt().samplesSince(0, kNoWait);
      slowest_s = std::max(slowest_s, since(asked));
      EXPECT_EQ(player.status().stamp_us, wanted_us);
      ASSERT_TRUE(frame.frame.has_value()) << frame.message;
      ASSERT_FALSE(odometry.samples.empty());
      ASSERT_FALSE(joints.samples.empty());
      // Each sensor stands where it stood then: at its last sample before the wanted moment.
      const StampUs image_us = kSecondUs + (wanted_us - kSecondUs) / kFrame * kFrame;
      const StampUs sample_us = wanted_us / kSample * kSample;
      EXPECT_EQ(frame.frame->stamp_us, image_us);
      EXPECT_EQ(odometry.samples.back().stamp_us, sample_us);
      EXPECT_EQ(joints.samples.back().stamp_us, sample_us);
      const auto index = static_cast<int>((image_us - kSecondUs) / kFrame);
      EXPECT_EQ(frame.frame->image.at<cv::Vec3b>(0, 0)[0], index & 0xFF) << "the pixels are this image's";
    }
    std::cout << ", the slowest of 50 seeks took " << slowest_s << " s\n";
    EXPECT_LT(slowest_s, 0.3);
  }
}

}  // namespace
}  // namespace vismem
