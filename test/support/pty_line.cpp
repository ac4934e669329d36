#include "support/pty_line.h"

#include <fcntl.h>
#include <poll.h>
#include <pty.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <map>
#include <stdexcept>
#include <thread>

namespace vismem {

void PtyLine::plugIn() {
  if (device_ >= 0) return;
  termios raw{};
  cfmakeraw(&raw);
  std::array<char, 64> name{};
  if (openpty(&device_, &line_, name.data(), &raw, nullptr) != 0)
    throw std::runtime_error("no pseudo terminal");
  fcntl(device_, F_SETFL, O_NONBLOCK);
  fcntl(device_, F_SETFD, FD_CLOEXEC);
  fcntl(line_, F_SETFD, FD_CLOEXEC);
  std::filesystem::create_symlink(name.data(), path_);
}

void PtyLine::unplug() {
  if (device_ < 0) return;
  std::filesystem::remove(path_);
  ::close(line_);
  ::close(device_);
  device_ = line_ = -1;
}

std::vector<std::uint8_t> PtyLine::read(int timeout_ms) {
  if (device_ < 0) {
    std::this_thread::sleep_for(std::chrono::milliseconds(timeout_ms));
    return {};
  }
  pollfd wait{device_, POLLIN, 0};
  if (poll(&wait, 1, timeout_ms) <= 0) return {};
  std::vector<std::uint8_t> bytes(1024);
  const ssize_t got = ::read(device_, bytes.data(), bytes.size());
  bytes.resize(got > 0 ? static_cast<std::size_t>(got) : 0);
  return bytes;
}

void PtyLine::write(std::span<const std::uint8_t> bytes) {
  // A line without a reader fills up, and further bytes are lost, as on a real one.
  if (device_ >= 0) static_cast<void>(::write(device_, bytes.data(), bytes.size()) == 0);
}

int PtyLine::baud_bps() const {
  static const std::map<speed_t, int> kRates{
      {B9600, 9600}, {B19200, 19200}, {B38400, 38400}, {B57600, 57600}, {B115200, 115200}};
  termios line{};
  if (line_ < 0 || tcgetattr(line_, &line) != 0) return 0;
  const auto rate = kRates.find(cfgetospeed(&line));
  return rate == kRates.end() ? 0 : rate->second;
}

}  // namespace vismem
