/// @file A camera whose pictures are files or a stream. SPEC C1.
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

/// Gives the pictures of a source at their pace, the newest if the consumer is slow, as a camera does. One
/// thread of its own reads; it is there from start() to stop(). What is not there yet, or goes away, is
/// waited for; a picture that cannot be read is named in the message of the next frame and passed over.
///
/// Stamps: of kHost the host's CLOCK_REALTIME when a picture fell due or arrived; of kOwn the source's time
/// line (stamp file, position in a video, else number over rate from 0), which goes on over a loop. Streams
/// have kHost only.
/// Size: pictures are scaled to the size asked for if their shape allows, else to the largest of their shape
/// inside it ("adjusted"). All of a session have one size: others are scaled if of the same shape, else lost.
/// Lens: unknown; frames carry the nominal one of kNominalView_deg until somebody knows better.
///
/// *Thread-safe*: one consumer, and stop() from any thread ends its wait. The destructor waits for a stream
/// that is being opened or read: its time-outs at most.
class FileCamera : public FrameSource {
 public:
  enum class Stamps { kHost, kOwn };
  struct Params {
    Stamps stamps = Stamps::kHost;
    bool loop = true;
    /// Of pictures without a time line of their own, unless a rate is asked for.
    double default_rate_hz = 10.0;
    /// Between two tries to open what is away; doubles with every failure.
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
  /// Looks at the first picture of files, to answer truly. Rejected while running.
  PortReply configure(const FrameRequest& request) override;
  /// Accepted also when there is nothing yet.
  PortReply start() override;
  FrameResult next(std::chrono::milliseconds timeout) override;
  /// Returns at once; a stream that is just being opened or read is left to its time-outs.
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

/// The size of pictures of one size when another is asked for; sides of 0 are left open.
cv::Size fittingSize(cv::Size own, cv::Size asked);

/// The driver "files": keys Source (folder, image, video, or an address such as rtsp://...), Loop, Stamps
/// (host, own), OpenTimeout_s, ReadTimeout_s.
std::unique_ptr<FrameSource> makeFileCamera(ConfigReader& group);

}  // namespace vismem
