/// @file A camera with images from files or a stream. See C1.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "common/config/config_reader.h"
#include "common/drivers/driver_registry.h"
#include "common/robot/ports.h"
#include "drivers/camera_files/picture_source.h"

namespace vismem {

/// Delivers the images of a source at their rate, the newest to a slow consumer, as a camera does. A thread
/// of its own reads from start() to stop(). It waits for an absent source. An unreadable image is skipped and
/// named in the message of the next frame.
///
/// Stamps of kHost: the host's CLOCK_REALTIME when an image was due or arrived. Stamps of kOwn: the source's
/// time line (stamp file, position in a video, else number over rate from 0), which continues over a loop.
/// Streams have kHost only. Size: images are scaled to the requested size if the aspect ratio fits, else to
/// the largest size of their own aspect ratio inside it ("adjusted"). All images of a session have one size:
/// others are scaled if of the same aspect ratio, else lost. Lens: unknown; frames carry a nominal field of
/// view of kNominalView_deg until a calibration replaces it.
///
/// *Thread-safe*: one consumer, and stop() from any thread ends its wait. The destructor waits for a stream
/// that is being opened or read: its time-outs at most.
class FileCamera : public FrameSource {
 public:
  enum class Stamps { kHost, kOwn };
  struct Params {
    Stamps stamps = Stamps::kHost;
    bool loop = true;
    /// Rate of images without a time line of their own, unless a rate is requested [Hz].
    double default_rate_hz = 10.0;
    /// Pause between attempts to open an absent source; doubles with every failure.
    std::chrono::milliseconds first_pause{100};
    std::chrono::milliseconds longest_pause{1000};
  };
  using MakeSource = std::function<std::unique_ptr<PictureSource>()>;
  static constexpr double kNominalView_deg = 60.0;
  static constexpr double kMaxRate_hz = 1000.0;

  FileCamera(MakeSource make_source, const Params& params);
  ~FileCamera() override;
  FileCamera(const FileCamera&) = delete;
  FileCamera& operator=(const FileCamera&) = delete;

  /// Size and rate are 0 until they are known.
  FrameCapabilities capabilities() const override;
  /// Reads the first image of files for its size. Rejected while running.
  PortReply configure(const FrameRequest& request) override;
  /// Accepted also for an absent source.
  PortReply start() override;
  FrameResult next(std::chrono::milliseconds timeout) override;
  /// Returns at once; a stream that is being opened or read ends after its time-outs.
  void stop() override;

 private:
  class Session;

  const MakeSource make_source_;
  const Params params_;
  const std::string name_;
  const bool live_;

  mutable std::mutex mutex_;
  FrameRequest request_;
  FrameCapabilities known_;
  std::shared_ptr<Session> session_;              ///< null unless started
  std::vector<std::shared_ptr<Session>> ending_;  ///< stopped, their threads may not have ended yet
  std::uint64_t last_seq_ = 0;
  StampUs last_stamp_us_ = 0;
};

/// The size for a request of another size; sides of 0 are free.
cv::Size fittingSize(cv::Size own, cv::Size asked);

/// The driver "files": keys Source (folder, image, video, or an address such as rtsp://...), Loop, Stamps
/// (host, own), OpenTimeout_s, ReadTimeout_s.
std::unique_ptr<FrameSource> makeFileCamera(ConfigReader& group);

}  // namespace vismem
