// The camera of a recording under the contract of FrameSource: played in time and in lock-step.
#include "contract/frame_source_contract.h"
#include "recording/bag_writer.h"
#include "replay_server/app/log_player.h"
#include "replay_server/core/stepped_log.h"
#include "support/temporary_folder.h"

namespace vismem {
namespace {

/// 400 images at 25 Hz, or two an hour apart.
RobotLog recording(const TemporaryFolder& folder, Supply supply) {
  const std::string file = folder / "walk.bag";
  BagWriter bag(file);
  const std::vector<std::uint8_t> pixels(64 * 48, 7);
  bag.cameraInfo("/camera/camera_info", 1'000'000, 64, 48, 60.0);
  bag.transform("/tf_static", 1'000'000, "base_footprint", "camera_optical_frame", 0.0, 0.0, 0.4, 0.0);
  const int count = supply == Supply::kSteady ? 400 : 2;
  const std::int64_t period_us = supply == Supply::kSteady ? 40'000 : 3'600'000'000;
  for (int i = -1; i <= count; ++i) {
    const std::int64_t stamp_us = 10'000'000'000 + i * period_us;
    if (i >= 0 && i < count) bag.image("/camera/image_raw", stamp_us, "mono8", 64, 48, pixels);
    bag.odometry("/odom", stamp_us, 0.0, 0.0, 0.0);
  }
  bag.close();
  return RobotLog::open(file);
}

class PlayedRig : public FrameSourceRig {
 public:
  explicit PlayedRig(Supply supply) : player_(recording(folder_, supply), params(), clock_) {}
  FrameSource& source() override { return player_.camera(); }

 private:
  static LogPlayer::Params params() {
    LogPlayer::Params params;
    params.start = ReplayState::kPlaying;
    return params;
  }
  TemporaryFolder folder_;
  SteadyPacingClock clock_;
  LogPlayer player_;
};

class SteppedRig : public FrameSourceRig {
 public:
  explicit SteppedRig(Supply supply) : log_(recording(folder_, supply)) {}
  FrameSource& source() override { return log_.camera(); }
  void provoke() override {
    if (!hushed_) log_.advanceToNextFrame();
  }
  void hush() override { hushed_ = true; }
  bool waits() const override { return false; }
  double period_s() const override { return 0.04; }

 private:
  TemporaryFolder folder_;
  SteppedLog log_;
  bool hushed_ = false;
};

INSTANTIATE_TEST_SUITE_P(
    Replay, FrameSourceContract,
    testing::Values(FrameSourceCase{"played", [](Supply s) { return std::make_unique<PlayedRig>(s); }},
                    FrameSourceCase{"lock_step", [](Supply s) { return std::make_unique<SteppedRig>(s); }}),
    nameOfCase);

}  // namespace
}  // namespace vismem
