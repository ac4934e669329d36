/// @file A camera of the Linux kernel (V4L2), such as a USB camera. See C1.
#pragma once

#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "common/config/config_reader.h"
#include "common/drivers/device_thread.h"
#include "common/drivers/driver_registry.h"
#include "common/robot/ports.h"
#include "common/v4l2/v4l2_controls.h"
#include "common/v4l2/v4l2_device.h"
#include "drivers/camera_v4l2/frame_buffers.h"
#include "drivers/camera_v4l2/negotiation.h"

namespace vismem {

/// A thread reads the images at their arrival. next() returns the newest and decodes only that one, unless
/// the consumer accepts the native format. An absent, unplugged or silent camera is opened again until it
/// delivers. Stamps: the kernel's (CLOCK_MONOTONIC) as CLOCK_REALTIME, less `delay`. Lens: unknown; frames
/// carry a nominal field of view of kNominalView_deg until a calibration replaces it. *Thread-safe*: one
/// consumer, and stop() from any thread ends its wait.
class V4l2Camera : public FrameSource {
 public:
  struct Params {
    std::string device;
    const v4l2::PixelFormat* format = nullptr;  ///< nullptr: the best one
    std::vector<ControlSetting> controls;
    std::chrono::microseconds delay{0};
    /// The camera is opened again after this time without an image, or after five periods if that is longer.
    std::chrono::milliseconds silent_after{3000};
  };
  static constexpr double kNominalView_deg = 60.0;

  explicit V4l2Camera(const Params& params);
  ~V4l2Camera() override;

  FrameCapabilities capabilities() const override;
  /// Opens a present camera for its actual mode; the mode of an absent one is unknown ("adjusted"). Rejected
  /// while running, and if the camera does not have the configured format.
  PortReply configure(const FrameRequest& request) override;
  PortReply start() override;
  FrameResult next(std::chrono::milliseconds timeout) override;
  void stop() override;

 private:
  using Clock = V4l2Device::Clock;

  std::string session(const std::stop_token& stop);
  std::string stream(const std::stop_token& stop, const v4l2::Agreement& agreed);
  void deliver(const v4l2::FrameBuffers::Filled& filled, const v4l2::Agreement& agreed);
  StampUs stampLocked(std::int64_t monotonic_us) const;
  void learn(const V4l2Device& device, const v4l2::Agreement& agreed);

  const Params params_;
  V4l2Device device_;  ///< of the thread

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  FrameRequest request_;
  FrameCapabilities known_;
  struct Newest {
    StampUs stamp_us = 0;
    std::uint64_t seq = 0;
    std::shared_ptr<const NativeImage> picture;
  };
  std::optional<Newest> newest_;  ///< not yet taken
  std::string lost_;              ///< before it
  std::string losing_;            ///< since it
  StampUs last_stamp_us_ = 0;
  std::uint64_t last_seq_ = 0;
  std::optional<std::uint32_t> last_sequence_;  ///< of the camera, in this session
  bool running_ = false;

  DeviceThread thread_;  ///< last: ends before the rest goes
};

/// The driver "v4l2": keys Device, Format, Control.NAME, Delay_ms (README).
std::unique_ptr<FrameSource> makeV4l2Camera(ConfigReader& group);

}  // namespace vismem
