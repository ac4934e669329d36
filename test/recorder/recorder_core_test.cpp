// Tests C1. Queue, ring buffer, chunks, parts, marks and drops of the recorder, without threads, files and
/// clocks.
#include "recorder/core/recorder_core.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "common/recording/bag_file.h"
#include "common/recording/bag_reader.h"
#include "recorder/core/loss_detector.h"
#include "recorder/memory_store.h"
#include "support/temporary_folder.h"

namespace vismem {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;

constexpr StampUs kFrame = 33'333;

class RecorderCoreTest : public ::testing::Test {
 protected:
  RecordedMessage note(StampUs stamp_us, const std::string& text) const {
    return textMessage(notes_, stamp_us, text);
  }
  RecordedMessage image(StampUs stamp_us, std::size_t bytes) const {
    return {images_, stamp_us, std::make_shared<const Bytes>(bytes, std::uint8_t{7})};
  }

  /// Opens a part of a recording as anybody would.
  BagFile open(const MemoryStore::Part& part, const std::string& name = "part.bag") const {
    const std::string file = folder_ / name;
    std::ofstream(file, std::ios::binary)
        .write(reinterpret_cast<const char*>(part.bytes.data()),
               static_cast<std::streamsize>(part.bytes.size()));
    return BagFile(file);
  }
  std::vector<std::string> notesOf(const std::string& recording) {
    std::vector<std::string> all;
    for (const auto& part : store_.recordings.at(recording)) {
      BagFile bag = open(*part);
      for (const auto& topic : bag.topics()) {
        if (topic.name != "/notes") continue;
        for (const std::string& text : bag.strings("/notes")) all.push_back(text);
      }
    }
    return all;
  }

