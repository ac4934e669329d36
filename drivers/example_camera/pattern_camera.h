/// @file A camera that draws its images: the worked example of docs/writing-a-driver.md, and a substitute for
/// a device. Its name says that it is simulated.
#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>

#include "common/config/config_reader.h"
#include "common/robot/ports.h"

namespace vismem {

/// A bright bar that moves over a grey ramp. Images are due at whole periods from start(); each is stamped
/// with the host's CLOCK_REALTIME of its due time. *Thread-safe*: one consumer, and stop() from any thread
/// ends its wait.
class PatternCamera : public FrameSource {
 public:
  static constexpr int kMinSide_px = 16;
  static constexpr int kMaxSide_px = 4096;
  static constexpr double kMinRate_hz = 0.01;
  static constexpr double kMaxRate_hz = 200.0;
  /// Field of view of the drawing.
  static constexpr double kHorizontalView_deg = 60.0;

  /// @param bars 2..64 places for the bar, from left to right.
  explicit PatternCamera(int bars);

  FrameCapabilities capabilities() const override;
  /// Any size and rate within the limits; others are clamped to them ("adjusted").
  PortReply configure(const FrameRequest& request) override;
  PortReply start() override;
  FrameResult next(std::chrono::milliseconds timeout) override;
  void stop() override;

 private:
  using Clock = std::chrono::steady_clock;

  Frame draw(std::int64_t number) const;

  const int bars_;

  mutable std::mutex mutex_;
  std::condition_variable stopped_;
  int width_ = 320;
  int height_ = 240;
  double rate_hz_ = 30.0;
  bool running_ = false;
  Clock::time_point begin_;
  StampUs begin_us_ = 0;     ///< host's real time at begin_
  std::int64_t given_ = -1;  ///< number of the last picture given since start()
  std::uint64_t seq_base_ = 1;
};

/// The driver "pattern": key Bars.
std::unique_ptr<FrameSource> makePatternCamera(ConfigReader& group);

}  // namespace vismem
