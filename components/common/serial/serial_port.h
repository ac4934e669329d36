/// @file A serial line (RS-232, a USB adapter, a pseudo terminal) in raw mode: 8 data bits, no parity, one
/// stop bit, no flow control. Failures are returned as messages for people, never thrown.
#pragma once

#include <chrono>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace vismem {

/// Invariant: an open port belongs to this process alone, as far as other programs respect flock or TIOCEXCL.
/// *Single-threaded* (owner: the driver's thread), but for wake().
class SerialPort {
 public:
  using Clock = std::chrono::steady_clock;

  /// Result of read().
  struct Input {
    enum class Kind {
      kBytes,
      kNothing,  ///< no byte until the deadline
      kWoken,    ///< by wake()
      kGone,     ///< unplugged, hung up, or not open; `why` has the reason; open() it again
    };
    Kind kind = Kind::kNothing;
    std::vector<std::uint8_t> bytes;
    std::string why;
  };

  SerialPort();
  ~SerialPort();
  SerialPort(const SerialPort&) = delete;
  SerialPort& operator=(const SerialPort&) = delete;

  /// Opens the port exclusively, after closing an open one.
  /// @param path such as "/dev/ttyUSB0"; symbolic links are followed.
  /// @param baud_bps a rate of termios [bit/s]: 50 ... 4000000.
  /// @return empty, or the reason of the failure: "/dev/ttyUSB0: no such device", "... no permission ...",
  /// "... another program uses it", "... not a serial port".
  std::string open(const std::string& path, int baud_bps);
  /// Changes the rate; bytes in both buffers are dropped.
  /// @return empty, or the reason of the failure.
  std::string setBaud(int baud_bps);
  bool isOpen() const { return fd_ >= 0; }
  void close();

  /// Reads the received bytes; waits for the first one until the deadline.
  Input read(Clock::time_point deadline);
  /// Writes all bytes; after a failure some may not have reached the device.
  /// @return empty, or the reason of the failure: "... hung up", "... takes no bytes".
  std::string write(std::span<const std::uint8_t> bytes, Clock::time_point deadline);

  /// Ends a waiting read(), or the next one, at once. Any thread.
  void wake();

 private:
  std::string failed(const std::string& what) const { return path_ + ": " + what; }
  std::string configure(int baud_bps);

  std::string path_;
  int fd_ = -1;
  int wake_fd_ = -1;
};

/// @return whether termios has this rate [bit/s].
bool isBaudRate(int baud_bps);

}  // namespace vismem
