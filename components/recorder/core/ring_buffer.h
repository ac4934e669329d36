/// @file The last seconds of everything, kept in memory until somebody wants them saved. Pure.
#pragma once

#include <deque>
#include <map>
#include <string>
#include <vector>

#include "recorder/core/log_message.h"
#include "recorder/core/stream_clocks.h"

namespace vismem {

/// Invariant: it holds at most `max_bytes` and, apart from the last message of each latched topic, nothing
/// more than `length_us` older than the newest stamp. *Single-threaded.*
class RingBuffer {
 public:
  /// @param length_us 0: keeps nothing.
  RingBuffer(StampUs length_us, std::size_t max_bytes) : length_us_(length_us), max_bytes_(max_bytes) {}

  /// A stream whose stamp goes back by over a second begins anew: what was before belongs to another epoch.
  void add(const RecordedMessage& message);
  /// The last latched messages, then all others in the order in which they came.
  std::vector<RecordedMessage> contents() const;

  std::size_t bytes() const { return bytes_; }
  /// From the oldest to the newest message.
  StampUs lengthUs() const;

 private:
  void trim();

  const StampUs length_us_;
  const std::size_t max_bytes_;
  std::size_t bytes_ = 0;
  StampUs newest_us_ = 0;
  StreamClocks clocks_;
  std::deque<RecordedMessage> messages_;
  std::map<std::string, RecordedMessage> latched_;
};

}  // namespace vismem
