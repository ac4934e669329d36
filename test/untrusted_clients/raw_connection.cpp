#include "untrusted_clients/raw_connection.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

#include "untrusted_clients/ice_wire.h"

namespace vismem::test {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::int32_t kLargestMessage = 64 << 20;

}  // namespace

RawConnection::RawConnection(int port) : fd_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  // On the loopback this ends at once, with or without a listener.
  if (fd_ >= 0 && ::connect(fd_, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0) close();
  if (fd_ >= 0) ::fcntl(fd_, F_SETFL, ::fcntl(fd_, F_GETFL) | O_NONBLOCK);
}

RawConnection::~RawConnection() {
  close();
}

RawConnection::RawConnection(RawConnection&& other) noexcept
    : fd_(std::exchange(other.fd_, -1)), received_(std::move(other.received_)) {}

void RawConnection::close() {
  if (fd_ >= 0) ::close(fd_);
  fd_ = -1;
}

void RawConnection::endSending() {
  if (fd_ >= 0) ::shutdown(fd_, SHUT_WR);
}

bool RawConnection::waitFor(short events, Clock::time_point deadline) const {
  const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now()).count();
  pollfd wanted{fd_, events, 0};
  return left > 0 && ::poll(&wanted, 1, static_cast<int>(left)) > 0;
}

bool RawConnection::send(std::string_view bytes, std::chrono::milliseconds timeout) {
  const auto deadline = Clock::now() + timeout;
  while (!bytes.empty() && fd_ >= 0) {
    const auto sent = ::send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent > 0) {
      bytes.remove_prefix(static_cast<std::size_t>(sent));
    } else if (errno == EAGAIN || errno == EINTR) {
      if (!waitFor(POLLOUT, deadline)) return false;
    } else {
      close();
    }
  }
  return fd_ >= 0;
}

bool RawConnection::fill(std::size_t size, Clock::time_point deadline) {
  std::array<char, 1 << 16> buffer;
  while (received_.size() < size) {
    if (fd_ < 0) return false;
    const auto count = ::recv(fd_, buffer.data(), buffer.size(), 0);
    if (count > 0) {
      received_.append(buffer.data(), static_cast<std::size_t>(count));
    } else if (count < 0 && (errno == EAGAIN || errno == EINTR)) {
      if (!waitFor(POLLIN, deadline)) return false;
    } else {
      close();
    }
  }
  return true;
}

std::optional<std::string> RawConnection::receive(std::chrono::milliseconds timeout) {
  const auto deadline = Clock::now() + timeout;
  if (!fill(kHeaderSize, deadline)) return std::nullopt;
  std::int32_t size = 0;
  std::memcpy(&size, received_.data() + kHeaderSize - sizeof size, sizeof size);
  if (!received_.starts_with("IceP") || size < static_cast<std::int32_t>(kHeaderSize) ||
      size > kLargestMessage) {
    close();
    return std::nullopt;
  }
  if (!fill(static_cast<std::size_t>(size), deadline)) return std::nullopt;
  std::string whole = received_.substr(0, static_cast<std::size_t>(size));
  received_.erase(0, static_cast<std::size_t>(size));
  return whole;
}

bool RawConnection::drain(std::chrono::milliseconds for_at_most) {
  const auto deadline = Clock::now() + for_at_most;
  received_.clear();
  while (fill(1, deadline)) received_.clear();
  return fd_ >= 0;
}

}  // namespace vismem::test
