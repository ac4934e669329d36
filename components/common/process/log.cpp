#include "common/process/log.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <iostream>
#include <utility>

#include "common/config/text_file.h"
#include "common/process/service_manager.h"

namespace vismem {
namespace {

std::int64_t realTime_us() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::microseconds>(now).count();
}

std::string localTime() {
  const auto now = std::chrono::system_clock::now();
  const auto seconds = std::chrono::system_clock::to_time_t(now);
  const auto milliseconds =
      std::chrono::duration_cast<std::chrono::milliseconds>(now.time_since_epoch()).count() % 1000;
  std::tm calendar{};
  localtime_r(&seconds, &calendar);
  std::array<char, 32> text{};
  const auto length = std::strftime(text.data(), text.size(), "%Y-%m-%d %H:%M:%S", &calendar);
  std::snprintf(text.data() + length, text.size() - length, ".%03d", static_cast<int>(milliseconds));
  return text.data();
}

const char* nameOf(LogLevel level) {
  switch (level) {
    case LogLevel::kDebug:
      return "DEBUG";
    case LogLevel::kInfo:
      return "INFO";
    case LogLevel::kWarning:
      return "WARNING";
    case LogLevel::kError:
      return "ERROR";
  }
  return "";
}

/// The level of syslog(3) in front of a line.
const char* journalLevel(LogLevel level) {
  switch (level) {
    case LogLevel::kDebug:
      return "<7>";
    case LogLevel::kInfo:
      return "<6>";
    case LogLevel::kWarning:
      return "<4>";
    case LogLevel::kError:
      return "<3>";
  }
  return "";
}

Logger::Format formatOfStderr() {
  const char* stream = std::getenv("JOURNAL_STREAM");
  return stream != nullptr && leadsToJournal(STDERR_FILENO, stream) ? Logger::Format::kJournal
                                                                    : Logger::Format::kTerminal;
}

}  // namespace

Logger::Logger(std::string component, LogLevel lowest)
    : Logger(std::move(component), lowest, std::cerr, localTime, formatOfStderr()) {}

Logger::Logger(std::string component, LogLevel lowest, std::ostream& out, Stamp stamp, Format format)
    : component_(std::move(component)),
      stamp_(std::move(stamp)),
      format_(format),
      lowest_(lowest),
      out_(out) {}

void Logger::setLowest(LogLevel lowest) {
  const std::scoped_lock lock(mutex_);
  lowest_ = lowest;
}

void Logger::conceal(const std::string& secret) {
  if (secret.empty()) return;
  const std::scoped_lock lock(mutex_);
  secrets_.push_back(secret);
}

std::string Logger::withoutSecrets(std::string_view message) const {
  std::string text(message);
  const std::scoped_lock lock(mutex_);
  for (const std::string& secret : secrets_) {
    for (auto at = text.find(secret); at != std::string::npos; at = text.find(secret, at)) {
      text.replace(at, secret.size(), "***");
    }
  }
  return text;
}

std::string Logger::written(LogLevel level, const std::string& text) const {
  if (format_ == Format::kTerminal)
    return stamp_() + " " + component_ + " " + nameOf(level) + " " + text + '\n';
  const std::string prefix = journalLevel(level);
  std::string lines = prefix;
  for (const char c : text) {
    lines += c;
    if (c == '\n') lines += prefix;
  }
  return lines + '\n';
}

void Logger::write(LogLevel level, std::string_view message) {
  const std::string whole = withoutSecrets(message);
  std::string_view rest = whole;
  std::string text;
  // A message may contain text of peers, which must neither flood nor control the terminal.
  for (;;) {
    const auto end = std::min(rest.find('\n'), rest.size());
    text += shown(rest.substr(0, end));
    if (end == rest.size()) break;
    text += "\n    ";
    rest.remove_prefix(end + 1);
  }
  const std::string line = written(level, text);
  const std::scoped_lock lock(mutex_);
  if (level < lowest_) return;
  out_ << line << std::flush;
  history_.add(level, realTime_us(), std::move(text));
}

}  // namespace vismem
