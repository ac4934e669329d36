#include "common/serial/serial_port.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

#include "common/drivers/device_errors.h"

namespace vismem {
namespace {

constexpr std::array<std::pair<int, speed_t>, 26> kRates{{
    {50, B50},           {75, B75},           {110, B110},         {134, B134},         {150, B150},
    {300, B300},         {600, B600},         {1200, B1200},       {1800, B1800},       {2400, B2400},
    {4800, B4800},       {9600, B9600},       {19200, B19200},     {38400, B38400},     {57600, B57600},
    {115200, B115200},   {230400, B230400},   {460800, B460800},   {500000, B500000},   {576000, B576000},
    {921600, B921600},   {1000000, B1000000}, {1500000, B1500000}, {2000000, B2000000}, {3000000, B3000000},
    {4000000, B4000000},
}};

const std::pair<int, speed_t>* findRate(int baud_bps) {
  const auto* rate =
      std::find_if(kRates.begin(), kRates.end(), [&](const auto& r) { return r.first == baud_bps; });
  return rate == kRates.end() ? nullptr : rate;
}

/// Timeout for poll [ms], rounded up so that a wait never ends before its deadline.
int millisecondsUntil(SerialPort::Clock::time_point deadline) {
  const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - SerialPort::Clock::now()).count();
  return static_cast<int>(std::clamp<long>(left, 0, 60'000));
}

}  // namespace

bool isBaudRate(int baud_bps) {
  return findRate(baud_bps) != nullptr;
}

SerialPort::SerialPort() : wake_fd_(eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {}

SerialPort::~SerialPort() {
  close();
  if (wake_fd_ >= 0) ::close(wake_fd_);
}

std::string SerialPort::open(const std::string& path, int baud_bps) {
  close();
  path_ = path;
  // Without O_NONBLOCK, open() may wait for a modem's carrier.
  fd_ = ::open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (fd_ < 0) return failed(deviceErrorText(errno, kSerialPorts));
  std::string why;
  if (isatty(fd_) == 0) {
    why = failed(deviceErrorText(ENOTTY, kSerialPorts));
  } else if (flock(fd_, LOCK_EX | LOCK_NB) != 0) {
    why = failed(deviceErrorText(errno == EWOULDBLOCK ? EBUSY : errno, kSerialPorts));
  } else if (ioctl(fd_, TIOCEXCL) != 0) {
    why = failed(std::strerror(errno));
  } else {
    why = configure(baud_bps);
  }
  if (!why.empty()) close();
  return why;
}

std::string SerialPort::configure(int baud_bps) {
  const auto* rate = findRate(baud_bps);
  if (rate == nullptr) return failed("a rate of " + std::to_string(baud_bps) + " bit/s is not possible");
  termios line{};
  if (tcgetattr(fd_, &line) != 0) return failed(std::strerror(errno));
  cfmakeraw(&line);
  line.c_cflag &= ~static_cast<tcflag_t>(CSTOPB | CRTSCTS);
  line.c_cflag |= CLOCAL | CREAD;
  // So that a line without bytes gives EAGAIN, and 0 is the end of the line.
  line.c_cc[VMIN] = 1;
  line.c_cc[VTIME] = 0;
  cfsetispeed(&line, rate->second);
  cfsetospeed(&line, rate->second);
  if (tcsetattr(fd_, TCSANOW, &line) != 0) return failed(std::strerror(errno));
  // tcsetattr succeeds after any partial change.
  termios now{};
  if (tcgetattr(fd_, &now) != 0 || cfgetospeed(&now) != rate->second) {
    return failed("does not take a rate of " + std::to_string(baud_bps) + " bit/s");
  }
  tcflush(fd_, TCIOFLUSH);
  return {};
}

std::string SerialPort::setBaud(int baud_bps) {
  return isOpen() ? configure(baud_bps) : failed("not open");
}

void SerialPort::close() {
  if (fd_ < 0) return;
  // A pseudo terminal would stay exclusive for as long as its other side lives.
  ioctl(fd_, TIOCNXCL);
  ::close(fd_);
  fd_ = -1;
}

SerialPort::Input SerialPort::read(Clock::time_point deadline) {
  Input input;
  const auto gone = [&](const std::string& what) {
    input.kind = Input::Kind::kGone;
    input.why = failed(what);
    return input;
  };
  if (!isOpen()) return gone("not open");
  while (true) {
    std::array<pollfd, 2> waits{{{fd_, POLLIN, 0}, {wake_fd_, POLLIN, 0}}};
    const int ready = poll(waits.data(), waits.size(), millisecondsUntil(deadline));
    if (ready < 0 && errno != EINTR) return gone(std::strerror(errno));
    if (ready == 0 && Clock::now() >= deadline) return input;
    if (ready <= 0) continue;
    if (waits[0].revents != 0) {
      std::array<std::uint8_t, 1024> buffer;
      const ssize_t got = ::read(fd_, buffer.data(), buffer.size());
      if (got > 0) {
        input.kind = Input::Kind::kBytes;
        input.bytes.assign(buffer.begin(), buffer.begin() + got);
        return input;
      }
      // A line that hung up gives EIO or an end of file, an adapter that was pulled out ENODEV or EIO.
      if (got == 0 || (errno != EAGAIN && errno != EINTR)) return gone("hung up (unplugged?)");
      if ((waits[0].revents & (POLLERR | POLLHUP | POLLNVAL)) != 0) return gone("hung up (unplugged?)");
    }
    if (waits[1].revents != 0) {
      std::uint64_t count = 0;
      static_cast<void>(::read(wake_fd_, &count, sizeof count) == 0);
      input.kind = Input::Kind::kWoken;
      return input;
    }
  }
}

std::string SerialPort::write(std::span<const std::uint8_t> bytes, Clock::time_point deadline) {
  if (!isOpen()) return failed("not open");
  while (!bytes.empty()) {
    const ssize_t put = ::write(fd_, bytes.data(), bytes.size());
    if (put > 0) {
      bytes = bytes.subspan(static_cast<std::size_t>(put));
      continue;
    }
    if (put < 0 && errno == EINTR) continue;
    if (put < 0 && errno != EAGAIN) return failed("hung up (unplugged?)");
    if (Clock::now() >= deadline) return failed("takes no bytes");
    pollfd wait{fd_, POLLOUT, 0};
    if (poll(&wait, 1, millisecondsUntil(deadline)) > 0 && (wait.revents & (POLLERR | POLLHUP)) != 0) {
      return failed("hung up (unplugged?)");
    }
  }
  return {};
}

void SerialPort::wake() {
  const std::uint64_t one = 1;
  static_cast<void>(::write(wake_fd_, &one, sizeof one) == 0);
}

}  // namespace vismem
