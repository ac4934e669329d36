// Tests C1. What BagEncoder writes, and whole, cut and damaged bags as BagReader opens them.
#include "common/recording/bag_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "common/config/config_error.h"
#include "common/recording/bag_encoder.h"
#include "common/recording/bag_file.h"
#include "common/recording/file_sink.h"
#include "common/recording/ros_messages.h"
#include "support/temporary_folder.h"

namespace vismem {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const BagChannel kNotes{"/notes", kStringType};
const BagChannel kOdom{"/odom", kOdometryType};

/// Bytes of a bag in memory.
class MemorySink : public ByteSink {
 public:
  void write(ByteView bytes) override {
    if (bytes_.size() + bytes.size() > capacity) {
      const std::size_t fits = capacity > bytes_.size() ? capacity - bytes_.size() : 0;
      bytes_.insert(bytes_.end(), bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(fits));
      throw RecordingError("no space left");
    }
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  }
  void overwrite(std::uint64_t offset, ByteView bytes) override {
    std::copy(bytes.begin(), bytes.end(), bytes_.begin() + static_cast<std::ptrdiff_t>(offset));
  }
  void truncate(std::uint64_t size) override { bytes_.resize(size); }
  void sync() override { ++syncs; }

  Bytes bytes_;
  std::size_t capacity = SIZE_MAX;
  int syncs = 0;
};

class BagReaderTest : public ::testing::Test {
 protected:
  std::string save(const Bytes& bytes, const std::string& name = "log.bag") const {
    const fs::path file = folder_.path() / name;
    std::ofstream(file, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    return file.string();
  }

  /// Six notes of 1000 characters, two a chunk, 1 s apart from 1 s on.
  static Bytes notes(BagCompression compression, bool finished = true) {
    MemorySink sink;
    BagEncoder encoder(sink, compression);
    for (int i = 0; i < 6; ++i) {
      encoder.add(kNotes, 1'000'000 * (i + 1), serialize(std::string(1000, static_cast<char>('a' + i))));
      if (i % 2 == 1) encoder.closeChunk();
    }
    if (finished) encoder.finish();
    return sink.bytes_;
  }

  /// First characters of the notes that can be read.
  static std::string readable(BagFile& bag) {
    std::string first;
    if (bag.topics().empty()) return first;
    for (const std::string& text : bag.strings("/notes")) first += text.at(0);
    return first;
  }
  std::string readable(const Bytes& bytes) const {
    BagFile bag(save(bytes));
    return readable(bag);
  }
  std::string errorOf(const Bytes& bytes) const {
    try {
      BagReader reader(save(bytes));
    } catch (const RecordingError& error) {
      return error.what();
    }
    return "no error";
  }
  /// Where the record of the chunk with this number begins.
  static std::size_t chunkAt(const Bytes& bytes, int number) {
    const std::string text(bytes.begin(), bytes.end());
    std::size_t at = 0;
    for (int i = 0; i <= number; ++i) at = text.find("op=\x05", at) + 1;
    return at - 1 - 8;
  }

  TemporaryFolder folder_;
};

TEST_F(BagReaderTest, ReadsWhatTheEncoderWrote) {
  for (const auto compression : {BagCompression::kNone, BagCompression::kLz4}) {
    const Bytes bytes = notes(compression);
    const BagReader reader(save(bytes));
    ASSERT_EQ(reader.connections().size(), 1u);
    EXPECT_EQ(reader.connections()[0].topic, "/notes");
    EXPECT_EQ(reader.connections()[0].type, "std_msgs/String");
    EXPECT_EQ(reader.entries(0).size(), 6u);
    EXPECT_EQ(reader.entries(0)[3].time_ns, 4'000'000'000);
    EXPECT_EQ(reader.chunks(), 3u);
    EXPECT_EQ(reader.compressions(), std::vector<std::string>{nameOf(compression)});
    EXPECT_FALSE(reader.damage().any());
    EXPECT_EQ(readable(bytes), "abcdef");
  }
  EXPECT_LT(notes(BagCompression::kLz4).size(), notes(BagCompression::kNone).size() - 5000);
}

TEST_F(BagReaderTest, ReadsOnlyTheBeginningWhereThatIsWanted) {
  for (const auto compression : {BagCompression::kNone, BagCompression::kLz4}) {
    BagReader reader(save(notes(compression)));
    const Bytes begin = reader.read(reader.entries(0)[2], 6);
    EXPECT_EQ(begin, (Bytes{0xE8, 3, 0, 0, 'c', 'c'})) << "the length 1000, then the text";
  }
}

TEST_F(BagReaderTest, IndexesAgainWhatWasNeverFinished) {
  for (const auto compression : {BagCompression::kNone, BagCompression::kLz4}) {
    const Bytes bytes = notes(compression, /*finished=*/false);
    BagReader reader(save(bytes));
    EXPECT_TRUE(reader.damage().reindexed);
    EXPECT_EQ(reader.damage().bytes_lost, 0u);
    EXPECT_THAT(reader.damage().notes, Contains(HasSubstr("indexed again, 6 messages in 3 chunks")));
    EXPECT_EQ(readable(bytes), "abcdef");
  }
}

TEST_F(BagReaderTest, LosesAtMostTheChunkInWhichTheFileEnds) {
  for (const auto compression : {BagCompression::kNone, BagCompression::kLz4}) {
    const Bytes whole = notes(compression, /*finished=*/false);
    const std::size_t second = chunkAt(whole, 1);
    const std::size_t third = chunkAt(whole, 2);
    for (std::size_t length = second; length < whole.size(); length += 7) {
      const Bytes cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length));
      const std::string saved = readable(cut);
      EXPECT_EQ(saved, std::string("abcdef").substr(0, saved.size())) << "at " << length;
      EXPECT_GE(saved.size(), length < third ? 2u : 4u) << "at " << length;
    }
  }
}

TEST_F(BagReaderTest, SavesTheWholeMessagesOfAChunkThatIsNotCompressed) {
  const Bytes whole = notes(BagCompression::kNone, /*finished=*/false);
  // 1500 bytes behind the beginning of the third chunk: its first message is whole, the second is not.
  const std::size_t length = chunkAt(whole, 2) + 1500;
  EXPECT_EQ(readable(Bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length))), "abcde");
}

