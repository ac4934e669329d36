/// @file Where a replay stands: the map from a clock to the stamps of a log. Pure.
#pragma once

#include <cstdint>
#include <optional>

#include "common/robot/control_ports.h"

namespace vismem {

/// `now_us` is any clock that does not go back, in microseconds; it is passed in with every call.
/// Invariant: the position lies within [begin, end]. *Single-threaded.*
class ReplayTimeline {
 public:
  /// @param begin_us, end_us stamps between which the log is played, begin <= end.
  /// @param state kWaiting, kPlaying or kPaused: how it starts at `now_us`.
  ReplayTimeline(StampUs begin_us, StampUs end_us, double rate, bool loop, ReplayState state, StampUs now_us);

  /// Follows the clock: to be called before the position is read. Passing the end with `loop` goes on at the
  /// beginning (jumps() counts), otherwise the state becomes kFinished.
  void update(StampUs now_us);

  /// From kFinished it begins again.
  void play(StampUs now_us);
  void pause(StampUs now_us);
  /// @return the stamp reached: the asked one brought inside the log. A finished replay plays on from there.
  StampUs seek(StampUs stamp_us, StampUs now_us);
  void setRate(double rate, StampUs now_us);
  void setLoop(bool loop, StampUs now_us);

  ReplayState state() const { return state_; }
  StampUs position() const { return position_us_; }
  double rate() const { return rate_; }
  bool loop() const { return loop_; }
  /// Counts seeks and loops.
  std::uint32_t jumps() const { return jumps_; }
  /// Where the replay began, or went on after the last jump.
  StampUs segmentBegin() const { return segment_begin_us_; }

  /// When the clock must stand for the position to be `stamp_us`; empty while it does not play, or when the
  /// stamp is past.
  std::optional<StampUs> clockAt(StampUs stamp_us) const;

 private:
  void anchor(StampUs now_us);
  void jump(StampUs stamp_us);

  StampUs begin_us_;
  StampUs end_us_;
  double rate_;
  bool loop_;
  ReplayState state_;
  StampUs position_us_;
  StampUs segment_begin_us_;
  /// The position was anchor_position_us_ when the clock stood at anchor_clock_us_.
  StampUs anchor_clock_us_;
  StampUs anchor_position_us_;
  std::uint32_t jumps_ = 0;
};

}  // namespace vismem
