/// @file A child process: its output line by line, its exit code, and its guaranteed end. No Ice.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace vismem {

/// Text for a code of ChildProcess::exitCode: "ended with code 1", or "was killed by signal 9 (Killed)".
std::string describeExit(int code);

/// Owns one child process. The child never outlives its owner: the destructor kills it, and the kernel kills
/// it after the death of this process (PR_SET_PDEATHSIG). The kernel watches the constructing thread, which
/// must live as long as the child. The child has its own process group (a Ctrl-C on the terminal reaches only
/// the owner, which then stops its children in its own order), reads /dev/null, and starts with an empty
/// signal mask. Thread-safe, except construction and destruction.
class ChildProcess {
 public:
  enum class Stream { kOut, kError };
  struct Line {
    Stream stream = Stream::kOut;
    std::string text;
  };
  struct Options {
    /// Added to the environment of this process.
    std::vector<std::pair<std::string, std::string>> environment;
    /// Empty: that of this process.
    std::filesystem::path working_directory;
    /// Called from the reading thread with every line, in order per stream. Must not block for long
    /// (the child would stall on a full pipe) and must not use the ChildProcess.
    std::function<void(const Line&)> on_line;
    /// Number of last lines that are kept for waitForLine and text.
    std::size_t kept_lines = 20'000;
  };

  /// Starts the program.
  /// @param command program (looked up in PATH if it has no '/') and its arguments.
  /// @throw std::runtime_error "cannot start PROGRAM: REASON".
  explicit ChildProcess(std::vector<std::string> command) : ChildProcess(std::move(command), Options{}) {}
  ChildProcess(std::vector<std::string> command, Options options);
  /// Kills and reaps a child that still runs.
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  pid_t pid() const { return pid_; }
  bool running() const { return !exitCode(); }
  /// @return the exit code, 128 + signal if a signal ended it, empty while it runs. Once it is set, all that
  ///         the child wrote has been read.
  std::optional<int> exitCode() const;

  /// Waits for a line of either stream that contains `text`; lines read before the call count.
  /// @param from index of the first line to search, from lineCount(): older lines are ignored.
  /// All that the child wrote to its errors before a line of its output is read when that line is found.
  /// @return the whole line; empty at the deadline, or at once when the child has ended without it.
  std::optional<std::string> waitForLine(const std::string& text, std::chrono::milliseconds timeout,
                                         std::size_t from = 0) const;
  /// @return lines read since the start, both streams together.
  std::size_t lineCount() const;
  /// @return the kept output of a stream.
  std::string text(Stream stream) const;
  std::string out() const { return text(Stream::kOut); }
  std::string error() const { return text(Stream::kError); }

  /// Sends a signal (SIGTERM, SIGKILL, SIGSTOP ...).
  /// @return false if the child has ended already.
  bool signal(int number);
  /// @return the exit code, empty at the deadline.
  std::optional<int> waitForExit(std::chrono::milliseconds timeout) const;
  /// Sends SIGTERM, and SIGKILL after the grace time.
  /// @return the exit code (137 when it had to be killed).
  int stop(std::chrono::milliseconds grace);

 private:
  void start(const std::vector<std::string>& command);
  void readUntilExit();
  /// @param[in,out] partial line without its end.
  /// @return false at the end of the stream.
  static bool readAvailable(int fd, std::string& partial, std::vector<std::string>& lines);
  void addLine(Stream stream, std::string text);

  const Options options_;
  pid_t pid_ = -1;
  int pid_fd_ = -1;
  int out_fd_ = -1;
  int error_fd_ = -1;

  mutable std::mutex mutex_;
  mutable std::condition_variable changed_;
  std::deque<Line> lines_;
  std::size_t dropped_lines_ = 0;
  std::optional<int> exit_code_;
  /// True once the kernel may reuse the pid for another process.
  bool reaped_ = false;
  std::jthread reader_;
};

}  // namespace vismem
