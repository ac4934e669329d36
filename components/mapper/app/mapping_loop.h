/// @file The thread that records a live drive: updates of the memory, each with its image. No Ice: any
/// implementation of the ports will do. See B6, C3.
#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>

#include "common/process/status.h"
#include "common/robot/ports.h"
#include "common/visual_memory/memory_snapshot.h"
#include "mapper/core/drive_collector.h"
#include "mapper/core/mapper_status.h"

namespace vismem {

/// The newest images, to be found by their stamps. *Thread-safe.*
class RecentFrames {
 public:
  explicit RecentFrames(std::size_t most) : most_(most) {}

  void add(Frame frame);
  /// Waits until this or a newer image has come, at most `timeout`.
  /// @return an empty image with that stamp when this one was missed.
  Frame at(StampUs stamp_us, std::chrono::milliseconds timeout);

 private:
  const std::size_t most_;
  std::mutex mutex_;
  std::condition_variable came_;
  std::deque<Frame> frames_;  ///< oldest first
};

/// *Thread-safe*; sources and status must outlive it.
class MappingLoop {
 public:
  struct Params {
    KeyframeParams keyframes;
    double range_m = 0.0;  ///< as of searchedPart()
    /// A longer drive ends here: its map would take minutes, and the process must not grow for ever.
    int most_keyframes = 40'000;
  };
  using Failed = std::function<void(std::exception_ptr)>;
  /// Called by the loop's thread, twice a second.
  using Watch = std::function<void(const DriveProgress&)>;

  MappingLoop(const Params& params, VisualMemorySource& memory, FrameSource& camera, StatusBoard& status);
  ~MappingLoop() { stop(); }

  void start(Watch watch, Failed failed);
  void stop();

  DriveProgress progress() const;
  /// A copy of the drive so far.
  DriveCollector drive() const;
  /// Drops what was recorded.
  void restart();

 private:
  void readCamera(const std::stop_token& stop);
  void run(const std::stop_token& stop);
  void add(const MemoryUpdate& update);
  void report(const MemoryResult& result);

  const Params params_;
  VisualMemorySource& memory_;
  FrameSource& camera_;
  StatusBoard& status_;
  Watch watch_;
  Failed failed_;
  RecentFrames frames_;
  mutable std::mutex mutex_;
  PublishedElements elements_;
  DriveCollector drive_;
  DriveProgress progress_;
  std::jthread camera_thread_;
  std::jthread thread_;  ///< last member: both use all of the above
};

}  // namespace vismem
