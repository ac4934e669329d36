/// @file One recording: messages into bags of bounded size, in chunks of bounded time. Pure: files are a
/// port.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "recorder/core/log_message.h"
#include "recorder/core/stream_clocks.h"

namespace vismem {

/// Where the parts of a recording go.
class PartStore {
 public:
  virtual ~PartStore() = default;
  /// @param number from 0. @throws RecordingError when it cannot be made.
  virtual std::unique_ptr<ByteSink> open(int number) = 0;
  /// The sink of the part is gone. @param finished it has its index.
  virtual void closed(int number, bool finished) = 0;
};

struct BagRecordingParams {
  BagCompression compression = BagCompression::kNone;
  StampUs max_chunk_us = 500'000;  ///< of stamps and of the clock; what a crash may cost
  std::size_t max_chunk_bytes = 1 << 20;
  std::uint64_t split_bytes = 0;  ///< a part ends when it has so many; 0: never
  StampUs split_us = 0;           ///< and when it is so long; 0: never
};

/// Invariant: what was written before the open chunk can be read whatever happens next. Stamps of a
/// stream that go back by over a second begin a new part: a bag holds one epoch. *Single-threaded.*
class BagRecording {
 public:
  /// Opens the first part. @param store must outlive it. @throws RecordingError.
  BagRecording(const BagRecordingParams& params, PartStore& store);
  /// Ends it as finish() does, silently.
  ~BagRecording();

  /// @param clock_us of any clock that does not go back.
  /// @throws RecordingError when the disk fails: the recording has then ended with what was written before.
  void add(const RecordedMessage& message, StampUs clock_us);
  /// Closes a chunk that has been open for too long. To be called several times a second. @throws as add().
  void tick(StampUs clock_us);
  /// Writes the index of the last part. @throws RecordingError.
  void finish();

  bool ended() const { return encoder_ == nullptr; }
  int parts() const { return part_ + 1; }
  /// Of all parts, without the open chunk.
  std::uint64_t bytes() const;
  std::uint64_t messages() const;
  /// Stamps of the first and the newest message.
  std::optional<StampUs> beginUs() const { return begin_us_; }
  std::optional<StampUs> endUs() const { return end_us_; }

 private:
  void openPart();
  void closePart();
  /// Calls `work`; when the disk fails, saves what can be saved and ends the recording.
  template <typename Work>
  void guarded(Work work);
  bool isFull(const RecordedMessage& next) const;
  void put(const RecordedMessage& message, StampUs clock_us);

  const BagRecordingParams params_;
  PartStore& store_;
  int part_ = 0;
  std::unique_ptr<ByteSink> sink_;
  std::unique_ptr<BagEncoder> encoder_;
  std::map<std::string, RecordedMessage> latched_;
  std::optional<StampUs> chunk_opened_us_;  ///< by the clock
  std::optional<StampUs> part_begin_us_;
  StreamClocks clocks_;  ///< of this part
  std::optional<StampUs> begin_us_;
  std::optional<StampUs> end_us_;
  std::uint64_t closed_bytes_ = 0;
  std::uint64_t closed_messages_ = 0;
};

}  // namespace vismem
