#include "replay_server/core/replay_timeline.h"

#include <algorithm>
#include <cmath>

namespace vismem {

ReplayTimeline::ReplayTimeline(StampUs begin_us, StampUs end_us, double rate, bool loop, ReplayState state,
                               StampUs now_us)
    : begin_us_(begin_us),
      end_us_(end_us),
      rate_(rate),
      loop_(loop),
      state_(state),
      position_us_(begin_us),
      segment_begin_us_(begin_us),
      anchor_clock_us_(now_us),
      anchor_position_us_(begin_us) {}

void ReplayTimeline::anchor(StampUs now_us) {
  anchor_clock_us_ = now_us;
  anchor_position_us_ = position_us_;
}

void ReplayTimeline::jump(StampUs stamp_us) {
  position_us_ = segment_begin_us_ = stamp_us;
  ++jumps_;
}

void ReplayTimeline::update(StampUs now_us) {
  if (state_ != ReplayState::kPlaying) return;
  const double played_us = static_cast<double>(now_us - anchor_clock_us_) * rate_;
  const StampUs wanted_us = anchor_position_us_ + static_cast<StampUs>(std::floor(played_us + 1e-6));
  if (pause_at_us_ && wanted_us >= *pause_at_us_ && *pause_at_us_ < end_us_) {
    position_us_ = std::max(position_us_, *pause_at_us_);
    state_ = ReplayState::kPaused;
    return;
  }
  position_us_ = std::clamp(wanted_us, position_us_, std::max(position_us_, end_us_));
  if (wanted_us < end_us_) return;
  if (!loop_) {
    state_ = ReplayState::kFinished;
    return;
  }
  // The end itself must be reached before a restart.
  if (wanted_us == end_us_) return;
  jump(begin_us_);
  anchor(now_us);
}

void ReplayTimeline::play(StampUs now_us) {
  update(now_us);
  if (state_ == ReplayState::kPlaying) return;
  if (state_ == ReplayState::kFinished) jump(begin_us_);
  state_ = ReplayState::kPlaying;
  anchor(now_us);
  pause_at_us_.reset();
  if (play_length_us_ > 0)
    pause_at_us_ = position_us_ + std::min(play_length_us_, end_us_ - position_us_ + 1);
}

void ReplayTimeline::setRange(StampUs begin_us, StampUs end_us, StampUs now_us) {
  update(now_us);
  begin_us_ = begin_us;
  end_us_ = end_us;
  pause_at_us_.reset();
  const StampUs inside_us = std::clamp(position_us_, begin_us, end_us);
  if (inside_us != position_us_) jump(inside_us);
  if (state_ == ReplayState::kFinished && inside_us < end_us) state_ = ReplayState::kPaused;
  anchor(now_us);
}

void ReplayTimeline::pause(StampUs now_us) {
  update(now_us);
  if (state_ != ReplayState::kFinished) state_ = ReplayState::kPaused;
}

StampUs ReplayTimeline::seek(StampUs stamp_us, StampUs now_us) {
  update(now_us);
  jump(std::clamp(stamp_us, begin_us_, end_us_));
  pause_at_us_.reset();
  if (state_ == ReplayState::kFinished) state_ = ReplayState::kPlaying;
  anchor(now_us);
  return position_us_;
}

void ReplayTimeline::setRate(double rate, StampUs now_us) {
  update(now_us);
  anchor(now_us);
  rate_ = rate;
}

void ReplayTimeline::setLoop(bool loop, StampUs now_us) {
  update(now_us);
  loop_ = loop;
}

std::optional<StampUs> ReplayTimeline::clockAt(StampUs stamp_us) const {
  if (state_ != ReplayState::kPlaying || stamp_us <= position_us_) return std::nullopt;
  return anchor_clock_us_ +
         static_cast<StampUs>(std::ceil(static_cast<double>(stamp_us - anchor_position_us_) / rate_));
}

}  // namespace vismem
