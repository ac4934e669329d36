/// @file What fuzz targets of recordings share.
#pragma once

#include <sys/mman.h>
#include <unistd.h>

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <string>

#include "replay_server/app/log_player.h"

namespace vismem {

/// A file in memory with a name in /proc.
class MemoryFile {
 public:
  MemoryFile(const std::uint8_t* data, std::size_t size) : fd_(::memfd_create("fuzz", 0)) {
    std::size_t done = 0;
    while (done < size) {
      const ::ssize_t n = ::write(fd_, data + done, size - done);
      if (n <= 0) break;
      done += static_cast<std::size_t>(n);
    }
  }
  ~MemoryFile() { ::close(fd_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  std::string name() const { return "/proc/self/fd/" + std::to_string(fd_); }

 private:
  int fd_;
};

/// Time goes on when somebody waits.
class JumpingClock : public PacingClock {
 public:
  StampUs now() const override { return now_us_; }
  void waitUntil(std::unique_lock<std::mutex>&, std::condition_variable&, StampUs until_us) override {
    now_us_ = until_us > now_us_ ? until_us : now_us_ + 1;
  }

 private:
  StampUs now_us_ = 0;
};

}  // namespace vismem
