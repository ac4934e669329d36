/// @file Log lines on stderr, and the last of them for remote readers. No Ice.
#pragma once

#include <functional>
#include <iosfwd>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "common/process/log_ring.h"

namespace vismem {

/// Writes one line per message: "2026-11-21 12:41:02.123 localization WARNING waiting for Camera at ...". A
/// message of several lines is indented, so that every line that begins with a date is a message. In the
/// journal of systemd, which has date, name and level itself, each line is "<4>waiting for Camera at ..."
/// with the level of sd-daemon(3). Log once per change of state, not once per frame. Thread-safe.
class Logger {
 public:
  using Stamp = std::function<std::string()>;

  /// @param component  name in every line.
  /// @param lowest     messages below it are dropped.
  explicit Logger(std::string component, LogLevel lowest = LogLevel::kInfo);
  enum class Format { kTerminal, kJournal };
  /// For tests: another stream, which must outlive the logger, and another clock.
  Logger(std::string component, LogLevel lowest, std::ostream& out, Stamp stamp,
         Format format = Format::kTerminal);

  Format format() const { return format_; }
  void setLowest(LogLevel lowest);
  /// From now on a secret shows as "***" in every message. An empty one is ignored.
  void conceal(const std::string& secret);
  void write(LogLevel level, std::string_view message);
  void debug(std::string_view message) { write(LogLevel::kDebug, message); }
  void info(std::string_view message) { write(LogLevel::kInfo, message); }
  void warning(std::string_view message) { write(LogLevel::kWarning, message); }
  void error(std::string_view message) { write(LogLevel::kError, message); }

  /// The last messages that were written.
  const LogRing& history() const { return history_; }

 private:
  std::string withoutSecrets(std::string_view message) const;
  /// The lines as they go to the stream.
  std::string written(LogLevel level, const std::string& text) const;

  const std::string component_;
  const Stamp stamp_;
  const Format format_;
  mutable std::mutex mutex_;
  LogLevel lowest_;
  std::vector<std::string> secrets_;
  std::ostream& out_;
  LogRing history_;
};

}  // namespace vismem
