/// @file The buffers that a camera fills, in memory shared with the kernel.
#pragma once

#include <chrono>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "common/v4l2/v4l2_device.h"

namespace vismem::v4l2 {

/// *Single-threaded.* Streams from begin() to end(); the device must be open so long.
class FrameBuffers {
 public:
  struct Filled {
    unsigned index = 0;
    std::span<const std::uint8_t> bytes;
    std::uint32_t sequence = 0;     ///< of the camera; gaps are images that were not read in time
    std::int64_t monotonic_us = 0;  ///< by CLOCK_MONOTONIC; 0 if the kernel's stamp is of no known clock
    bool damaged = false;
  };
  enum class Taken { kFrame, kNone, kLost };

  explicit FrameBuffers(const V4l2Device& device) : device_(device) {}
  ~FrameBuffers() { end(); }
  FrameBuffers(const FrameBuffers&) = delete;
  FrameBuffers& operator=(const FrameBuffers&) = delete;

  /// @return empty, or the reason of the failure.
  std::string begin();
  void end();
  /// The oldest filled buffer, to be returned to the camera. kLost: the stream has ended, with the reason in
  /// `why`.
  Taken take(Filled& filled, std::string& why);
  std::string giveBack(const Filled& filled);

 private:
  struct Memory {
    void* begin = nullptr;
    std::size_t bytes = 0;
  };
  std::string lost(const std::string& what, int error) const;
  std::string queue(unsigned index);

  const V4l2Device& device_;
  std::vector<Memory> memory_;
};

}  // namespace vismem::v4l2
