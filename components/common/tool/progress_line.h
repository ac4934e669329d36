/// @file The progress of a tool on stderr.
#pragma once

#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstddef>
#include <iostream>
#include <string>
#include <utility>

namespace vismem {

/// "WHAT: 57 of 150, 4 min left": the time left as if the rest took as long as what is done, once that took 5
/// s.
inline std::string progressText(const std::string& what, std::size_t done, std::size_t all,
                                double elapsed_s) {
  const std::string text = what + ": " + std::to_string(done) + " of " + std::to_string(all);
  constexpr double kEnough_s = 5.0;
  if (done == 0 || done > all || elapsed_s < kEnough_s) return text;
  const double left_s = elapsed_s * static_cast<double>(all - done) / static_cast<double>(done);
  if (left_s < 100.0)
    return text + ", " + std::to_string(10 * std::lround(std::ceil(left_s / 10.0))) + " s left";
  return text + ", " + std::to_string(std::lround(left_s / 60.0)) + " min left";
}

/// progressText in place on a terminal, otherwise a line every two seconds, so that short work prints none.
/// *Single-threaded.*
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
    const std::string text =
        progressText(what_, done, all, std::chrono::duration<double>(now - begun_).count());
    std::cerr << (terminal_ ? "\r\033[K" + text : text + "\n") << std::flush;
    open_ = terminal_;
  }

 private:
  std::string what_;
  bool terminal_ = ::isatty(STDERR_FILENO) == 1;
  bool open_ = false;
  std::chrono::steady_clock::time_point begun_ = std::chrono::steady_clock::now();
  std::chrono::steady_clock::time_point shown_ = begun_;
};

}  // namespace vismem
