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
    std::string lost;           ///< why there will be no more; empty while all is well
  };

  /// @param bauds_bps tried in this order, the one that worked last first.
  Link(std::string path, std::vector<int> bauds_bps);

  /// Opens the port and begins a session. Whatever session a program before this one has left is closed,
  /// after its speeds were set to 0: for a robot whose watchdog has stopped it goes on at its last speed with
  /// the next packet, whichever that is. @param given_up is asked between steps. @return empty when the robot
  /// has told its identity, else why not.
  std::string connect(const std::function<bool()>& given_up);
  const Identity& identity() const { return identity_; }
  /// In use; the first of the list before connect().
  int baud_bps() const { return bauds_bps_.front(); }

  /// Sends speeds of 0, ends the session and closes the port.
  void disconnect();
  /// Closes the port as it is.
  void drop() { port_.close(); }

  /// @return empty, or why the line is lost.
  std::string send(const Bytes& packet);
  /// Sends that the robot shall stand, whatever it was told before.
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
