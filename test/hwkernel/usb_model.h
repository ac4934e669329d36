/// @file A USB device in software, for the kernel's virtual host (vhci).
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace vismem {

/// The requests of the host on a device's control pipe and bulk pipe. *Single-threaded*.
class UsbModel {
 public:
  using Clock = std::chrono::steady_clock;
  using Setup = std::array<std::uint8_t, 8>;
  struct Answer {
    int status = 0;  ///< 0 or a negative errno
    std::vector<std::uint8_t> data;
  };

  virtual ~UsbModel() = default;
  /// @param data that came with a request to the device.
  virtual Answer control(const Setup& setup, std::span<const std::uint8_t> data) = 0;
  /// Bytes for a bulk transfer from the device, at most so many; empty: not yet.
  virtual std::optional<std::vector<std::uint8_t>> bulkIn(std::size_t) { return std::nullopt; }
  virtual bool isHighSpeed() const = 0;
  /// Its state in one line: written to a file at every change.
  virtual std::string state() = 0;
};

/// Connects it to a port of the virtual host and serves it until the kernel releases it or this process ends,
/// which unplugs it.
/// @throw std::runtime_error if there is no such host.
void serveOnVhci(UsbModel& model, int port, const std::string& state_file);

}  // namespace vismem
