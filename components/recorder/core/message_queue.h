/// @file The messages that wait for the disk, in bounded memory. Pure.
#pragma once

#include <deque>
#include <map>
#include <optional>
#include <string>

#include "recorder/core/log_message.h"

namespace vismem {

/// Invariant: it never holds more than its limit. Images leave a tenth of it to the small messages, which
/// take the place of waiting images when that is full: a slow disk costs images before it costs poses.
/// *Single-threaded* (the service guards it).
class MessageQueue {
 public:
  /// @param limit [bytes], at least 1 MiB.
  explicit MessageQueue(std::size_t limit) : limit_(limit) {}

  /// @return whether it was taken; one that does not fit is counted as dropped, and so is an image that was
  /// taken and has to make room later.
  bool push(RecordedMessage message);
  std::optional<RecordedMessage> pop();
  /// Counts images that never reached the recorder.
  void addMissed(const LogTopic& topic, std::uint64_t images);

  std::size_t bytes() const { return bytes_; }
  std::size_t limit() const { return limit_; }
  std::size_t peakBytes() const { return peak_; }
  bool empty() const { return messages_.empty(); }
  /// By name of the topic.
  const std::map<std::string, TopicCount>& counts() const { return counts_; }
  std::uint64_t dropped() const { return dropped_; }

 private:
  TopicCount& countOf(const LogTopic& topic);
  /// Drops waiting images, the newest first, until so many bytes fit or no image is left.
  void makeRoom(std::size_t size);

  const std::size_t limit_;
  std::size_t bytes_ = 0;
  std::size_t peak_ = 0;
  std::uint64_t dropped_ = 0;
  std::deque<RecordedMessage> messages_;
  std::size_t images_ = 0;  ///< that wait
  std::map<std::string, TopicCount> counts_;
};

}  // namespace vismem
