// Tests C1. The recorder under the load of a whole application, into a folder: on a fast disk it loses
// nothing, on a slow one images, and its memory is bounded on both.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <time.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <future>
#include <iostream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "common/recording/bag_file.h"
#include "common/segment_map/segment_map.h"
#include "recorder/app/file_store.h"
#include "recorder/app/map_markers.h"
#include "recorder/app/recorder_service.h"
#include "recorder/published_topics.h"
#include "recorder/throttled_store.h"
#include "support/build_paths.h"
#include "support/temporary_folder.h"

namespace vismem {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::Gt;
using ::testing::IsEmpty;
using ::testing::Pair;

using Counts = std::map<std::string, std::uint64_t>;  ///< of messages, by topic

constexpr const char* kImages = "/camera/image_raw";
constexpr const char* kDrops = "/recorder/drops";
constexpr std::uint64_t kPartBytes = 64u << 20;
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) || !defined(NDEBUG)
constexpr bool kMeasures = false;  // neither time nor memory are those of the program that people run
#else
constexpr bool kMeasures = true;
#endif

/// VISMEM_RECORDED_SECONDS=600 is the whole measurement; ten seconds are enough every day.
int recordedSeconds() {
  const char* wanted = std::getenv("VISMEM_RECORDED_SECONDS");
  return wanted != nullptr ? std::max(5, std::atoi(wanted)) : 10;
}

double processCpu_s() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

double threadCpu_s() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double resident_MiB() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.rfind("VmRSS:", 0) == 0) return std::stod(line.substr(6)) / 1024.0;
  }
  return 0.0;
}

/// Parts of a recording that are done: their messages are counted, and then they are deleted.
class FinishedParts {
 public:
  explicit FinishedParts(fs::path folder) : folder_(std::move(folder)) {}

  void take() {
    const double began_s = threadCpu_s();
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(folder_)) {
      if (entry.path().extension() == ".bag") files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end());
    for (const fs::path& file : files) {
      BagFile bag(file.string());
      for (const BagTopic& topic : bag.topics()) {
        messages[topic.name] += topic.messages;
        if (topic.name == kDrops) last_drops = bag.strings(kDrops).back();
      }
      notes.insert(notes.end(), bag.notes().begin(), bag.notes().end());
      bytes += fs::file_size(file);
      ++parts;
      fs::remove(file);
    }
    cpu_s += threadCpu_s() - began_s;
  }

  Counts messages;
  std::vector<std::string> notes;
  std::string last_drops;
  std::uint64_t parts = 0;
  std::uint64_t bytes = 0;
  double cpu_s = 0.0;  ///< of looking at them

 private:
  const fs::path folder_;
};

class RecorderLoadTest : public ::testing::Test {
 protected:
  /// Starts to record everything.
  void start(RecordingStore& store, std::size_t queue_bytes) {
    RecorderService::Params params;
    params.core.bag.split_bytes = kPartBytes;
    params.queue_bytes = queue_bytes;
    service_ = std::make_unique<RecorderService>(params, store);
    service_->start([](const auto&) {}, [](const auto&) {});
    service_->take(mapMarkers(loadSegmentMap(VISMEM_SOURCE_DIR "/cfg/maps/corridor.csv")));
    std::promise<PortReply> reply;
    service_->execute([](RecorderCore& core) { return core.start("run"); },
                      [&](const PortReply& r) { reply.set_value(r); });
    ASSERT_TRUE(reply.get_future().get().ok());
  }
  void publish(int image) {
    topics_.publish(image, [this](RecordedMessage message) {
      ++published_[message.topic->channel.topic];
      service_->take(std::move(message));
    });
  }
  /// Once a second of the recording.
  void look() {
    parts_.take();
    resident_.push_back(resident_MiB());
  }
  /// Most memory between two shares of the recording.
  double mostMemory(double from, double to) const {
    const auto at = [&](double share) {
      return resident_.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(resident_.size()));
    };
    return *std::max_element(at(from), at(to));
  }
  /// Messages that did not fit, as the recorder counts them.
  Counts dropped() const {
    Counts dropped;
    for (const auto& [topic, count] : service_->status().counts) {
      if (count.dropped > 0) dropped[topic] = count.dropped;
    }
    return dropped;
  }
  /// What was published and not dropped is in the bags; the map is in every part.
  void expectWhole() {
    parts_.take();
    EXPECT_THAT(parts_.notes, IsEmpty());
    EXPECT_EQ(published_.size(), 20u) << "all topics";
    Counts expected = published_;
    for (const auto& [topic, count] : dropped()) expected[topic] -= count;
    Counts recorded = parts_.messages;
    recorded.erase(kDrops);
    EXPECT_EQ(recorded["/map"], parts_.parts);
    recorded.erase("/map");
    EXPECT_EQ(recorded, expected);
  }
  std::string figures(int seconds) const {
    std::ostringstream text;
    text << seconds << " s of " << published_.size()
         << " topics: " << static_cast<double>(parts_.bytes) / (1 << 20) << " MiB in " << parts_.parts
         << " parts; memory " << resident_.front() << " MiB at the begin, " << mostMemory(0.2, 0.6)
         << " MiB and then " << mostMemory(0.6, 1.0) << " MiB at most";
    return text.str();
  }

  TemporaryFolder folder_;
  FileStore files_{folder_.path() / "recordings", /*durable=*/true};
  FinishedParts parts_{folder_.path() / "recordings/run"};
  PublishedTopics topics_;
  std::unique_ptr<RecorderService> service_;
  Counts published_;
  std::vector<double> resident_;  ///< once a second of the recording [MiB]
};

