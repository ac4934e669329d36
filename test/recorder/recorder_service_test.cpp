// Tests C1. The recorder's thread: the ring buffer when localization is lost, the end, and what lies beside
// the bags.
#include "recorder/app/recorder_service.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <future>

#include "common/recording/bag_file.h"
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

class RecorderServiceTest : public ::testing::Test {
 protected:
  RecordedMessage odometry(StampUs stamp_us) const {
    RosOdometry message;
    message.header = {stamp_us, "odom"};
    return {odom_, stamp_us, std::make_shared<const Bytes>(serialize(message))};
  }
  static PortReply run(RecorderService& service, RecorderService::Command command) {
    auto reply = std::make_shared<std::promise<PortReply>>();
    service.execute(std::move(command), [reply](const PortReply& r) { reply->set_value(r); });
    return reply->get_future().get();
  }

  const std::shared_ptr<const LogTopic> odom_ = makeTopic("/odom", kOdometryType);
  MemoryStore store_;
  TemporaryFolder folder_;
};

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
