#include "common/robot/observation.h"

#include <cmath>
#include <iomanip>
#include <sstream>
#include <utility>

namespace vismem {
namespace {

constexpr StampUs kHistorySpan_us = 5 * kSecondUs;
/// Stamps that go back further than this are a restart, a loop or a seek, not jitter.
constexpr StampUs kBackwards_us = kSecondUs;
constexpr std::size_t kMaxWaitingFrames = 64;

bool wentBack(StampUs stamp_us, StampUs newest_us) {
  return stamp_us + kBackwards_us < newest_us;
}

std::string oneDecimal(double value) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(1) << value;
  return text.str();
}

std::string secondsText(StampUs duration_us) {
  return oneDecimal(toSeconds(duration_us)) + " s";
}

}  // namespace

ObservationAssembler::ObservationAssembler(const Params& params)
    : params_(params),
      pan_tilt_(kHistorySpan_us, params.max_gap_us),
      odometry_(kHistorySpan_us, params.max_gap_us) {}

void ObservationAssembler::beginEpoch(std::string reason) {
  frames_.clear();
  pan_tilt_.clear();
  odometry_.clear();
  newest_frame_us_ = 0;
  ++epoch_;
  epoch_reason_ = std::move(reason);
}

void ObservationAssembler::add(Frame frame) {
  if (wentBack(frame.stamp_us, newest_frame_us_)) {
    const auto odometry = odometry_.latest();
    if (odometry && !wentBack(frame.stamp_us, odometry->stamp_us)) {
      // The odometry already began this epoch; these frames belong to the time before it.
      frames_.clear();
      newest_frame_us_ = 0;
    } else {
      beginEpoch("the camera's stamps went back by " + secondsText(newest_frame_us_ - frame.stamp_us));
    }
  }
  newest_frame_us_ = std::max(newest_frame_us_, frame.stamp_us);
  frames_.push_back(std::move(frame));
  if (frames_.size() > kMaxWaitingFrames) {
    frames_.pop_front();
    ++dropped_frames_;
  }
}

void ObservationAssembler::add(const PanTiltSample& sample) {
  const auto newest = pan_tilt_.latest();
  if (newest && wentBack(sample.stamp_us, newest->stamp_us)) {
    // Joint angles have no memory: only the other streams begin an epoch.
    pan_tilt_.clear();
  }
  pan_tilt_.add(sample);
}

void ObservationAssembler::add(const OdometrySample& sample) {
  if (const auto newest = odometry_.latest()) {
    const Pose2 moved = inverse(newest->T_odom_robot) * sample.T_odom_robot;
    const bool close_in_time = sample.stamp_us - newest->stamp_us <= params_.max_gap_us;
    const bool jumped = close_in_time && (moved.position().norm() > params_.max_jump_m ||
                                          std::abs(moved.theta) > params_.max_jump_rad);
    if (wentBack(sample.stamp_us, newest->stamp_us)) {
      if (newest_frame_us_ != 0 && !wentBack(sample.stamp_us, newest_frame_us_)) {
        odometry_.clear();  // The frames already began this epoch.
      } else {
        beginEpoch("the odometry's stamps went back by " + secondsText(newest->stamp_us - sample.stamp_us));
      }
    } else if (sample.seq < newest->seq && sample.stamp_us > newest->stamp_us) {
      // A restarted base has new sequence numbers and a new origin; stamps of a real clock continue.
      beginEpoch("the odometry was restarted: its numbers went back from " + std::to_string(newest->seq) +
                 " to " + std::to_string(sample.seq));
    } else if (jumped) {
      beginEpoch("the odometry jumped by " + oneDecimal(moved.position().norm()) + " m and " +
                 oneDecimal(radToDeg(std::abs(moved.theta))) + " degrees");
    }
  }
  odometry_.add(sample);
}

std::string ObservationAssembler::whyNothing() const {
  const auto behind = [&](const std::string& what, std::optional<StampUs> newest_us) -> std::string {
    if (!newest_us) return "images come, but no sample of the " + what;
    const StampUs ahead_us = newest_frame_us_ - *newest_us;
    if (std::abs(ahead_us) <= kBackwards_us) return "";
    return "the camera's stamps are " + secondsText(std::abs(ahead_us)) +
           (ahead_us > 0 ? " ahead of" : " behind") + " those of the " + what +
           " (a stream that stopped, or clocks of hosts that are out of step)";
  };
  const auto odometry = odometry_.latest();
  std::string why = behind("odometry", odometry ? std::optional(odometry->stamp_us) : std::nullopt);
  if (why.empty() && params_.has_pan_tilt) {
    const auto joints = pan_tilt_.latest();
    why = behind("pan-tilt unit", joints ? std::optional(joints->stamp_us) : std::nullopt);
  }
  return why.empty() ? "no samples cover the stamps of the images" : why;
}

std::optional<RobotObservation> ObservationAssembler::observe(const Frame& frame) const {
  RobotObservation observation;
  const auto odometry = odometry_.at(frame.stamp_us);
  if (!odometry) return std::nullopt;
  observation.T_odom_robot = *odometry;
  if (params_.has_pan_tilt) observation.pan_tilt = pan_tilt_.at(frame.stamp_us);
  if (frame.T_robot_camera) {
    observation.T_robot_camera = *frame.T_robot_camera;
  } else {
    if (!observation.pan_tilt) return std::nullopt;
    observation.T_robot_camera =
        cameraPose(params_.mount, observation.pan_tilt->pan_rad, observation.pan_tilt->tilt_rad);
  }
  observation.frame = frame;
  observation.epoch = epoch_;
  return observation;
}

std::optional<RobotObservation> ObservationAssembler::take(bool every_frame) {
  std::optional<RobotObservation> result;
  while (!frames_.empty()) {
    const Frame& frame = frames_.front();
    const bool needs_joints = params_.has_pan_tilt && !frame.T_robot_camera;
    const bool decided =
        odometry_.isPast(frame.stamp_us) && (!needs_joints || pan_tilt_.isPast(frame.stamp_us));
    if (!decided) break;
    auto observation = observe(frame);
    frames_.pop_front();
    if (!observation) {
      ++dropped_frames_;
      continue;
    }
    if (result) ++dropped_frames_;
    result = std::move(observation);
    if (every_frame) break;
  }
  return result;
}

}  // namespace vismem
