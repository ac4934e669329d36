// Tests C2. Bags of every compression replayed by the real process: all sensors over Ice, and where they
// stand after a seek.
#include <gmock/gmock.h>

#include <array>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "common/robot/samples.h"
#include "recording/bag_writer.h"
#include "replay_server/seek_probe.h"
#include "support/build_paths.h"
#include "support/temporary_folder.h"

namespace vismem {
namespace {

using ::testing::Each;
using ::testing::Le;

constexpr StampUs kFirst = 10 * kSecondUs;
constexpr StampUs kFrame = 33'333;
constexpr int kImages = 150;
/// Odometry and joints were measured so long before each image, and once more between images.
constexpr StampUs kOdometryEarlier = 400;
constexpr StampUs kJointsEarlier = 700;
constexpr StampUs kBetween = kFrame / 2;

/// Where all sensors stand at a moment: each at its last sample until then.
SensorStamps sensorsAt(StampUs stamp_us) {
  const auto last = [&](StampUs earlier_us, bool between) {
    StampUs newest = 0;
    for (int i = 0; i < kImages; ++i) {
      const StampUs own_us = kFirst + i * kFrame - earlier_us;
      if (own_us <= stamp_us) newest = own_us;
      if (between && own_us + kBetween <= stamp_us) newest = own_us + kBetween;
    }
    return newest;
  };
  return {last(0, false), last(kOdometryEarlier, true), last(kJointsEarlier, true)};
}

class ReplaySeekTest : public ::testing::TestWithParam<std::string> {
 protected:
  ReplaySeekTest() : file_(folder_ / "seek.bag") {
    BagWriter bag(file_, GetParam());
    bag.cameraInfo("/camera/camera_info", kFirst, 64, 48, 60.0);
    std::mt19937 random(3);
    for (int i = 0; i < kImages; ++i) {
      const StampUs stamp_us = kFirst + i * kFrame;
      std::vector<std::uint8_t> pixels(64 * 48 * 3);
      for (auto& pixel : pixels) pixel = static_cast<std::uint8_t>(random());
      bag.image("/camera/image_raw", stamp_us, "rgb8", 64, 48, pixels);
      images_.push_back(std::move(pixels));
      for (const StampUs more_us : {StampUs{0}, kBetween}) {
        bag.odometry("/odom", stamp_us - kOdometryEarlier + more_us, 0.01 * i, 0.0, 0.0);
        bag.joints("/joint_states", stamp_us - kJointsEarlier + more_us, {"pan", "tilt"}, {0.001 * i, 0.2});
      }
    }
    bag.close();
  }

  std::unique_ptr<ComponentProcess> serve() const {
    return std::make_unique<ComponentProcess>(
        "replay_server",
        std::vector<std::string>{"--Ice.Config=" VISMEM_SOURCE_DIR "/cfg/replay/replay_server.cfg",
                                 "--ReplayServer.Endpoints=tcp -h 127.0.0.1 -p 0",
                                 "--ReplayServer.Start=paused", "--ReplayServer.File=" + file_});
  }
  static std::size_t indexOf(StampUs image_us) {
    return static_cast<std::size_t>((image_us - kFirst) / kFrame);
  }
  void expectLandsAt(SeekProbe& probe, StampUs wanted_us) const {
    const SensorStamps expected = sensorsAt(wanted_us);
    const SeekProbe::Landing landing = probe.seek(wanted_us, expected);
    EXPECT_EQ(landing.position_us, wanted_us);
    EXPECT_EQ(landing.sensors.image, expected.image) << "after a seek to " << wanted_us;
    EXPECT_EQ(landing.sensors.odometry, expected.odometry) << "after a seek to " << wanted_us;
    EXPECT_EQ(landing.sensors.joints, expected.joints) << "after a seek to " << wanted_us;
    EXPECT_TRUE(landing.image.pixels == images_.at(indexOf(expected.image))) << "the image at " << wanted_us;
    EXPECT_LT(landing.seconds, 0.3) << "after a seek to " << wanted_us;
  }

  TemporaryFolder folder_;
  const std::string file_;
  std::vector<std::vector<std::uint8_t>> images_;
};

TEST_P(ReplaySeekTest, AllSensorsLandOnTheImage) {
  const auto server = serve();
  ASSERT_TRUE(server->waitUntilReady());
  SeekProbe probe(*server);
  // Far ahead, a little back (less than the second that begins a new epoch), one image back, to the ends.
  for (const int image : {100, 90, 89, 140, 5, 0, kImages - 1, 0, 30}) {
    const StampUs wanted_us = kFirst + image * kFrame;
    expectLandsAt(probe, wanted_us);
    const SensorStamps stamps = sensorsAt(wanted_us);
    EXPECT_THAT(
        (std::array{wanted_us - stamps.image, wanted_us - stamps.odometry, wanted_us - stamps.joints}),
        Each(Le(1'000)))
        << "within a millisecond";
  }
  EXPECT_EQ(server->stop(kPatience), 0);
}

TEST_P(ReplaySeekTest, EverySensorStandsAtItsLastSampleBeforeAnyMoment) {
  const auto server = serve();
  ASSERT_TRUE(server->waitUntilReady());
  SeekProbe probe(*server);
  std::mt19937 random(4);
  std::uniform_int_distribution<StampUs> anywhere(kFirst, kFirst + (kImages - 1) * kFrame);
  for (int i = 0; i < 40; ++i) expectLandsAt(probe, anywhere(random));
  EXPECT_EQ(server->stop(kPatience), 0);
}

TEST_P(ReplaySeekTest, ReplaysEveryImageByteForByte) {
  const auto server = serve();
  ASSERT_TRUE(server->waitUntilReady());
  SeekProbe probe(*server);
  EXPECT_EQ(probe.replay().contents().images, kImages);
  for (int i = 0; i < kImages; ++i) expectLandsAt(probe, kFirst + i * kFrame);
  EXPECT_EQ(server->stop(kPatience), 0);
}

INSTANTIATE_TEST_SUITE_P(Compressions, ReplaySeekTest, ::testing::Values("none", "bz2", "lz4"),
                         [](const auto& compression) { return compression.param; });

}  // namespace
}  // namespace vismem
