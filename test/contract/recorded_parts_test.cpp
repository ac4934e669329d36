// Pan-tilt unit and base of a recording: played in time, and stepped from frame to frame.
#include <unistd.h>

#include <filesystem>

#include "contract/mobile_base_contract.h"
#include "contract/pantilt_contract.h"
#include "recording/bag_writer.h"
#include "replay_server/app/log_player.h"
#include "replay_server/core/stepped_log.h"

namespace vismem::contract {
namespace {

/// A recording of 20 s: images at 10 Hz, odometry and joints at 50 Hz. Written once, gone with the process.
class Recording {
 public:
  static RobotLog open() {
    static const Recording recording;
    return RobotLog::open(recording.file_.string(), {});
  }
  ~Recording() { std::filesystem::remove(file_); }

 private:
  Recording() {
    file_ =
        std::filesystem::temp_directory_path() / ("recorded_parts_" + std::to_string(::getpid()) + ".bag");
    BagWriter bag(file_.string());
    constexpr std::int64_t kBegin_us = 1'000'000;
    bag.cameraInfo("/camera/camera_info", kBegin_us, 16, 16, 20.0);
    for (int i = 0; i < 1000; ++i) {
      const std::int64_t stamp_us = kBegin_us + 20'000 * i;
      if (i % 5 == 0) {
        bag.image("/camera/image_raw", stamp_us, "mono8", 16, 16, std::vector<std::uint8_t>(256, 7));
      }
      bag.odometry("/odom", stamp_us - 3'000, 0.002 * i, 0.0, 0.0);
      bag.joints("/joint_states", stamp_us - 5'000, {"pan", "tilt"}, {std::sin(0.05 * i), 0.2});
    }
    bag.odometry("/odom", kBegin_us + 20'000'000, 2.0, 0.0, 0.0);
    bag.joints("/joint_states", kBegin_us + 20'000'000, {"pan", "tilt"}, {0.0, 0.2});
    bag.close();
  }

  std::filesystem::path file_;
};

template <typename Port>
Port& portOf(LogPlayer& player);
template <>
PanTiltUnit& portOf(LogPlayer& player) {
  return player.panTilt();
}
template <>
MobileBase& portOf(LogPlayer& player) {
  return player.base();
}
template <typename Port>
Port& portOf(SteppedLog& log);
template <>
PanTiltUnit& portOf(SteppedLog& log) {
  return log.panTilt();
}
template <>
MobileBase& portOf(SteppedLog& log) {
  return log.base();
}

template <typename Port>
class Played : public Subject<Port> {
 public:
  Port& port() override { return portOf<Port>(player_); }

 private:
  SteadyPacingClock clock_;
  LogPlayer player_{Recording::open(), LogPlayer::Params{1.0, false, ReplayState::kPlaying}, clock_};
};

template <typename Port>
class Stepped : public Subject<Port> {
 public:
  Port& port() override { return portOf<Port>(log_); }
  void step() override { ASSERT_TRUE(log_.advanceToNextFrame()) << "the recording is too short"; }
  bool isLockStep() const override { return true; }

 private:
  SteppedLog log_{Recording::open()};
};

template <typename Made, typename Port>
std::unique_ptr<Subject<Port>> make() {
  return std::make_unique<Made>();
}

const PanTiltImplementation kPlayedPanTilt{"Played", make<Played<PanTiltUnit>, PanTiltUnit>};
const auto kPanTilts = testing::Values(
    kPlayedPanTilt, PanTiltImplementation{"Stepped", make<Stepped<PanTiltUnit>, PanTiltUnit>});
INSTANTIATE_TEST_SUITE_P(Recording, PanTiltSamples, kPanTilts, ImplementationName());
INSTANTIATE_TEST_SUITE_P(Recording, PanTiltRecorded, kPanTilts, ImplementationName());
TEST(PlayedPanTilt, StopEndsAWait) {
  stopEndsAWait(*kPlayedPanTilt.make());
}

const MobileBaseImplementation kPlayedBase{"Played", make<Played<MobileBase>, MobileBase>};
const auto kBases =
    testing::Values(kPlayedBase, MobileBaseImplementation{"Stepped", make<Stepped<MobileBase>, MobileBase>});
INSTANTIATE_TEST_SUITE_P(Recording, MobileBaseSamples, kBases, ImplementationName());
INSTANTIATE_TEST_SUITE_P(Recording, MobileBaseRecorded, kBases, ImplementationName());
TEST(PlayedBase, StopEndsAWait) {
  stopEndsAWait(*kPlayedBase.make());
}

}  // namespace
}  // namespace vismem::contract
