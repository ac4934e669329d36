/// @file The last messages of a log, for clients that read it remotely. No Ice.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <string>
#include <vector>

namespace vismem {

enum class LogLevel { kDebug, kInfo, kWarning, kError };

struct LogLine {
  std::int64_t seq = 0;       ///< from 1, rising by one
  std::int64_t stamp_us = 0;  ///< host's real time [us]
  LogLevel level = LogLevel::kInfo;
  std::string text;
};

/// A bounded buffer of messages. *Thread-safe.*
class LogRing {
 public:
  static constexpr std::size_t kCapacity = 1000;
  static constexpr std::size_t kLongestText_bytes = 4000;

  struct Batch {
    std::vector<LogLine> messages;  ///< oldest first
    std::int64_t last_seq = 0;      ///< what to ask after next time
    std::int64_t lost = 0;          ///< of the messages after the asked one, how many are no longer held
  };

  /// Keeps a message. @param text valid UTF-8; of more than kLongestText_bytes the beginning is kept.
  void add(LogLevel level, std::int64_t stamp_us, std::string text);

  /// Messages after `after_seq` of at least `lowest`. @param after_seq a number ahead of the newest counts as
  /// 0: the process has restarted. @param most messages in the answer, the oldest ones; the rest comes with
  /// the next call.
  Batch since(std::int64_t after_seq, LogLevel lowest, std::size_t most) const;

 private:
  mutable std::mutex mutex_;
  std::deque<LogLine> messages_;
  std::int64_t last_seq_ = 0;
};

}  // namespace vismem
