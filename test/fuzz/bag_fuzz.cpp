// Bags as nobody writes them: whatever the bytes, they open with notes or fail with a RecordingError, and
// what opens plays. Tests C1, C2.
#include <cstddef>
#include <cstdint>
#include <string>

#include "common/recording/bag_advice.h"
#include "fuzz/replay_parts.h"

namespace {

using namespace vismem;

/// Every topic as what it says it is.
void readAll(const std::string& file) {
  BagFile bag(file);
  for (const BagTopic& topic : bag.topics()) {
    try {
      if (topic.type == kRawImageType || topic.type == kCompressedImageType) {
        const std::size_t images = bag.imageHeaders(topic.name).size();
        for (std::size_t i = 0; i < images && i < 4; ++i) bag.readImage(topic.name, i);
      }
      if (topic.type == kCameraInfoType) bag.cameraInfos(topic.name);
      if (topic.type == kOdometryType) bag.odometry(topic.name);
      if (topic.type == kJointStateType) bag.joints(topic.name);
      if (topic.type == kPoseType) bag.poses(topic.name);
      if (topic.type == kStringType) bag.strings(topic.name);
    } catch (const RecordingError&) {
      continue;  // the others may be whole
    }
  }
  try {
    bag.transforms();
  } catch (const RecordingError&) {
    return;
  }
}

void play(const std::string& file) {
  BagAdvice advice = adviseOn(BagFile(file), {});
  if (!advice.log) return;
  JumpingClock clock;
  LogPlayer player(std::move(*advice.log), {1000.0, false, ReplayState::kPlaying}, clock);
  constexpr std::chrono::milliseconds kWait{100};
  for (int i = 0; i < 6; ++i) {
    player.camera().next(kWait);
    player.base().samplesSince(INT64_MIN, kWait);
    player.panTilt().samplesSince(INT64_MIN, kWait);
  }
  player.step(-2);
  player.camera().next(kWait);
  const ReplayStatus status = player.status();
  player.seek(status.first_us + (status.last_us - status.first_us) / 2);
  player.camera().next(kWait);
  player.setRange(status.first_us, status.last_us);
  player.contents();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const MemoryFile file(data, size);
  try {
    readAll(file.name());
    play(file.name());
  } catch (const RecordingError&) {
    return 0;  // said what is wrong
  }
  return 0;
}