TEST_F(BagReaderTest, LeavesOutADamagedChunkAndSaysSo) {
  for (const bool finished : {true, false}) {
    Bytes bytes = notes(BagCompression::kLz4, finished);
    const std::size_t second = chunkAt(bytes, 1);
    for (std::size_t i = second + 70; i < second + 90; ++i) bytes[i] ^= 0x5A;
    BagFile bag(save(bytes));
    EXPECT_EQ(readable(bag), "abef") << "finished: " << finished;
    EXPECT_THAT(bag.notes(), Contains(AllOf(HasSubstr("chunk at byte " + std::to_string(second)),
                                            HasSubstr("lz4 data are damaged"), HasSubstr("left out"))));
  }
}

TEST_F(BagReaderTest, FindsTheNextChunkBehindBytesThatAreNoRecord) {
  Bytes bytes = notes(BagCompression::kNone, /*finished=*/false);
  const std::size_t second = chunkAt(bytes, 1);
  // The length of the second chunk's header: nothing behind it can be found by lengths any more.
  bytes[second] = bytes[second + 1] = 0xFF;
  BagFile bag(save(bytes));
  EXPECT_EQ(readable(bag), "abef");
  EXPECT_THAT(bag.notes(), Contains(AllOf(HasSubstr("bytes at byte " + std::to_string(second)),
                                          HasSubstr("are no record of a bag"))));
}

TEST_F(BagReaderTest, NamesAnUnknownCompression) {
  for (const bool finished : {true, false}) {
    Bytes bytes = notes(BagCompression::kLz4, finished);
    const std::string text(bytes.begin(), bytes.end());
    const std::size_t name = text.find("compression=lz4", chunkAt(bytes, 1)) + 12;
    bytes[name] = 'x';
    BagFile bag(save(bytes));
    EXPECT_EQ(readable(bag), "abef");
    EXPECT_THAT(bag.notes(), Contains(HasSubstr("compression \"xz4\" (expected none, bz2 or lz4)")));
  }
  Bytes all = notes(BagCompression::kLz4);
  for (std::size_t at = 0;
       (at = std::string(all.begin(), all.end()).find("compression=lz4", at)) != std::string::npos; ++at) {
    all[at + 12] = 'x';
  }
  BagFile none(save(all));
  EXPECT_THAT(readable(none), IsEmpty());
}

TEST_F(BagReaderTest, SavesWhatAFullDiskTook) {
  MemorySink sink;
  BagEncoder encoder(sink, BagCompression::kNone);
  encoder.add(kNotes, 1'000'000, serialize(std::string(1000, 'a')));
  encoder.closeChunk();
  sink.capacity = sink.bytes_.size() + 500;
  encoder.add(kNotes, 2'000'000, serialize(std::string(1000, 'b')));
  EXPECT_THROW(encoder.closeChunk(), RecordingError);
  EXPECT_EQ(readable(sink.bytes_), "a") << "before it was finished";
  sink.capacity += 1000;
  encoder.finish();
  BagFile bag(save(sink.bytes_));
  EXPECT_EQ(readable(bag), "a");
  EXPECT_THAT(bag.notes(), IsEmpty());
}