TEST_F(RecorderLoadTest, LosesNothingAndStaysFlatWithAllTopics) {
  const int seconds = recordedSeconds();
  start(files_, 64u << 20);
  const double began_s = processCpu_s();
  for (int i = 0; i < PublishedTopics::kFramesPerSecond * seconds; ++i) {
    // The clock is simulated: messages come as fast as the disk takes them, and never faster.
    while (service_->status().queue_bytes > 20u << 20)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    publish(i);
    if (i % PublishedTopics::kFramesPerSecond == 0) look();
  }
  service_->stop();
  const double cpu_s = processCpu_s() - began_s - parts_.cpu_s;
  EXPECT_THAT(dropped(), IsEmpty());
  expectWhole();
  std::cout << figures(seconds) << "; " << 100.0 * cpu_s / seconds << " % of a core\n";
  if (!kMeasures) return;
  EXPECT_LT(cpu_s, 0.25 * seconds) << "a quarter of one core";
  EXPECT_LT(mostMemory(0.6, 1.0), mostMemory(0.2, 0.6) + 8.0) << "flat";
  EXPECT_LT(mostMemory(0.0, 1.0), resident_.front() + 40.0) << "what waits, a chunk and its index";
}

TEST_F(RecorderLoadTest, AThrottledDiskCostsImagesAndNothingElse) {
  const int seconds = recordedSeconds();
  constexpr std::size_t kQueue = 32u << 20;
  // Four times as fast as a robot: over 110 MB/s for a disk of 20 MB/s.
  constexpr std::chrono::microseconds kPeriod(PublishedTopics::kFrame_us / 4);
  ThrottledStore slow(files_, 20e6);
  start(slow, kQueue);
  auto next = std::chrono::steady_clock::now();
  for (int i = 0; i < PublishedTopics::kFramesPerSecond * seconds; ++i) {
    std::this_thread::sleep_until(next += kPeriod);
    publish(i);
    if (i % PublishedTopics::kFramesPerSecond == 0) look();
  }
  service_->stop();
  expectWhole();
  std::cout << figures(seconds) << "; " << dropped()[kImages] << " images dropped\n";
  EXPECT_THAT(dropped(), ElementsAre(Pair(kImages, Gt(5u * static_cast<unsigned>(seconds)))))
      << "images only";
  EXPECT_LE(service_->status().queue_peak_bytes, kQueue);
  const auto said = nlohmann::json::parse(parts_.last_drops).at("topics").at(kImages);
  EXPECT_EQ(said.at("dropped"), dropped()[kImages]) << "the bag says it";
  if (!kMeasures) return;
  EXPECT_LT(mostMemory(0.0, 1.0), resident_.front() + 56.0) << "the queue, a chunk and its index";
}

}  // namespace
}  // namespace vismem
