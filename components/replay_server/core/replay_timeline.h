/// @file Position of a replay: the map from a clock to the stamps of a log. Pure.
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
  /// @param state initial state at `now_us`: kWaiting, kPlaying or kPaused.
  ReplayTimeline(StampUs begin_us, StampUs end_us, double rate, bool loop, ReplayState state, StampUs now_us);

  /// Advances the position to the clock; to be called before the position is read. At the end it restarts
  /// with `loop` (a jump), otherwise the state becomes kFinished.
  void update(StampUs now_us);

  /// Plays; restarts at the beginning from kFinished.
  void play(StampUs now_us);
  void pause(StampUs now_us);
  /// @return the requested stamp, clamped to the log. A finished replay continues to play from there.
  StampUs seek(StampUs stamp_us, StampUs now_us);
  void setRate(double rate, StampUs now_us);
  void setLoop(bool loop, StampUs now_us);
  /// Plays go on for so long and then pause; 0: to the end.
  void setPlayLength(StampUs length_us) { play_length_us_ = length_us; }
  /// Plays between other stamps; a position outside them is brought inside, which is a jump.
  void setRange(StampUs begin_us, StampUs end_us, StampUs now_us);
  StampUs begin() const { return begin_us_; }
  StampUs end() const { return end_us_; }

  ReplayState state() const { return state_; }
  StampUs position() const { return position_us_; }
  double rate() const { return rate_; }
  bool loop() const { return loop_; }
  /// Number of seeks and loops.
  std::uint32_t jumps() const { return jumps_; }
  /// Position of the begin, or after the last jump.
  StampUs segmentBegin() const { return segment_begin_us_; }

  /// Clock time at which the position will be `stamp_us`; empty while it does not play, or for a past stamp.
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
  /// The position was anchor_position_us_ at the clock time anchor_clock_us_.
  StampUs anchor_clock_us_;
  StampUs anchor_position_us_;
  std::uint32_t jumps_ = 0;
  StampUs play_length_us_ = 0;
  std::optional<StampUs> pause_at_us_;  ///< while a play has a length
};

}  // namespace vismem
