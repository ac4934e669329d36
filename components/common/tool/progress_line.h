/// @file The progress of a tool on stderr.
#pragma once

#include <unistd.h>

#include <chrono>
#include <cstddef>
#include <iostream>
#include <string>
#include <utility>

namespace vismem {

/// "WHAT: 57 of 150": in place on a terminal, otherwise a line every two seconds, so that short work prints
/// none. *Single-threaded.*
class ProgressLine {
 public:
  explicit ProgressLine(std::string what) : what_(std::move(what)) {}
  ~ProgressLine() {
    if (open_) std::cerr << "\r\033[K" << std::flush;
  }
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  void show(std::size_t done, std::size_t all) {
    const auto now = std::chrono::steady_clock::now();
    if (now - shown_ < (terminal_ ? std::chrono::milliseconds(100) : std::chrono::milliseconds(2000))) return;
    shown_ = now;
    const std::string text = what_ + ": " + std::to_string(done) + " of " + std::to_string(all);
    std::cerr << (terminal_ ? "\r" + text : text + "\n") << std::flush;
    open_ = terminal_;
  }

 private:
  std::string what_;
  bool terminal_ = ::isatty(STDERR_FILENO) == 1;
  bool open_ = false;
  std::chrono::steady_clock::time_point shown_ = std::chrono::steady_clock::now();
};

}  // namespace vismem
