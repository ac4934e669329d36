// Bags as nobody writes them: whatever the bytes, they open with notes or fail with a RecordingError, and
// what opens plays. Tests C1, C2.
#include <sys/mman.h>
#include <unistd.h>

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <string>

#include "common/recording/bag_advice.h"
#include "replay_server/app/log_player.h"

namespace {

using namespace vismem;

/// A file in memory with a name in /proc.
class MemoryFile {
 public:
  MemoryFile(const std::uint8_t* data, std::size_t size) : fd_(::memfd_create("fuzz", 0)) {
    std::size_t done = 0;
    while (done < size) {
      const ::ssize_t n = ::write(fd_, data + done, size - done);
      if (n <= 0) break;
      done += static_cast<std::size_t>(n);
    }
  }
  ~MemoryFile() { ::close(fd_); }
  std::string name() const { return "/proc/self/fd/" + std::to_string(fd_); }

 private:
  int fd_;
};

/// Time goes on when somebody waits.
class JumpingClock : public PacingClock {
 public:
  StampUs now() const override { return now_us_; }
  void waitUntil(std::unique_lock<std::mutex>&, std::condition_variable&, StampUs until_us) override {
    now_us_ = until_us > now_us_ ? until_us : now_us_ + 1;
  }

 private:
  StampUs now_us_ = 0;
};

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
  BagAdvice advice = adviseOn({file}, {});
  if (!advice.playable) return;
  JumpingClock clock;
  LogPlayer player(RobotLog::open(file, advice.options), {1000.0, false, ReplayState::kPlaying}, clock);
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
