/// @file A serial line (RS-232, a USB adapter, a pseudo terminal) in raw mode: 8 data bits, no parity, one
/// stop bit, no flow control. Failures are returned with words for people, never thrown.
#pragma once

#include <chrono>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace vismem {

/// Invariant: an open port is this process's alone, as far as other programs keep to flock or TIOCEXCL.
/// *Single-threaded* (owner: the driver's thread), but for wake().
class SerialPort {
 public:
  using Clock = std::chrono::steady_clock;

  /// What read() came back with.
  struct Input {
    enum class Kind {
      kBytes,
      kNothing,  ///< until the deadline
      kWoken,    ///< by wake()
      kGone,     ///< unplugged, hung up, or not open; `why` says so and the port wants to be opened anew
    };
    Kind kind = Kind::kNothing;
    std::vector<std::uint8_t> bytes;
    std::string why;
  };

  SerialPort();
  ~SerialPort();
  SerialPort(const SerialPort&) = delete;
  SerialPort& operator=(const SerialPort&) = delete;

  /// Opens and takes the port; one that was open is closed first. @param path as "/dev/ttyUSB0", which a
  /// symbolic link may be. @param baud_bps as termios has it: 50 ... 4000000. @return empty, or why not:
  /// "/dev/ttyUSB0: no such device", "... no permission ...", "... another program uses it", "... not a
  /// serial port".
  std::string open(const std::string& path, int baud_bps);
  /// What was sent and received before is dropped. @return empty, or why not.
  std::string setBaud(int baud_bps);
  bool isOpen() const { return fd_ >= 0; }
  void close();

  /// Whatever has come, waiting for the first byte until the deadline.
  Input read(Clock::time_point deadline);
  /// All of it, or none of it has reached the device for certain. @return empty, or why not: "... hung up",
  /// "... takes no bytes".
  std::string write(std::span<const std::uint8_t> bytes, Clock::time_point deadline);
  /// Drops what has come and was not read.
  void discardInput();

  /// Ends a read() that waits, or the next one, at once. Any thread.
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
