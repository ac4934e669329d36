// Tests C1. A recorder that is killed at any moment leaves bags that open and lack at most the last second.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <iostream>
#include <random>

#include "common/recording/bag_file.h"
#include "common/recording/ros_messages.h"
#include "recorder/app/file_store.h"
#include "recorder/app/recorder_service.h"
#include "support/temporary_folder.h"

namespace vismem {
namespace {

constexpr StampUs kPeriod = 5'000;

StampUs clockNow() {
  return std::chrono::duration_cast<std::chrono::microseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

/// Records a message of 20 kB every 5 ms of the clock, whose stamp is the clock's, until it is killed.
[[noreturn]] void recordUntilKilled(const std::string& folder, BagCompression compression) {
  FileStore store(folder, /*durable=*/true);
  RecorderService::Params params;
  params.core.bag.compression = compression;
  params.core.bag.split_bytes = 1 << 20;
  RecorderService service(params, store);
  service.start([](const auto&) {}, [](const auto&) {});
  service.execute([](RecorderCore& core) { return core.start("run"); }, [](const PortReply&) {});
  const auto topic = makeTopic("/notes", kStringType);
  std::string text(20'000, 'x');
  for (int i = 0;; ++i) {
    text[static_cast<std::size_t>(i) % text.size()] = static_cast<char>('a' + i % 26);
    service.take(textMessage(topic, clockNow(), text));
    ::usleep(static_cast<useconds_t>(kPeriod));
  }
}

class Killed : public ::testing::TestWithParam<BagCompression> {
 protected:
  /// @return the number of messages that could be read; the newest is at most a second older than the kill.
  static std::size_t killAfter(std::chrono::milliseconds life, BagCompression compression) {
    const TemporaryFolder folder;
    const ::pid_t child = ::fork();
    if (child == 0) recordUntilKilled(folder / "recordings", compression);
    EXPECT_GT(child, 0);
    std::this_thread::sleep_for(life);
    const StampUs killed_us = clockNow();
    ::kill(child, SIGKILL);
    int status = 0;
    ::waitpid(child, &status, 0);
    EXPECT_TRUE(WIFSIGNALED(status));
    std::vector<std::string> files;
    try {
      files = bagsOf(folder / "recordings/run");
    } catch (const RecordingError&) {
      // Killed before the first file was made.
      EXPECT_LT(life, std::chrono::milliseconds(300));
      return 0;
    }
    // Killed before the first chunk of a part: that part holds nothing yet.
    std::vector<std::string> usable;
    for (const std::string& file : files) {
      try {
        BagFile bag(file);
        usable.push_back(file);
      } catch (const RecordingError& error) {
        EXPECT_TRUE(file.ends_with(".active")) << error.what();
        EXPECT_THAT(error.what(), ::testing::HasSubstr("holds a message"));
      }
    }
    if (usable.empty()) {
      EXPECT_LT(life, std::chrono::milliseconds(1000)) << "a second was recorded and nothing can be read";
      return 0;
    }
    BagFile bag(usable);
    EXPECT_LE(killed_us - bag.endUs(), kSecondUs) << "after " << life.count() << " ms";
    const std::size_t messages = bag.strings("/notes").size();
    // Nothing is missing in the middle: one every 5 ms or, on a busy machine, fewer.
    EXPECT_GT(messages, 0u);
    return messages;
  }
};

TEST_P(Killed, LosesAtMostASecond) {
  const char* wanted = std::getenv("VISMEM_KILLS");
  const int kills = wanted != nullptr ? std::atoi(wanted) : 200;
  std::mt19937 random(7);
  std::uniform_int_distribution<int> life_ms(20, 2'000);
  std::size_t messages = 0;
  int readable = 0;
  for (int i = 0; i < kills; ++i) {
    const std::size_t found = killAfter(std::chrono::milliseconds(life_ms(random)), GetParam());
    messages += found;
    readable += found > 0 ? 1 : 0;
    if (HasFailure()) FAIL() << "at kill " << i << " of seed 7";
  }
  std::cout << kills << " kills, " << readable << " recordings with " << messages << " messages\n";
}

INSTANTIATE_TEST_SUITE_P(Recorder, Killed, ::testing::Values(BagCompression::kNone, BagCompression::kLz4));

}  // namespace
}  // namespace vismem