  const std::shared_ptr<const LogTopic> notes_ = makeTopic("/notes", kStringType);
  const std::shared_ptr<const LogTopic> images_ = makeTopic("/camera/image_raw", kRawImageType, true);
  const std::shared_ptr<const LogTopic> map_ = makeTopic("/map_note", kStringType, false, true);
  TemporaryFolder folder_;
  MemoryStore store_;
};

TEST_F(RecorderCoreTest, RecordsBetweenStartAndStop) {
  RecorderCore core({}, store_);
  core.take(note(1'000'000, "before"), 0);
  EXPECT_THAT(core.stop().message, HasSubstr("nothing is recorded"));
  EXPECT_EQ(core.start("run").message, "memory/run");
  EXPECT_THAT(core.start("again").message, HasSubstr("a recording is on already: memory/run"));
  core.take(note(2'000'000, "during"), 0);
  EXPECT_EQ(core.stop().message, "memory/run");
  core.take(note(3'000'000, "after"), 0);
  EXPECT_THAT(notesOf("run"), ElementsAre("during"));
  const RecorderReport report = core.report();
  EXPECT_EQ(report.state, RecorderReport::State::kIdle);
  EXPECT_EQ(report.messages, 1u);
  EXPECT_EQ(report.begin_us, 2'000'000);
  EXPECT_THAT(core.start("run").message, HasSubstr("exists already"));
}

TEST_F(RecorderCoreTest, RefusesNamesThatLeaveItsFolder) {
  RecorderCore core({}, store_);
  for (const std::string name : {"", ".", "..", "a/b", "../x", "-rf", "a b", "x\n"}) {
    EXPECT_EQ(core.start(name).kind, PortReply::Kind::kRejected) << name;
  }
  EXPECT_TRUE(store_.recordings.empty());
}

TEST_F(RecorderCoreTest, AChunkIsNeverOpenForLongerThanItMayBe) {
  RecorderParams params;
  params.bag.max_chunk_us = 500'000;
  RecorderCore core(params, store_);
  core.start("run");
  // By stamps: of 30 images a second, what is not on the disk yet is less than half a second old.
  for (int i = 0; i < 90; ++i) {
    const StampUs stamp_us = i * kFrame;
    core.take(image(stamp_us, 100), 0);
    // A file each time takes long enough.
    if (i < 20 || i % 7 != 0) continue;
    open(*store_.recordings["run"][0]);
    const BagReader reader(folder_ / "part.bag");
    ASSERT_FALSE(reader.connections().empty());
    EXPECT_GE(toStampOfTime(reader.entries(0).back().time_ns), stamp_us - 500'000 - kFrame);
  }
}

TEST_F(RecorderCoreTest, ClosesAChunkWhenNothingComesAnyMore) {
  RecorderCore core({}, store_);
  core.start("run");
  core.take(note(1'000'000, "last"), 10'000'000);
  core.tick(10'400'000);
  EXPECT_EQ(core.report().messages, 0u);
  core.tick(10'500'000);
  EXPECT_EQ(core.report().messages, 1u);
  EXPECT_THAT(notesOf("run"), ElementsAre("last")) << "readable while it is recorded";
}

TEST_F(RecorderCoreTest, SplitsBySize) {
  RecorderParams params;
  params.bag.split_bytes = 1 << 20;
  params.bag.max_chunk_bytes = 1 << 18;
  RecorderCore core(params, store_);
  RecordedMessage map = textMessage(map_, 0, "the map");
  core.take(map, 0);
  core.start("run");
  for (int i = 0; i < 40; ++i) core.take(image(i * kFrame, 100'000), 0);
  core.stop();
  const auto& parts = store_.recordings.at("run");
  ASSERT_THAT(parts, SizeIs(::testing::Ge(4u)));
  std::size_t images = 0;
  for (const auto& part : parts) {
    EXPECT_TRUE(part->finished);
    EXPECT_LT(part->bytes.size(), (1u << 20) + (1u << 18) + 100'000u);
    BagFile bag = open(*part);
    EXPECT_THAT(bag.notes(), ::testing::IsEmpty());
    EXPECT_THAT(bag.strings("/map_note"), ElementsAre("the map")) << "every part stands alone";
    for (const auto& topic : bag.topics()) images += topic.name == "/camera/image_raw" ? topic.messages : 0;
  }
  EXPECT_EQ(images, 40u);
}

TEST_F(RecorderCoreTest, SplitsByTimeAndWhenTheClockJumpsBack) {
  RecorderParams params;
  params.bag.split_us = 10 * kSecondUs;
  RecorderCore core(params, store_);
  core.start("run");
  for (const StampUs stamp_s : {100, 105, 109, 110, 119, 3, 4}) {
    core.take(note(stamp_s * kSecondUs, std::to_string(stamp_s)), 0);
  }
  core.take(note(4 * kSecondUs - 900'000, "a little late"), 0);
  core.stop();
  const auto& parts = store_.recordings.at("run");
  ASSERT_THAT(parts, SizeIs(3));
  BagFile first = open(*parts[0]);
  EXPECT_THAT(first.strings("/notes"), ElementsAre("100", "105", "109"));
  BagFile third = open(*parts[2]);
  EXPECT_THAT(third.strings("/notes"), ElementsAre("3", "4", "a little late"));
}

// A recorder that connects to a running robot gets the samples of the servers' last seconds after newer
// images.
TEST_F(RecorderCoreTest, AStreamThatLagsIsOfTheSameEpoch) {
  RecorderParams params;
  params.ring_us = 5 * kSecondUs;
  RecorderCore core(params, store_);
  const auto lagging = makeTopic("/odom_note", "std_msgs/String", false, false);
  core.start("run");
  core.take(note(10 * kSecondUs, "image"), 0);
  core.take(textMessage(lagging, 8 * kSecondUs, "odometry"), 0);
  core.take(note(10 * kSecondUs + kFrame, "next image"), 0);
  core.take(textMessage(lagging, 10 * kSecondUs, "newer odometry"), 0);
  core.saveRing("ring");
  core.stop();
  for (const char* name : {"run", "ring"}) {
    ASSERT_THAT(store_.recordings.at(name), SizeIs(1)) << name;
    BagFile bag = open(*store_.recordings.at(name)[0]);
    EXPECT_THAT(bag.strings("/notes"), ElementsAre("image", "next image")) << name;
    EXPECT_THAT(bag.strings("/odom_note"), ElementsAre("odometry", "newer odometry")) << name;
  }
}

TEST_F(RecorderCoreTest, KeepsTheLastSecondsAndSavesThemOnDemand) {
  RecorderParams params;
  params.ring_us = 2 * kSecondUs;
  RecorderCore core(params, store_);
  EXPECT_THAT(core.saveRing("empty").message, HasSubstr("is empty"));
  core.take(textMessage(map_, 0, "the map"), 0);
  for (int i = 0; i <= 10; ++i) core.take(note(i * 500'000, std::to_string(i)), 0);
  EXPECT_EQ(core.saveRing("ring").message, "memory/ring");
  EXPECT_THAT(notesOf("ring"), ElementsAre("6", "7", "8", "9", "10"));
  BagFile bag = open(*store_.recordings["ring"][0]);
  EXPECT_THAT(bag.strings("/map_note"), ElementsAre("the map"));
  EXPECT_EQ(core.report().ring_us, 2 * kSecondUs);
  // A clock that jumps back begins another epoch.
  core.take(note(0, "new"), 0);
  core.saveRing("later");
  EXPECT_THAT(notesOf("later"), ElementsAre("new"));
  RecorderCore none({}, store_);
  EXPECT_THAT(none.saveRing("x").message, HasSubstr("Recorder.Ring.Length_s is 0"));
}

TEST_F(RecorderCoreTest, TheRingBufferIsBoundedInMemory) {
  RingBuffer ring(1000 * kSecondUs, 1 << 20);
  for (int i = 0; i < 100; ++i) {
    ring.add(image(i * kFrame, 100'000));
    EXPECT_LE(ring.bytes(), 1u << 20);
  }
  EXPECT_THAT(ring.contents(), SizeIs(10));
}

TEST_F(RecorderCoreTest, AFullDiskEndsTheRecordingAndKeepsWhatWasWritten) {
  RecorderCore core({}, store_);
  core.start("run");
  core.take(note(1'000'000, "saved"), 0);
  core.tick(kSecondUs);
  bool full = true;
  store_.before_write = [&](std::size_t bytes) {
    if (full && bytes > 100) throw RecordingError("disk: no space left on device");
  };
  core.take(note(2'000'000, std::string(1000, 'x')), kSecondUs);
  core.tick(3 * kSecondUs);
  const RecorderReport report = core.report();
  EXPECT_EQ(report.state, RecorderReport::State::kFailed);
  EXPECT_THAT(report.message,
              AllOf(HasSubstr("no space left on device"), HasSubstr("the recording has ended"),
                    HasSubstr("1 messages in 1 parts are saved")));
  EXPECT_FALSE(store_.recordings["run"][0]->finished);
  EXPECT_THAT(notesOf("run"), ElementsAre("saved"));
  // Another recording is possible once there is room.
  full = false;
  EXPECT_TRUE(core.start("next").ok());
  core.take(note(4'000'000, "again"), 0);
  EXPECT_TRUE(core.stop().ok());
  EXPECT_THAT(notesOf("next"), ElementsAre("again"));
}

TEST_F(RecorderCoreTest, WritesTheIndexWhereTheDiskHasRoomForIt) {
  RecorderCore core({}, store_);
  core.start("run");
  core.take(note(1'000'000, "saved"), 0);
  core.tick(kSecondUs);
  store_.before_write = [](std::size_t bytes) {
    if (bytes > 100'000) throw RecordingError("disk: no space left on device");
  };
  core.take(image(2'000'000, 200'000), kSecondUs);
  core.tick(3 * kSecondUs);
  EXPECT_EQ(core.report().state, RecorderReport::State::kFailed);
  EXPECT_TRUE(store_.recordings["run"][0]->finished);
  BagFile bag = open(*store_.recordings["run"][0]);
  EXPECT_THAT(bag.notes(), ::testing::IsEmpty());
  EXPECT_THAT(bag.strings("/notes"), ElementsAre("saved"));
}

TEST_F(RecorderCoreTest, PutsMarksAndDropsIntoTheRecording) {
  RecorderCore core({}, store_);
  EXPECT_THAT(core.mark("x", 1, 0).message, HasSubstr("nothing is recorded"));
  core.start("run");
  EXPECT_EQ(core.mark("", 1, 0).kind, PortReply::Kind::kRejected);
  EXPECT_TRUE(core.mark("the door \"opens\"", 1'500'000, 0).ok());
  std::map<std::string, TopicCount> counts;
  counts["/camera/image_raw"] = {kRawImageType, 100, 1000, 7, 2};
  counts["/odom"] = {kOdometryType, 50, 500, 0, 0};
  core.reportDrops(counts, 2'000'000, 0);
  core.reportDrops(counts, 3'000'000, 0);  // nothing new: not said again
  core.stop();
  BagFile bag = open(*store_.recordings["run"][0]);
  const auto marks = bag.strings("/recorder/marks");
  ASSERT_THAT(marks, SizeIs(1));
  EXPECT_EQ(nlohmann::json::parse(marks[0]).at("text"), "the door \"opens\"");
  EXPECT_EQ(nlohmann::json::parse(marks[0]).at("stamp_us"), 1'500'000);
  const auto drops = bag.strings("/recorder/drops");
  ASSERT_THAT(drops, SizeIs(1));
  const auto topics = nlohmann::json::parse(drops[0]).at("topics");
  EXPECT_EQ(topics.at("/camera/image_raw").at("dropped"), 7);
  EXPECT_EQ(topics.at("/camera/image_raw").at("missed"), 2);
  EXPECT_FALSE(topics.contains("/odom"));
}

TEST_F(RecorderCoreTest, TheQueueIsBoundedAndKeepsRoomForSmallMessages) {
  MessageQueue queue(1 << 20);
  int taken = 0;
  for (int i = 0; i < 100; ++i) taken += queue.push(image(i, 50'000)) ? 1 : 0;
  EXPECT_EQ(taken, 18) << "nine tenths of 1 MiB";
  EXPECT_EQ(queue.counts().at("/camera/image_raw").dropped, 82u);
  EXPECT_TRUE(queue.push(note(1, "small"))) << "a pose has room where an image has none";
  EXPECT_LE(queue.peakBytes(), 1u << 20);
  while (queue.pop()) {
  }
  EXPECT_EQ(queue.bytes(), 0u);
  EXPECT_TRUE(queue.push(image(1, 50'000)));
  EXPECT_FALSE(queue.push(image(1, 2'000'000))) << "larger than the queue";
}

TEST_F(RecorderCoreTest, SmallMessagesTakeThePlaceOfImages) {
  MessageQueue queue(1 << 20);
  for (int i = 0; i < 18; ++i) ASSERT_TRUE(queue.push(image(i, 50'000)));
  for (int i = 0; i < 60; ++i) ASSERT_TRUE(queue.push(note(100 + i, std::string(10'000, 'n')))) << i;
  EXPECT_LE(queue.peakBytes(), 1u << 20);
  const TopicCount images = queue.counts().at("/camera/image_raw");
  EXPECT_EQ(images.messages + images.dropped, 18u);
  // 60 notes of 10 kB and their bookkeeping leave room for eight images of 50 kB.
  EXPECT_EQ(images.messages, 8u);
  EXPECT_EQ(images.bytes, 8u * 50'000u);
  EXPECT_EQ(queue.dropped(), 10u);
  for (StampUs oldest = 0; oldest < 8; ++oldest) EXPECT_EQ(queue.pop()->stamp_us, oldest);
  EXPECT_EQ(queue.pop()->stamp_us, 100) << "in the order in which they came";
}

TEST(LossDetector, FiresOnceWhenASureRobotIsLost) {
  LossDetector detector(0.3, 0.6);
  EXPECT_FALSE(detector.update(0.0)) << "it never knew where it was";
  EXPECT_FALSE(detector.update(0.7));
  EXPECT_FALSE(detector.update(0.4));
  EXPECT_TRUE(detector.update(0.2));
  EXPECT_FALSE(detector.update(0.1));
  EXPECT_FALSE(detector.update(0.5));
  EXPECT_FALSE(detector.update(0.1)) << "it was not sure again";
  EXPECT_FALSE(detector.update(0.9));
  EXPECT_TRUE(detector.update(0.0));
}

}  // namespace
}  // namespace vismem
