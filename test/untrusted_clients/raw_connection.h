/// @file A raw TCP connection: sends any bytes, with deadlines, so that no server can make a test hang.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <string_view>

namespace vismem::test {

/// To a port of 127.0.0.1. Never throws: tests check whether the server refuses or closes it.
class RawConnection {
 public:
  explicit RawConnection(int port);
  ~RawConnection();
  RawConnection(RawConnection&& other) noexcept;
  RawConnection& operator=(RawConnection&&) = delete;

  bool open() const { return fd_ >= 0; }
  /// @return whether all bytes were sent before the deadline.
  bool send(std::string_view bytes, std::chrono::milliseconds timeout = std::chrono::seconds(10));
  /// One message of Ice with its header.
  /// @return empty at the end, at the deadline, and for what is no message.
  std::optional<std::string> receive(std::chrono::milliseconds timeout = std::chrono::seconds(10));
  /// Discards received bytes.
  /// @return false when the server has closed the connection.
  bool drain(std::chrono::milliseconds for_at_most);
  /// Ends sending; the connection stays open.
  void endSending();
  void close();

 private:
  bool waitFor(short events, std::chrono::steady_clock::time_point deadline) const;
  bool fill(std::size_t size, std::chrono::steady_clock::time_point deadline);

  int fd_ = -1;
  std::string received_;
};

}  // namespace vismem::test
