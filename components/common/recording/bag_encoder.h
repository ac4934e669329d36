/// @file Writes a ROS 1 bag chunk by chunk: what has left this class is a bag that BagReader opens, wherever
/// the power fails. Pure: bytes go to a port.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/recording/bag_compression.h"
#include "common/recording/bag_format.h"

namespace vismem {

/// Where the bytes of a recording go: a file, or a slow or full disk in a test.
class ByteSink {
 public:
  virtual ~ByteSink() = default;
  /// Appends all bytes. @throws RecordingError when that fails; some may then have been written.
  virtual void write(ByteView bytes) = 0;
  /// Replaces bytes that were written. @throws RecordingError.
  virtual void overwrite(std::uint64_t offset, ByteView bytes) = 0;
  /// Forgets what lies behind `size`. @throws RecordingError.
  virtual void truncate(std::uint64_t size) = 0;
  /// What was written survives a power failure from now on. @throws RecordingError.
  virtual void sync() = 0;
};

/// A topic with the type of its messages, which findRosType must know.
struct BagChannel {
  std::string topic;
  std::string type;

  bool operator==(const BagChannel&) const = default;
  auto operator<=>(const BagChannel&) const = default;
};

/// Messages are collected in one open chunk, in memory; closeChunk() writes it with its index in one piece.
/// Invariant: between two calls the sink holds whole chunks only. *Single-threaded.*
class BagEncoder {
 public:
  /// Writes the file's header. @param sink must outlive the encoder.
  BagEncoder(ByteSink& sink, BagCompression compression);

  /// @param stamp_us time of recording; the index is sorted by it.
  /// @throws RecordingError for a type that findRosType does not know.
  void add(const BagChannel& channel, std::int64_t stamp_us, ByteView message);
  /// Bytes of the open chunk.
  std::size_t openBytes() const { return chunk_.size(); }
  /// Stamp of the open chunk's first message.
  std::optional<std::int64_t> openSince() const { return open_since_us_; }

  /// Writes the open chunk, if there is one, and syncs. After a failure the sink is cut back to the chunk
  /// before, and the open chunk is lost. @throws RecordingError.
  void closeChunk();
  /// Writes the index; nothing may be added then. @throws RecordingError: the bag then has no index, and
  /// BagReader makes it.
  void finish();

  /// In the sink.
  std::uint64_t bytesWritten() const { return written_; }
  std::uint64_t messagesWritten() const { return messages_written_; }

 private:
  struct Item {
    std::int64_t time_ns = 0;
    std::uint32_t offset = 0;
  };
  struct ChunkInfo {
    std::uint64_t pos = 0;
    std::int64_t first_ns = 0;
    std::int64_t last_ns = 0;
    std::map<std::uint32_t, std::uint32_t> counts;  ///< by connection
  };

  std::uint32_t connect(const BagChannel& channel);
  Bytes fileHeader(std::uint64_t index_pos) const;
  ChunkInfo appendChunk(Bytes& out) const;
  void forgetChunk();

  ByteSink& sink_;
  const BagCompression compression_;
  std::map<BagChannel, std::uint32_t> connections_;
  std::vector<Bytes> connection_records_;  ///< by number
  std::vector<bool> in_file_;              ///< whether the connection stands in a chunk that was written
  std::vector<ChunkInfo> chunks_;
  Bytes chunk_;
  std::map<std::uint32_t, std::vector<Item>> items_;  ///< of the open chunk, by connection
  std::optional<std::int64_t> open_since_us_;
  std::uint64_t written_ = 0;
  std::uint64_t messages_written_ = 0;
};

}  // namespace vismem
