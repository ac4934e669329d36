/// @file A camera whose image has one brightness: the place of a real device. docs/writing-a-driver.md has the
/// rules of the port.
#pragma once

#include <common/config/config_reader.h>
#include <common/robot/ports.h>

#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>

/// *Thread-safe*: one consumer; stop() from any thread ends its wait.
class TemplateCamera : public vismem::FrameSource {
 public:
  explicit TemplateCamera(int brightness) : brightness_(brightness) {}

  vismem::FrameCapabilities capabilities() const override;
  vismem::PortReply configure(const vismem::FrameRequest& request) override;
  vismem::PortReply start() override;
  vismem::FrameResult next(std::chrono::milliseconds timeout) override;
  void stop() override;

 private:
  using Clock = std::chrono::steady_clock;
  /// What this camera can do, whatever is asked.
  static constexpr int kWidth = 320;
  static constexpr int kHeight = 240;
  static constexpr double kRate_hz = 20.0;
  static constexpr std::chrono::milliseconds kPeriod{50};

  const int brightness_;
  std::mutex mutex_;
  std::condition_variable stopped_;
  bool running_ = false;
  Clock::time_point due_;
  std::uint64_t seq_ = 0;
};

/// Reads the driver's keys: Brightness. Opens no device.
std::unique_ptr<vismem::FrameSource> makeTemplateCamera(vismem::ConfigReader& group);
