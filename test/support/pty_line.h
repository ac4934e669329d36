/// @file The device's end of a serial line: a pseudo terminal that can be pulled out and put back.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "support/temporary_folder.h"

namespace vismem {

/// A driver opens path(), which stays the same. *Single-threaded*.
class PtyLine {
 public:
  PtyLine() { plugIn(); }
  ~PtyLine() { unplug(); }

  const std::string& path() const { return path_; }
  void plugIn();
  /// Hangs up; path() is gone.
  void unplug();

  /// Bytes received within this time; empty when unplugged.
  std::vector<std::uint8_t> read(int timeout_ms);
  /// No effect when unplugged, or without a reader.
  void write(std::span<const std::uint8_t> bytes);
  /// Baud rate of the driver's end.
  int baud_bps() const;

 private:
  TemporaryFolder folder_;
  const std::string path_ = folder_ / "ttyTEST0";
  int device_ = -1;  ///< the terminal's master
  int line_ = -1;    ///< the driver's end, held open so that the line stays up between two drivers
};

}  // namespace vismem
