#include "common/process/child_process.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <map>
#include <stdexcept>

extern char** environ;

namespace vismem {
namespace {

struct Pipe {
  int read_end = -1;
  int write_end = -1;

  Pipe() {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) {
      throw std::runtime_error(std::string("cannot make a pipe: ") + std::strerror(errno));
    }
    read_end = ends[0];
    write_end = ends[1];
  }
  ~Pipe() {
    closeEnd(read_end);
    closeEnd(write_end);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;

  static void closeEnd(int& fd) {
    if (fd >= 0) close(fd);
    fd = -1;
  }
  int takeReadEnd() { return std::exchange(read_end, -1); }
};

std::vector<std::string> environmentWith(const std::vector<std::pair<std::string, std::string>>& additions) {
  std::map<std::string, std::string> variables;
  for (char** entry = environ; *entry != nullptr; ++entry) {
    const std::string text = *entry;
    const auto equals = text.find('=');
    if (equals != std::string::npos) variables[text.substr(0, equals)] = text.substr(equals + 1);
  }
  for (const auto& [name, value] : additions) variables[name] = value;
  std::vector<std::string> texts;
  for (const auto& [name, value] : variables) texts.push_back(name + "=" + value);
  return texts;
}

std::vector<char*> pointersTo(std::vector<std::string>& texts) {
  std::vector<char*> pointers;
  for (auto& text : texts) pointers.push_back(text.data());
  pointers.push_back(nullptr);
  return pointers;
}

/// Runs in the child between fork and exec, where only async-signal-safe calls are allowed.
[[noreturn]] void becomeProgram(char* const* arguments, char* const* environment, const char* folder,
                                pid_t parent, int out, int error, int failure) {
  const auto fail = [failure] {
    const int reason = errno;
    [[maybe_unused]] const auto written = write(failure, &reason, sizeof reason);
    _exit(127);
  };
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(127);  // The parent died before the request above.
  setpgid(0, 0);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  std::signal(SIGPIPE, SIG_DFL);
  const int nothing = open("/dev/null", O_RDONLY);
  if (nothing < 0 || dup2(nothing, STDIN_FILENO) < 0 || dup2(out, STDOUT_FILENO) < 0 ||
      dup2(error, STDERR_FILENO) < 0) {
    fail();
  }
  if (*folder != '\0' && chdir(folder) != 0) fail();
  execvpe(arguments[0], arguments, environment);
  fail();
  _exit(127);
}

int codeOf(int status) {
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace

std::string describeExit(int code) {
  if (code <= 128) return "ended with code " + std::to_string(code);
  const int signal = code - 128;
  return "was killed by signal " + std::to_string(signal) + " (" + strsignal(signal) + ")";
}

ChildProcess::ChildProcess(std::vector<std::string> command, Options options) : options_(std::move(options)) {
  if (command.empty()) throw std::runtime_error("cannot start a process: no program is named");
  start(command);
  reader_ = std::jthread([this] { readUntilExit(); });
}

void ChildProcess::start(const std::vector<std::string>& command) {
  // All memory is allocated before fork: the child of a program with threads must not allocate.
  auto argument_texts = command;
  auto environment_texts = environmentWith(options_.environment);
  const auto arguments = pointersTo(argument_texts);
  const auto environment = pointersTo(environment_texts);
  const std::string folder = options_.working_directory.string();
  Pipe out;
  Pipe error;
  Pipe failure;
  const pid_t parent = getpid();
  pid_ = fork();
  if (pid_ < 0) throw std::runtime_error("cannot start " + command[0] + ": " + std::strerror(errno));
  if (pid_ == 0) {
    becomeProgram(arguments.data(), environment.data(), folder.c_str(), parent, out.write_end,
                  error.write_end, failure.write_end);
  }
  Pipe::closeEnd(out.write_end);
  Pipe::closeEnd(error.write_end);
  Pipe::closeEnd(failure.write_end);
  int reason = 0;
  ssize_t count = 0;
  do {
    count = read(failure.read_end, &reason, sizeof reason);
  } while (count < 0 && errno == EINTR);
  if (count == 0) {
    pid_fd_ = static_cast<int>(syscall(SYS_pidfd_open, pid_, 0));
    if (pid_fd_ < 0) {
      reason = errno;
      ::kill(pid_, SIGKILL);
    }
  }
  if (pid_fd_ < 0) {
    waitpid(pid_, nullptr, 0);
    throw std::runtime_error("cannot start " + command[0] + ": " + std::strerror(reason));
  }
  out_fd_ = out.takeReadEnd();
  error_fd_ = error.takeReadEnd();
  fcntl(out_fd_, F_SETFL, O_NONBLOCK);
  fcntl(error_fd_, F_SETFL, O_NONBLOCK);
}

ChildProcess::~ChildProcess() {
  signal(SIGKILL);
  reader_.join();
  close(out_fd_);
  close(error_fd_);
  close(pid_fd_);
}

void ChildProcess::readUntilExit() {
  std::string partial_out;
  std::string partial_error;
  std::array<pollfd, 3> waited{{{out_fd_, POLLIN, 0}, {error_fd_, POLLIN, 0}, {pid_fd_, POLLIN, 0}}};
  for (bool exited = false; !exited;) {
    if (poll(waited.data(), waited.size(), -1) < 0) continue;  // EINTR
    // All output is in the pipes when the exit is observed, so it is read afterwards. The end of the streams
    // does not indicate the exit: a grandchild may hold them open.
    exited = waited[2].revents != 0;
    // Who sees a line of the output also sees all errors that were written before it: the errors are read
    // later and handed on earlier.
    std::vector<std::string> out_lines;
    if (waited[0].fd >= 0 && !readAvailable(out_fd_, partial_out, out_lines)) waited[0].fd = -1;
    std::vector<std::string> error_lines;
    if (waited[1].fd >= 0 && !readAvailable(error_fd_, partial_error, error_lines)) waited[1].fd = -1;
    for (auto& line : error_lines) addLine(Stream::kError, std::move(line));
    for (auto& line : out_lines) addLine(Stream::kOut, std::move(line));
  }
  if (!partial_out.empty()) addLine(Stream::kOut, std::move(partial_out));
  if (!partial_error.empty()) addLine(Stream::kError, std::move(partial_error));
  int status = 0;
  const std::scoped_lock lock(mutex_);
  waitpid(pid_, &status, 0);
  reaped_ = true;
  exit_code_ = codeOf(status);
  changed_.notify_all();
}

bool ChildProcess::readAvailable(int fd, std::string& partial, std::vector<std::string>& lines) {
  std::array<char, 16384> buffer;
  for (;;) {
    const ssize_t count = read(fd, buffer.data(), buffer.size());
    if (count == 0) return false;
    if (count < 0) {
      if (errno == EINTR) continue;
      return errno == EAGAIN;
    }
    partial.append(buffer.data(), static_cast<std::size_t>(count));
    std::size_t begin = 0;
    for (auto end = partial.find('\n'); end != std::string::npos; end = partial.find('\n', begin)) {
      lines.push_back(partial.substr(begin, end - begin));
      begin = end + 1;
    }
    partial.erase(0, begin);
  }
}

void ChildProcess::addLine(Stream stream, std::string text) {
  Line line{stream, std::move(text)};
  if (options_.on_line) options_.on_line(line);
  const std::scoped_lock lock(mutex_);
  lines_.push_back(std::move(line));
  if (lines_.size() > options_.kept_lines) {
    lines_.pop_front();
    ++dropped_lines_;
  }
  changed_.notify_all();
}

std::optional<int> ChildProcess::exitCode() const {
  const std::scoped_lock lock(mutex_);
  return exit_code_;
}

std::optional<std::string> ChildProcess::waitForLine(const std::string& text,
                                                     std::chrono::milliseconds timeout,
                                                     std::size_t from) const {
  const auto deadline = std::chrono::steady_clock::now() + timeout;
  std::unique_lock lock(mutex_);
  for (std::size_t next = from;;) {
    for (next = std::max(next, dropped_lines_); next < dropped_lines_ + lines_.size(); ++next) {
      const auto& line = lines_[next - dropped_lines_].text;
      if (line.find(text) != std::string::npos) return line;
    }
    if (exit_code_) return std::nullopt;
    const auto ended_or_new_line = [&] { return exit_code_ || dropped_lines_ + lines_.size() > next; };
    if (!changed_.wait_until(lock, deadline, ended_or_new_line)) return std::nullopt;
  }
}

std::size_t ChildProcess::lineCount() const {
  const std::scoped_lock lock(mutex_);
  return dropped_lines_ + lines_.size();
}

std::string ChildProcess::text(Stream stream) const {
  const std::scoped_lock lock(mutex_);
  std::string all;
  for (const auto& line : lines_) {
    if (line.stream == stream) all += line.text + '\n';
  }
  return all;
}

bool ChildProcess::signal(int number) {
  const std::scoped_lock lock(mutex_);
  return !reaped_ && ::kill(pid_, number) == 0;
}

std::optional<int> ChildProcess::waitForExit(std::chrono::milliseconds timeout) const {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, timeout, [this] { return exit_code_.has_value(); });
  return exit_code_;
}

int ChildProcess::stop(std::chrono::milliseconds grace) {
  signal(SIGTERM);
  if (const auto code = waitForExit(grace)) return *code;
  signal(SIGKILL);
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return exit_code_.has_value(); });
  return *exit_code_;
}

}  // namespace vismem
