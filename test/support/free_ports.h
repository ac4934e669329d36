/// @file Free ports for a whole setup, so that system tests run side by side.
#pragma once

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <random>

namespace vismem {

/// A listening socket, or none if the port is taken.
class Listener {
 public:
  explicit Listener(int port) : fd_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    const int yes = 1;
    setsockopt(fd_, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    good_ =
        bind(fd_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 && listen(fd_, 1) == 0;
  }
  ~Listener() { close(fd_); }
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;
  bool good() const { return good_; }

 private:
  int fd_;
  bool good_ = false;
};

/// An offset at which every port of our setups is free, below the range that the kernel gives out by itself.
inline int freePortOffset() {
  std::random_device random;
  for (int tries = 0; tries < 200; ++tries) {
    const int offset = 2000 + static_cast<int>(random() % 190) * 100;
    bool free = true;
    for (int port = 9970; free && port <= 9999; ++port) free = Listener(port + offset).good();
    for (int port = 11000; free && port <= 11008; ++port) free = Listener(port + offset).good();
    if (free) return offset;
  }
  ADD_FAILURE() << "no free ports";
  return 0;
}

}  // namespace vismem