TEST_F(BagReaderTest, SaysWhyNothingCanBeRead) {
  const Bytes whole = notes(BagCompression::kNone);
  EXPECT_THAT(errorOf(Bytes(whole.begin(), whole.begin() + 4200)),
              AllOf(HasSubstr("its index is missing or damaged"), HasSubstr("4200 bytes")));
  const std::string tiny = errorOf(Bytes(whole.begin(), whole.begin() + 5000));
  EXPECT_THAT(tiny, HasSubstr("(chunk at byte "));
  EXPECT_EQ(tiny.find("log.bag"), tiny.rfind("log.bag")) << "names the file once: " << tiny;
  EXPECT_THAT(errorOf({'h', 'i'}), HasSubstr("not a ROS 1 bag: begins with \"hi\""));
  EXPECT_THROW(BagReader{folder_.path().string()}, RecordingError);
}

TEST_F(BagReaderTest, NeverCrashesWhateverByteIsWrong) {
  const Bytes whole = notes(BagCompression::kLz4);
  for (std::size_t i = 0; i < whole.size(); i += 13) {
    if (i > 200 && i < 4000) continue;  // the header's padding
    for (const std::uint8_t change : {0x01, 0x80, 0xFF}) {
      Bytes bytes = whole;
      bytes[i] = static_cast<std::uint8_t>(bytes[i] ^ change);
      try {
        BagFile bag(save(bytes));
        const std::string saved =
            bag.topics().empty() || bag.topics()[0].name != "/notes" ? "" : readable(bag);
        EXPECT_LE(saved.size(), 6u) << "byte " << i;
      } catch (const RecordingError& error) {
        EXPECT_THAT(error.what(), HasSubstr("log.bag")) << "byte " << i;
      }
    }
  }
}

TEST_F(BagReaderTest, KeepsSmallStampsAndOrder) {
  MemorySink sink;
  BagEncoder encoder(sink, BagCompression::kNone);
  RosOdometry odometry;
  odometry.pose.orientation.w = 1.0;
  for (const std::int64_t stamp_us : {0, 10'000, 5'000}) {
    odometry.header.stamp_us = stamp_us;
    odometry.pose.position.x = 1e-3 * static_cast<double>(stamp_us);
    encoder.add(kOdom, stamp_us, serialize(odometry));
  }
  encoder.finish();
  BagFile bag(save(sink.bytes_));
  const auto samples = bag.odometry("/odom");
  ASSERT_EQ(samples.size(), 3u);
  EXPECT_EQ(samples[0].header.stamp_us, 0);
  EXPECT_EQ(samples[1].pose.position.x, 10.0);
  EXPECT_EQ(samples[2].header.stamp_us, 5'000) << "in the order of recording";
  EXPECT_EQ(sink.syncs, 2) << "after the chunk and after the index";
}

TEST_F(BagReaderTest, AFileSinkWritesTheSameBytes) {
  const std::string file = (folder_.path() / "sink.bag").string();
  {
    FileSink sink(file, /*durable=*/true);
    BagEncoder encoder(sink, BagCompression::kNone);
    encoder.add(kNotes, 1'000'000, serialize(std::string("hello")));
    encoder.finish();
  }
  BagFile bag(file);
  EXPECT_EQ(bag.strings("/notes"), std::vector<std::string>{"hello"});
  EXPECT_THROW(FileSink(file, false), RecordingError) << "a recording is never written over";
  const auto fullDisk = [] { FileSink sink("/dev/full", false); };
  EXPECT_THROW(fullDisk(), RecordingError);
}

TEST(BagsOf, AFileAFolderOrSeveralWithCommasBetween) {
  const TemporaryFolder folder;
  const std::string path = folder.path();
  fs::create_directory(path + "/drive");
  for (const char* name :
       {"/drive/b.bag", "/drive/a.bag", "/drive/c.bag.active", "/drive/notes.txt", "/x,y.bag"}) {
    std::ofstream(path + name) << "-";
  }
  const std::vector<std::string> parts{path + "/drive/a.bag", path + "/drive/b.bag",
                                       path + "/drive/c.bag.active"};
  EXPECT_EQ(bagsOf(path + "/drive"), parts);
  EXPECT_EQ(bagsOf(parts[0] + "," + parts[1] + "," + parts[2]), parts);
  EXPECT_EQ(bagsOf(parts[2] + "," + path + "/drive"),
            (std::vector<std::string>{parts[2], parts[0], parts[1], parts[2]}));
  EXPECT_THROW(bagsOf(path + "/none.bag," + path + "/drive"), ConfigError);
  EXPECT_EQ(bagsOf(path + "/x,y.bag"), std::vector<std::string>{path + "/x,y.bag"});
}

}  // namespace
}  // namespace vismem
