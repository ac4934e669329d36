/// @file Real-time replay of a log for the ports of a process: frames, joints and odometry are delivered at
/// their stamps.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>

#include "common/recording/robot_log.h"
#include "common/robot/control_ports.h"
#include "replay_server/core/replay_timeline.h"

namespace vismem {

/// The clock of a replay; tests have their own.
class PacingClock {
 public:
  virtual ~PacingClock() = default;
  /// [us], never goes back.
  virtual StampUs now() const = 0;
  /// Waits until a time, or until woken.
  virtual void waitUntil(std::unique_lock<std::mutex>& lock, std::condition_variable& wake,
                         StampUs until_us) = 0;
};

/// std::chrono::steady_clock.
class SteadyPacingClock : public PacingClock {
 public:
  StampUs now() const override;
  void waitUntil(std::unique_lock<std::mutex>& lock, std::condition_variable& wake,
                 StampUs until_us) override;
};

/// *Thread-safe*, except that each port has one consumer. Its time runs from the first image to the last,
/// and on until odometry and joints cover that. Nothing is resampled; commands are taken and ignored.
class LogPlayer : public ReplayControl {
 public:
  struct Params {
    double rate = 1.0;
    bool loop = false;
    ReplayState start = ReplayState::kWaiting;  ///< kWaiting, kPlaying or kPaused
  };

  /// @param clock must outlive the player.
  LogPlayer(RobotLog log, const Params& params, PacingClock& clock);
  ~LogPlayer() override;

  /// Reports a consumer of the camera: starts a replay that waits for one.
  void consumerArrived();
  /// Ends all waits now and from now on.
  void shutDown();

  /// The newest due frame, never the same one twice. After a seek, the frame at or before the stamp. Sequence
  /// numbers continue over loops and seeks. After a jump the other ports begin anew with what that frame
  /// needs, whatever stamp their reader asks from.
  FrameSource& camera();
  PanTiltUnit& panTilt();
  MobileBase& base();
  const RobotLog& log() const { return log_; }

  ReplayStatus status() const override;
  PortReply play() override;
  PortReply pause() override;
  PortReply seek(StampUs stamp_us) override;
  PortReply setRate(double rate) override;
  PortReply setLoop(bool loop) override;
  PortReply step(int images) override;
  PortReply setPlayLength(StampUs length_us) override;
  PortReply setRange(StampUs begin_us, StampUs end_us) override;
  ReplayContents contents() const override;

 private:
  class CameraPort;
  class PanTiltPort;
  class BasePort;

  FrameResult nextFrame(const bool& stopped, std::chrono::milliseconds timeout);
  /// The consumer of joints or odometry.
  struct SampleReader {
    bool stopped = false;
    std::uint32_t jumps = 0;  ///< of the timeline, that it knows of
  };
  template <typename Sample>
  SampleBatch<Sample> samplesSince(const std::vector<Sample>& samples, SampleReader& reader, StampUs after_us,
                                   std::chrono::milliseconds timeout);
  void setStopped(bool& stopped, bool value);
  void updateLocked() const;
  /// Waits for the stamp (if given), the deadline or a change.
  /// @return false at the deadline.
  bool waitLocked(std::unique_lock<std::mutex>& lock, std::optional<StampUs> stamp_us, StampUs deadline_us);
  std::string whyNothing() const;

  const RobotLog log_;
  PacingClock& clock_;
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  mutable ReplayTimeline timeline_;
  /// First undelivered frame, after the jump numbered seen_jumps_.
  std::size_t next_frame_ = 0;
  std::uint32_t seen_jumps_ = 0;
  std::uint64_t seq_offset_ = 0;
  bool shut_down_ = false;
  bool native_ = false;  ///< whether the camera's consumer takes pictures as they were captured
  std::unique_ptr<CameraPort> camera_;
  std::unique_ptr<PanTiltPort> pan_tilt_;
  std::unique_ptr<BasePort> base_;
};

}  // namespace vismem
