/// @file The records that a ROS 1 bag (format 2.0) is made of. Pure.
/// Source: http://wiki.ros.org/Bags/Format/2.0.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace vismem {

/// What is wrong with a recording, in one line: file, topic where there is one, what was found and what was
/// expected.
class RecordingError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

using Bytes = std::vector<std::uint8_t>;
using ByteView = std::span<const std::uint8_t>;

inline constexpr std::string_view kBagMagic = "#ROSBAG V2.0\n";
/// Header and padding of the file's first record together have this size, so that it can be written again.
inline constexpr std::size_t kFileHeaderSize = 4096;
/// No chunk may be larger when it is unpacked: a damaged length must not take the machine's memory.
inline constexpr std::size_t kMaxChunkSize = 256u << 20;

enum class BagOp : std::uint8_t {
  kMessage = 2,
  kFileHeader = 3,
  kIndex = 4,
  kChunk = 5,
  kChunkInfo = 6,
  kConnection = 7
};

/// Fields NAME=VALUE of a record's header. A view: the bytes must outlive it.
class RecordFields {
 public:
  /// @return empty when the bytes are no list of fields.
  static std::optional<RecordFields> parse(ByteView bytes);

  std::optional<BagOp> op() const;
  std::optional<std::uint32_t> u32(std::string_view name) const;
  std::optional<std::uint64_t> u64(std::string_view name) const;
  /// A ROS time [ns].
  std::optional<std::int64_t> timeNs(std::string_view name) const;
  std::optional<std::string> text(std::string_view name) const;

 private:
  struct Field {
    std::string_view name;
    ByteView value;
  };
  std::optional<ByteView> find(std::string_view name, std::size_t size) const;

  std::vector<Field> fields_;
};

/// One record: `header` and `data` are views into the bytes it was read from.
struct BagRecord {
  RecordFields fields;
  ByteView data;
  std::size_t end = 0;  ///< offset of what follows
};

/// @param offset of the record in the bytes. @return empty when no whole record is there.
std::optional<BagRecord> readRecord(ByteView bytes, std::size_t offset);

/// Builds the header of a record.
class RecordHeader {
 public:
  explicit RecordHeader(BagOp op);
  /// Of a connection's data, which is a list of fields without an operation.
  RecordHeader() = default;

  RecordHeader& u32(std::string_view name, std::uint32_t value);
  RecordHeader& u64(std::string_view name, std::uint64_t value);
  RecordHeader& timeNs(std::string_view name, std::int64_t time_ns);
  RecordHeader& text(std::string_view name, std::string_view value);
  const Bytes& bytes() const { return bytes_; }

 private:
  void add(std::string_view name, ByteView value);
  Bytes bytes_;
};

/// Appends a whole record to `out`.
void appendRecord(Bytes& out, const RecordHeader& header, ByteView data);

void appendU32(Bytes& out, std::uint32_t value);
std::uint32_t readU32(const std::uint8_t* bytes);
std::uint64_t readU64(const std::uint8_t* bytes);
/// Seconds and nanoseconds as ROS writes a time. Times before 0 and past 2^32 s are brought to these ends.
void appendTime(Bytes& out, std::int64_t time_ns);

/// A ROS time [ns] as a stamp [us], rounded, and back.
std::int64_t toStampOfTime(std::int64_t time_ns);
std::int64_t toTimeNs(std::int64_t stamp_us);

}  // namespace vismem
