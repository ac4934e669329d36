#include "common/robot/observation.h"

#include <cmath>
#include <utility>

namespace vismem {
namespace {

constexpr StampUs kHistorySpan_us = 5 * kSecondUs;
/// Stamps that go back further than this are a restart, a loop or a seek, not jitter (DESIGN 14).
constexpr StampUs kBackwards_us = kSecondUs;
constexpr std::size_t kMaxWaitingFrames = 64;

bool wentBack(StampUs stamp_us, StampUs newest_us) {
  return stamp_us + kBackwards_us < newest_us;
}

}  // namespace

ObservationAssembler::ObservationAssembler(const Params& params)
    : params_(params),
      pan_tilt_(kHistorySpan_us, params.max_gap_us),
      odometry_(kHistorySpan_us, params.max_gap_us) {}

void ObservationAssembler::beginEpoch() {
  frames_.clear();
  pan_tilt_.clear();
  odometry_.clear();
  newest_frame_us_ = 0;
  ++epoch_;
}

void ObservationAssembler::add(Frame frame) {
  if (wentBack(frame.stamp_us, newest_frame_us_)) beginEpoch();
  newest_frame_us_ = std::max(newest_frame_us_, frame.stamp_us);
  frames_.push_back(std::move(frame));
  if (frames_.size() > kMaxWaitingFrames) {
    frames_.pop_front();
    ++dropped_frames_;
  }
}

void ObservationAssembler::add(const PanTiltSample& sample) {
  const auto newest = pan_tilt_.latest();
  if (newest && wentBack(sample.stamp_us, newest->stamp_us)) beginEpoch();
  pan_tilt_.add(sample);
}

void ObservationAssembler::add(const OdometrySample& sample) {
  if (const auto newest = odometry_.latest()) {
    const Pose2 moved = inverse(newest->T_odom_robot) * sample.T_odom_robot;
    const bool close_in_time = sample.stamp_us - newest->stamp_us <= params_.max_gap_us;
    const bool jumped = close_in_time && (moved.position().norm() > params_.max_jump_m ||
                                          std::abs(moved.theta) > params_.max_jump_rad);
    if (wentBack(sample.stamp_us, newest->stamp_us) || jumped) beginEpoch();
  }
  odometry_.add(sample);
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
