/// @file Messages of a ROS 1 bag as bytes: found by its index, or by scanning its chunks where the index is
/// missing or wrong (a recording that was cut off).
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "common/recording/bag_compression.h"
#include "common/recording/bag_format.h"

namespace vismem {

/// One publisher of a topic. Several connections may have the same topic.
struct BagConnection {
  std::string topic;
  std::string type;  ///< "sensor_msgs/Image"
  std::string md5;   ///< of the message's definition
};

/// Where one message is.
struct BagEntry {
  std::int64_t time_ns = 0;  ///< of recording
  std::uint32_t chunk = 0;
  std::uint32_t offset = 0;  ///< of its record in the unpacked chunk
};

/// What was wrong with a bag, and what could be saved.
struct BagDamage {
  bool reindexed = false;          ///< the index was missing or wrong: all chunks were scanned
  std::size_t chunks_lost = 0;     ///< chunks of which at least a part could not be read
  std::uint64_t bytes_lost = 0;    ///< of the file, outside the chunks that could be read
  std::vector<std::string> notes;  ///< for people, each with the place and what was saved

  bool any() const { return reindexed || chunks_lost > 0 || bytes_lost > 0 || !notes.empty(); }
};

/// Invariant: every entry lies inside its chunk. *Single-threaded.*
class BagReader {
 public:
  /// Reads the index; scans the file where it has none that is right.
  /// @throws RecordingError for a file that cannot be opened, is no bag, or of which no message can be read.
  explicit BagReader(const std::string& file);
  ~BagReader();
  BagReader(BagReader&&) noexcept;
  BagReader& operator=(BagReader&&) noexcept;

  const std::string& file() const;
  std::uint64_t fileSize() const;
  const std::vector<BagConnection>& connections() const;
  /// Messages of a connection in the order of the file. @param connection index into connections().
  const std::vector<BagEntry>& entries(std::size_t connection) const;
  /// Names of the compressions in use, sorted: "lz4".
  std::vector<std::string> compressions() const;
  std::size_t chunks() const;
  const BagDamage& damage() const;

  /// The bytes of a message, or its first `at_most`: of an unpacked chunk only these are read.
  /// @throws RecordingError when its chunk is damaged.
  Bytes read(const BagEntry& entry, std::size_t at_most = std::numeric_limits<std::size_t>::max());

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace vismem
