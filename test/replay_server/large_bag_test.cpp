// Tests C2. Seeking in a recording of a gigabyte, over Ice: every sensor is there at once.
#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <random>

#include "common/robot/samples.h"
#include "recording/bag_writer.h"
#include "replay_server/seek_probe.h"
#include "support/build_paths.h"
#include "support/temporary_folder.h"

namespace vismem {
namespace {

constexpr StampUs kFrame = 33'333;
constexpr StampUs kSample = 20'000;
constexpr int kImages = 1200;

/// Raw images of 640x480 at 30 Hz, odometry and joints at 50 Hz.
void write(const std::string& file, const std::string& compression) {
  BagWriter bag(file, compression);
  std::mt19937 random(1);
  std::vector<std::uint8_t> pixels(640 * 480 * 3);
  // What no compression makes smaller.
  for (std::uint8_t& byte : pixels) byte = static_cast<std::uint8_t>(random());
  bag.cameraInfo("/camera/camera_info", kSecondUs, 640, 480, 500.0);
  StampUs sample_us = kSecondUs;
  for (int i = 0; i < kImages; ++i) {
    const StampUs stamp_us = kSecondUs + i * kFrame;
    for (; sample_us <= stamp_us + kSample; sample_us += kSample) {
      bag.odometry("/odom", sample_us, 0.0, 0.0, 0.0);
      bag.joints("/joint_states", sample_us, {"pan", "tilt"}, {0.1, 0.2});
    }
    pixels[0] = static_cast<std::uint8_t>(i);
    pixels[1] = static_cast<std::uint8_t>(i >> 8);
    bag.image("/camera/image_raw", stamp_us, "rgb8", 640, 480, pixels);
  }
  bag.close();
}

class LargeBag : public ::testing::TestWithParam<std::string> {};

TEST_P(LargeBag, SeeksAnywhereWithinThreeTenthsOfASecond) {
  const TemporaryFolder folder;
  const std::string file = folder / "large.bag";
  write(file, GetParam());
  const auto began = std::chrono::steady_clock::now();
  ComponentProcess server("replay_server", {"--Ice.Config=" VISMEM_SOURCE_DIR "/cfg/replay/replay_server.cfg",
                                            "--ReplayServer.Endpoints=tcp -h 127.0.0.1 -p 0",
                                            "--ReplayServer.Start=paused", "--ReplayServer.File=" + file});
  // The beginning of every image is read: of a packed bag all is unpacked for that.
  ASSERT_TRUE(server.waitForLine("replay_server ready: ", std::chrono::seconds(600))) << server.error();
  const std::chrono::duration<double> opened = std::chrono::steady_clock::now() - began;
  SeekProbe probe(server);
  std::mt19937 random(2);
  std::uniform_int_distribution<StampUs> anywhere(kSecondUs, kSecondUs + (kImages - 1) * kFrame);
  double slowest_s = 0.0;
  for (int i = 0; i < 50; ++i) {
    const StampUs wanted_us = anywhere(random);
    const StampUs image_us = kSecondUs + (wanted_us - kSecondUs) / kFrame * kFrame;
    // Each sensor stands where it stood then: at its last sample before the wanted moment.
    const SensorStamps expected{image_us, wanted_us / kSample * kSample, wanted_us / kSample * kSample};
    const SeekProbe::Landing landing = probe.seek(wanted_us, expected);
    slowest_s = std::max(slowest_s, landing.seconds);
    EXPECT_EQ(landing.position_us, wanted_us);
    ASSERT_EQ(landing.sensors, expected) << "seek " << i << " to " << wanted_us;
    const auto index = static_cast<int>((image_us - kSecondUs) / kFrame);
    EXPECT_EQ(landing.image.pixels[0] | landing.image.pixels[1] << 8, index) << "the pixels are this image's";
  }
  std::cout << GetParam() << ": " << static_cast<double>(std::filesystem::file_size(file)) / 1e9
            << " GB opened in " << opened.count() << " s, the slowest of 50 seeks took " << slowest_s
            << " s\n";
  EXPECT_LT(slowest_s, 0.3);
  EXPECT_EQ(server.stop(kPatience), 0);
}

INSTANTIATE_TEST_SUITE_P(Compressions, LargeBag, ::testing::Values("none", "lz4", "bz2"),
                         [](const auto& compression) { return compression.param; });

}  // namespace
}  // namespace vismem
