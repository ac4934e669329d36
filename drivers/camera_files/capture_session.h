/// @file One session of a file camera, from start() to stop(): its reading thread and the newest frame.
#pragma once

#include <atomic>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "drivers/camera_files/file_camera.h"

namespace vismem {

/// *Thread-safe*. Its thread begins with the object and ends soon after stop(); the destructor waits for it.
class FileCamera::Session {
 public:
  struct Begin {
    std::uint64_t seq = 0;  ///< of the last frame before this session
    StampUs stamp_us = 0;   ///< of that frame; 0: there was none
  };

  Session(std::unique_ptr<PictureSource> source, const Params& params, const FrameRequest& request,
          const Begin& begin);
  ~Session();

  FrameResult next(std::chrono::milliseconds timeout);
  void stop();
  bool hasEnded() const { return ended_; }
  /// Known size and rate.
  FrameCapabilities known() const;
  Begin reached() const;

 private:
  using Clock = std::chrono::steady_clock;

  void run(const std::stop_token& stop);
  /// One pass through the source.
  /// @return false if the camera is at its end.
  bool playOnce(const std::stop_token& stop);
  /// Waits until the image is due.
  /// @return false after a stop request.
  bool awaitDue(const Picture& picture, const std::stop_token& stop);
  void deliver(Picture picture);
  std::optional<Frame> frameOf(Picture& picture, std::string& problem);
  StampUs stampOf(const Picture& picture);
  StampUs period_us() const;
  void lose(const std::string& what);
  void away(const std::string& why, const std::stop_token& stop);
  /// @return false after a stop request.
  bool pauseUntil(Clock::time_point until, const std::stop_token& stop);

  const std::unique_ptr<PictureSource> source_;
  const Params params_;
  const FrameRequest request_;
  const Begin begin_;

  // Of the thread.
  cv::Size size_;  ///< of all frames; empty before the first picture
  std::chrono::milliseconds pause_;
  double rate_hz_ = 0.0;  ///< rate for a source without a rate of its own
  bool own_pace_ = false;
  std::int64_t in_pass_ = 0;  ///< pictures so far
  Clock::time_point due_;     ///< of the last picture
  std::optional<StampUs> last_own_us_;
  StampUs own_offset_us_ = 0;
  std::string losing_;  ///< since the last frame

  mutable std::mutex mutex_;
  std::condition_variable_any wake_;  ///< the thread's pauses
  std::condition_variable changed_;   ///< for the consumer
  std::optional<Frame> frame_;        ///< the newest, not yet taken
  std::string lost_;                  ///< losses before it
  std::string why_;                   ///< reason why there are no frames; empty: none
  bool finished_ = false;
  bool stopped_ = false;
  FrameCapabilities known_;
  Begin reached_;
  std::atomic<bool> ended_ = false;
  std::jthread thread_;  ///< last member: ends before the rest goes
};

}  // namespace vismem
