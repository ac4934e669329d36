/// @file A session with a Pioneer robot over a serial line: from the handshake to the last packet.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/serial/serial_port.h"
#include "drivers/pioneer_p2os/p2os_codec.h"

namespace vismem::p2os {

/// *Single-threaded* (owner: the driver's thread), but for wake().
class Link {
 public:
  using Clock = SerialPort::Clock;

  struct Received {
    std::optional<Bytes> data;  ///< of a packet
    std::string lost;           ///< reason why the line is lost; empty otherwise
  };

  /// @param bauds_bps baud rates in the order of trial; the last successful one is tried first [bit/s].
  Link(std::string path, std::vector<int> bauds_bps);

  /// Opens the port and begins a session. A session of an earlier program is closed after its speeds were set
  /// to 0, because a robot that its watchdog has stopped resumes its last speed with any next packet.
  /// @param given_up called between steps.
  /// @return empty after the robot's identity was received, else the reason of the failure.
  std::string connect(const std::function<bool()>& given_up);
  const Identity& identity() const { return identity_; }
  /// Baud rate in use; the first of the list before connect().
  int baud_bps() const { return bauds_bps_.front(); }

  /// Sends speeds of 0, ends the session and closes the port.
  void disconnect();
  /// Closes the port without ending the session.
  void drop() { port_.close(); }

  /// @return empty, or the reason why the line is lost.
  std::string send(const Bytes& packet);
  /// Sends a stop command.
  std::string sendHalt();
  /// The next packet; none at the deadline, and after wake().
  Received receive(Clock::time_point deadline);
  void wake() { port_.wake(); }

 private:
  enum class Answer { kSession, kOldSession, kGarbage, kNothing };
  /// @param why set when the line is lost.
  Answer handshake(const std::function<bool()>& given_up, std::string& why);
  void readUntilQuiet();

  const std::string path_;
  std::vector<int> bauds_bps_;
  SerialPort port_;
  PacketReader reader_;
  Identity identity_;
};

}  // namespace vismem::p2os
