// Tests C1. The recorder under load: a fast disk, a throttled one, and what happens when it ends.
#include "recorder/app/recorder_service.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <condition_variable>
#include <fstream>
#include <future>

#include "common/recording/bag_file.h"
#include "common/recording/bag_reader.h"
#include "common/recording/ros_messages.h"
#include "recorder/app/file_store.h"
#include "recorder/app/session_folder.h"
#include "recorder/memory_store.h"
#include "support/eventually.h"
#include "support/temporary_folder.h"

namespace vismem {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr StampUs kFrame = 33'333;
constexpr std::size_t kImage = 640 * 480 * 3;

double cpuSeconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

long residentKiB() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.rfind("VmRSS:", 0) == 0) return std::stol(line.substr(6));
  }
  return 0;
}

class RecorderServiceTest : public ::testing::Test {
 protected:
  /// An image as a camera's server gives it: its bytes are copied into a message each time.
  RecordedMessage image(StampUs stamp_us) const {
    RosImage message;
    message.header = {stamp_us, "camera_optical_frame"};
    message.width = 640;
    message.height = 480;
    message.encoding = "rgb8";
    message.step = 640 * 3;
    message.data = pixels_;
    return {images_, stamp_us, std::make_shared<const Bytes>(serialize(message))};
  }
  RecordedMessage odometry(StampUs stamp_us) const {
    RosOdometry message;
    message.header = {stamp_us, "odom"};
    return {odom_, stamp_us, std::make_shared<const Bytes>(serialize(message))};
  }
  /// What the application publishes beside images: odometry and joints at 50 Hz, memory and poses as text.
  void takeSmall(RecorderService& service, int frame) const {
    const StampUs stamp_us = frame * kFrame;
    service.take(odometry(stamp_us));
    service.take(odometry(stamp_us + 10'000));
    service.take(textMessage(text_, stamp_us, std::string(40'000, 'm')));
  }
  static PortReply run(RecorderService& service, RecorderService::Command command) {
    auto reply = std::make_shared<std::promise<PortReply>>();
    service.execute(std::move(command), [reply](const PortReply& r) { reply->set_value(r); });
    return reply->get_future().get();
  }

  const Bytes pixels_ = Bytes(kImage, 128);
  const std::shared_ptr<const LogTopic> images_ = makeTopic("/camera/image_raw", kRawImageType, true);
  const std::shared_ptr<const LogTopic> odom_ = makeTopic("/odom", kOdometryType);
  const std::shared_ptr<const LogTopic> text_ = makeTopic("/memory/snapshot", kStringType);
  MemoryStore store_;
  TemporaryFolder folder_;
};

TEST_F(RecorderServiceTest, LosesNothingAndStaysFlatWithRawImagesAtThirtyHertz) {
  // VISMEM_RECORDED_SECONDS=600 is the whole measurement; a minute is enough every day.
  const char* wanted = std::getenv("VISMEM_RECORDED_SECONDS");
  const int seconds = wanted != nullptr ? std::atoi(wanted) : 60;
  store_.keep_parts = false;
  RecorderService::Params params;
  params.core.bag.split_bytes = 64u << 20;
  RecorderService service(params, store_);
  service.start([](const auto&) {}, [](const auto&) {});
  ASSERT_TRUE(run(service, [](RecorderCore& core) { return core.start("run"); }).ok());
  const double before_s = cpuSeconds();
  long warm_KiB = 0;
  long most_KiB = 0;
  for (int i = 0; i < 30 * seconds; ++i) {
    // The clock is simulated: images come as fast as the disk takes them, and never faster.
    while (service.status().queue_bytes > 20u << 20)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    service.take(image(i * kFrame));
    takeSmall(service, i);
    if (i == 300) warm_KiB = residentKiB();
    if (i > 300 && i % 30 == 0) most_KiB = std::max(most_KiB, residentKiB());
  }
  ASSERT_TRUE(run(service, [](RecorderCore& core) { return core.stop(); }).ok());
  const double cpu_s = cpuSeconds() - before_s;
  const auto status = service.status();
  std::cout << seconds << " s: " << cpu_s << " s of CPU, " << 100.0 * cpu_s / seconds << " % of a core, "
            << static_cast<double>(store_.written) / (1 << 20) << " MiB in " << status.report.parts
            << " parts; memory " << warm_KiB / 1024 << " MiB after 10 s, at most " << most_KiB / 1024
            << " MiB later\n";
  EXPECT_EQ(status.dropped, 0u);
  EXPECT_EQ(status.counts.at("/camera/image_raw").messages, static_cast<std::uint64_t>(30 * seconds));
  EXPECT_EQ(status.report.messages, static_cast<std::uint64_t>(4 * 30 * seconds));
  EXPECT_LT(cpu_s, 0.25 * seconds) << "a quarter of one core";
  EXPECT_LT(most_KiB, warm_KiB + 100 * 1024) << "a part of 64 MiB and the queue";
  service.stop();
}

TEST_F(RecorderServiceTest, AThrottledDiskCostsImagesAndNothingElse) {
  // 5 MB/s for images of 27 MB/s.
  store_.before_write = [](std::size_t bytes) {
    std::this_thread::sleep_for(std::chrono::microseconds(bytes / 5));
  };
  RecorderService::Params params;
  params.queue_bytes = 8u << 20;
  RecorderService service(params, store_);
  service.start([](const auto&) {}, [](const auto&) {});
  ASSERT_TRUE(run(service, [](RecorderCore& core) { return core.start("run"); }).ok());
  std::uint64_t refused = 0;
  for (int i = 0; i < 60; ++i) {
    refused += service.take(image(i * kFrame)) ? 0 : 1;
    service.take(odometry(i * kFrame));
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  const auto status = service.status();
  EXPECT_GT(refused, 5u);
  EXPECT_EQ(status.counts.at("/camera/image_raw").dropped, refused);
  EXPECT_EQ(status.counts.at("/odom").dropped, 0u);
  EXPECT_LE(status.queue_peak_bytes, 8u << 20);
  service.stop();
  // The bag is whole, has every message that was not dropped, and says how many were.
  const std::string file = folder_ / "throttled.bag";
  const Bytes& bytes = store_.recordings["run"][0]->bytes;
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  BagFile bag(file);
  EXPECT_THAT(bag.notes(), ::testing::IsEmpty());
  EXPECT_EQ(bag.imageHeaders("/camera/image_raw").size(), 60u - refused);
  EXPECT_EQ(bag.odometry("/odom").size(), 60u);
  const auto drops = bag.strings("/recorder/drops");
  ASSERT_FALSE(drops.empty());
  EXPECT_THAT(drops.back(), HasSubstr("\"dropped\":" + std::to_string(refused)));
}

TEST_F(RecorderServiceTest, SavesTheRingBufferWhenLocalizationIsLost) {
  RecorderService::Params params;
  params.core.ring_us = 10 * kSecondUs;
  params.save_after_loss_us = kSecondUs;
  RecorderService service(params, store_);
  std::mutex mutex;
  std::vector<std::string> notes;
  service.start([](const auto&) {},
                [&](const std::string& text) {
                  const std::lock_guard lock(mutex);
                  notes.push_back(text);
                });
  service.take(odometry(kSecondUs));
  service.updateReliability(0.9, kSecondUs);
  service.updateReliability(0.1, 2 * kSecondUs);
  service.take(odometry(2 * kSecondUs));
  service.take(odometry(3 * kSecondUs));
  EXPECT_TRUE(eventually([&] {
    const std::lock_guard lock(mutex);
    return !notes.empty();
  }));
  service.stop();
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_THAT(notes[0], HasSubstr("localization was lost: the last seconds are saved in memory/lost-"));
  EXPECT_EQ(store_.recordings.size(), 1u);
}

TEST_F(RecorderServiceTest, FinishesItsRecordingWhenItStops) {
  FileStore files(folder_.path() / "recordings", /*durable=*/false);
  {
    RecorderService service({}, files);
    service.start([](const auto&) {}, [](const auto&) {});
    ASSERT_TRUE(run(service, [](RecorderCore& core) { return core.start("run"); }).ok());
    for (int i = 0; i < 10; ++i) service.take(odometry(i * kFrame));
    service.stop();
    EXPECT_THAT(run(service, [](RecorderCore& core) { return core.stop(); }).message,
                HasSubstr("is stopping"));
  }
  const auto bags = bagsOf(files.pathOf("run"));
  ASSERT_THAT(bags, ElementsAre(::testing::EndsWith("run/run_0000.bag")));
  BagFile bag(bags);
  EXPECT_EQ(bag.odometry("/odom").size(), 10u);
  EXPECT_THAT(bag.notes(), ::testing::IsEmpty());
}

TEST_F(RecorderServiceTest, ASessionHoldsConfigurationsMapAndVersions) {
  std::ofstream(folder_ / "hall.csv") << "map";
  std::ofstream(folder_ / "hall.palette") << "palette";
  std::filesystem::create_directory(folder_ / "run");
  SessionFolder session(folder_ / "hall.csv", "1.2.3");
  session.open(folder_ / "run");
  session.add("localization", "1.2.3", {{"Localization.Map", "a#b = c\\d"}, {"Localization.Seed", "1"}});
  const auto read = [&](const std::string& name) {
    std::ifstream stream(folder_ / ("run/" + name));
    return std::string((std::istreambuf_iterator<char>(stream)), {});
  };
  EXPECT_EQ(read("map.csv"), "map");
  EXPECT_EQ(read("map.palette"), "palette");
  EXPECT_THAT(read("cfg/localization.cfg"),
              HasSubstr("Localization.Map = a\\#b \\= c\\\\d\nLocalization.Seed = 1\n"));
  EXPECT_THAT(read("session.json"), HasSubstr("\"recorder_version\": \"1.2.3\""));
}

}  // namespace
}  // namespace vismem
