#include "common/process/log.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <iostream>
#include <utility>

#include "common/config/text_file.h"

namespace vismem {
namespace {

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

}  // namespace

Logger::Logger(std::string component, LogLevel lowest)
    : Logger(std::move(component), lowest, std::cerr, localTime) {}

Logger::Logger(std::string component, LogLevel lowest, std::ostream& out, Stamp stamp)
    : component_(std::move(component)), stamp_(std::move(stamp)), lowest_(lowest), out_(out) {}

void Logger::setLowest(LogLevel lowest) {
  const std::scoped_lock lock(mutex_);
  lowest_ = lowest;
}

void Logger::write(LogLevel level, std::string_view message) {
  std::string line = stamp_() + " " + component_ + " " + nameOf(level) + " ";
  // What peers sent may be part of a message: it must neither flood nor steer the terminal.
  for (;;) {
    const auto end = std::min(message.find('\n'), message.size());
    line += shown(message.substr(0, end)) + '\n';
    if (end == message.size()) break;
    line += "    ";
    message.remove_prefix(end + 1);
  }
  const std::scoped_lock lock(mutex_);
  if (level < lowest_) return;
  out_ << line << std::flush;
}

}  // namespace vismem
