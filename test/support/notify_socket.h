/// @file The service manager's end of sd_notify(3), for tests.
#pragma once

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstddef>
#include <cstring>
#include <optional>
#include <string>

namespace vismem {

/// A bound datagram socket. *Single-threaded* (owner: the test).
class NotifySocket {
 public:
  /// @param name a path, or '@' and an abstract name.
  explicit NotifySocket(std::string name)
      : name_(std::move(name)), descriptor_(socket(AF_UNIX, SOCK_DGRAM, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::memcpy(address.sun_path, name_.data(), name_.size());
    if (name_[0] == '@') address.sun_path[0] = '\0';
    const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + name_.size());
    EXPECT_EQ(bind(descriptor_, reinterpret_cast<const sockaddr*>(&address), size), 0)
        << std::strerror(errno);
  }
  ~NotifySocket() {
    close(descriptor_);
    if (name_[0] != '@') unlink(name_.c_str());
  }
  NotifySocket(const NotifySocket&) = delete;
  NotifySocket& operator=(const NotifySocket&) = delete;

  const std::string& name() const { return name_; }

  /// @return the next datagram; empty if none comes in time.
  std::optional<std::string> next(std::chrono::milliseconds timeout) {
    pollfd wait{descriptor_, POLLIN, 0};
    if (poll(&wait, 1, static_cast<int>(timeout.count())) != 1) return std::nullopt;
    std::array<char, 4096> text{};
    const auto size = recv(descriptor_, text.data(), text.size(), 0);
    return size < 0 ? std::nullopt : std::optional(std::string(text.data(), static_cast<std::size_t>(size)));
  }

  /// Fewer datagrams fit until the next read: what is sent meanwhile is refused.
  void shrink() {
    const int smallest = 1;
    setsockopt(descriptor_, SOL_SOCKET, SO_RCVBUF, &smallest, sizeof smallest);
  }

 private:
  const std::string name_;
  const int descriptor_;
};

}  // namespace vismem
