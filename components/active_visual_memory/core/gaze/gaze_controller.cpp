#include "active_visual_memory/core/gaze/gaze_controller.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/geometry/angles.h"

namespace vismem {

namespace {

constexpr double kReachPan_rad = 0.35;  // a target this far beyond a limit is still in the image
constexpr double kReachTilt_rad = 0.35;
constexpr double kArrived_rad = 0.05;
constexpr double kSaccadeTimeout_s = 4.0;  // A6
constexpr double kSaccadeSlowdown =
    1.25;  // minimum jerk is taken while it needs at most this multiple of the least time
constexpr double kSaccade_rad = 0.07;  // farther targets are reached by a saccade, nearer ones by tracking
constexpr double kMaxStep_s = 0.2;     // commands look at most this far ahead of the next image
constexpr double kResend_s = 0.5;      // an unchanged position command is repeated after this
constexpr double kResend_rad = 0.004;
// A4, proportional control.
constexpr double kPanDeadZone_rad = degToRad(0.3);
constexpr double kTiltDeadZone_rad = degToRad(0.1);
constexpr double kGain_per_s = 3.0;

constexpr double kLeastRate_radps = 0.01;

/// Motion along an arc, from its length and turn.
Pose2 arc(double way_m, double turn_rad) {
  const double half = 0.5 * turn_rad;
  const double chord = std::abs(half) < 1e-6 ? way_m : way_m * std::sin(half) / half;
  return {chord * std::cos(half), chord * std::sin(half), turn_rad};
}

double largestDifference(const PanTilt& a, const PanTilt& b) {
  return std::max(std::abs(a.pan_rad - b.pan_rad), std::abs(a.tilt_rad - b.tilt_rad));
}

}  // namespace

GazeState nextGazeState(GazeState state, const GazeConditions& c) {
  switch (state) {
    case GazeState::kSelect:
      return c.has_target ? GazeState::kSaccade : GazeState::kSelect;
    case GazeState::kSaccade:
      if (c.target_gone) return GazeState::kSelect;
      if (c.arrived) return GazeState::kAnalyse;
      return c.timed_out ? GazeState::kSelect : GazeState::kSaccade;
    case GazeState::kAnalyse:
      if (c.target_gone) return GazeState::kSelect;
      if (c.relevant) return GazeState::kTrack;
      return c.analysed ? GazeState::kSelect : GazeState::kAnalyse;
    case GazeState::kTrack:
      return c.target_gone || c.tracked ? GazeState::kSelect : GazeState::kTrack;
  }
  return GazeState::kSelect;
}

double proportionalSpeed(double error, double dead_zone, double gain, double maximum) {
  if (std::abs(error) < dead_zone) return 0.0;
  return std::clamp(gain * error, -maximum, maximum);
}

void GazeController::Params::visit(ParameterVisitor& v) {
  v.choice(basic("Mode", "attend (look around), hold, or off"), initial_mode,
           {{"attend", GazeMode::kAttend}, {"hold", GazeMode::kHold}, {"off", GazeMode::kOff}});
  v.angle(expert("Rate.Pan_degps", "largest rate of the pan axis"), pan.rate_radps, 1.0, 2000.0);
  v.angle(expert("Rate.Tilt_degps", "largest rate of the tilt axis"), tilt.rate_radps, 1.0, 2000.0);
}

GazeController::Params GazeController::Params::chapter(const Rig& rig) {
  Params p;
  p.control = Control::kProportional;
  p.object_min_tilt_rad = rig.min_tilt_rad;
  p.object_max_tilt_rad = rig.max_tilt_rad;
  p.analyse_s = 1.0;
  p.track_s = 3.0;
  p.client_track_s = 3.0;
  p.lookahead_s = 0.0;
  p.pan.rate_radps = degToRad(60.0);
  p.tilt.rate_radps = degToRad(30.0);
  // The proportional controllers approach the dead zone slowly.
  p.quiet_radps = 1.0;
  return p;
}

GazeController::GazeController(const Params& params, const Rig& rig)
    : params_(params), rig_(rig), mode_(params.initial_mode) {}

void GazeController::setMode(GazeMode mode) {
  if (mode == mode_) return;
  mode_ = mode;
  saccade_.reset();
  hold_sent_ = false;
  sent_.reset();
  abandonTarget();
}

void GazeController::fixate(const Eigen::Vector3d& p_odom) {
  setMode(GazeMode::kFixate);
  fixation_ = p_odom;
}

void GazeController::abandonTarget() {
  target_.reset();
  state_ = GazeState::kSelect;
}

std::optional<std::uint64_t> GazeController::attended() const {
  const bool looking = state_ == GazeState::kAnalyse || state_ == GazeState::kTrack;
  if (!looking || !target_) return std::nullopt;
  return target_->id;
}

void GazeController::report(StampUs stamp_us, const AttentionPool& pool, GazeStatus& status) const {
  status.stamp_us = stamp_us;
  status.mode = mode_;
  status.state = state_;
  status.target = target_;
  pool.listPoints(status.points);
  status.visits = visits_;
  status.given_up = given_up_;
}

void GazeController::enter(GazeState state, StampUs stamp_us) {
  if (state == state_) return;
  state_ = state;
  entered_us_ = stamp_us;
}

GazeController::Aim GazeController::aimAt(const AttentionPoint& point, const Pose2& T_odom_robot) const {
  Aim aim;
  double low = rig_.min_tilt_rad;
  double high = rig_.max_tilt_rad;
  if (point.direction) {
    aim.wanted = *point.direction;
  } else {
    aim.wanted = panTiltTowards(rig_.mount, transform(inverse(T_odom_robot), *point.p_odom));
    if (point.kind == AttentionKind::kSegment) {
      low = std::max(low, params_.object_min_tilt_rad);
      high = std::min(high, params_.object_max_tilt_rad);
    }
  }
  aim.clamped = {std::clamp(aim.wanted.pan_rad, rig_.min_pan_rad, rig_.max_pan_rad),
                 std::clamp(aim.wanted.tilt_rad, low, high)};
  aim.reachable = std::abs(aim.wanted.pan_rad - aim.clamped.pan_rad) <= kReachPan_rad &&
                  std::abs(aim.wanted.tilt_rad - aim.clamped.tilt_rad) <= kReachTilt_rad;
  return aim;
}

PanTilt GazeController::predictAim(const AttentionPoint& point, const RobotObservation& observation,
                                   double ahead_s) const {
  AttentionPoint later = point;
  if (point.kind == AttentionKind::kClient && point.p_odom) {
    later.p_odom = motion_.at(observation.frame.stamp_us + toStampUs(ahead_s));
  }
  const Pose2 moved = arc(robot_v_mps_ * ahead_s, robot_w_radps_ * ahead_s);
  return aimAt(later, observation.T_odom_robot * moved).clamped;
}

std::optional<PanTiltCommand> GazeController::command(const AttentionPoint& point,
                                                      const RobotObservation& observation) {
  const StampUs now = observation.frame.stamp_us;
  const PanTilt actual = *observation.pan_tilt;
  if (params_.control == Control::kProportional) {
    const PanTilt aim = predictAim(point, observation, params_.lookahead_s);
    PanTiltCommand command;
    command.kind = PanTiltCommand::Kind::kVelocity;
    command.pan_rate_radps = proportionalSpeed(aim.pan_rad - actual.pan_rad, kPanDeadZone_rad, kGain_per_s,
                                               params_.pan.rate_radps);
    command.tilt_rate_radps = proportionalSpeed(aim.tilt_rad - actual.tilt_rad, kTiltDeadZone_rad,
                                                kGain_per_s, params_.tilt.rate_radps);
    return command;
  }
  // The command acts from now + lookahead until the next one acts, one step later. Its goal lies a further
  // step ahead, so that a late successor does not stop the head.
  const double step_s = dt_s_ > 0.0 ? std::min(dt_s_, kMaxStep_s) : kMaxStep_s;
  const PanTilt near = predictAim(point, observation, params_.lookahead_s);
  const PanTilt next = predictAim(point, observation, params_.lookahead_s + step_s);
  PanTilt goal = predictAim(point, observation, params_.lookahead_s + 2.0 * step_s);
  PanTilt step = next;

  if (saccade_ && (saccade_id_ != point.id || now >= saccade_->end())) saccade_.reset();
  if (!saccade_ && largestDifference(near, actual) > kSaccade_rad) {
    saccade_.emplace(now, actual, near, params_.pan, params_.tilt, kSaccadeSlowdown);
    saccade_id_ = point.id;
  }
  if (saccade_) {
    const double left_s = std::max(0.0, toSeconds(saccade_->end() - now));
    goal = predictAim(point, observation, std::max(left_s, params_.lookahead_s + step_s));
    step = saccade_->at(now + toStampUs(step_s), goal);
  }

  const bool same = sent_ && largestDifference(*sent_, goal) < kResend_rad;
  if (same && !saccade_ && toSeconds(now - sent_us_) < kResend_s) return std::nullopt;
  const auto rate = [&](double from, double to, double aim, double most) {
    // Step done, target not reached: approach at no more than 10 % of the maximum rate.
    const double needed = std::abs(to - from) / step_s;
    const double least = std::abs(aim - from) / (4.0 * step_s);
    return std::clamp(std::max(needed, std::min(least, 0.1 * most)), kLeastRate_radps, most);
  };
  PanTiltCommand command;
  command.kind = PanTiltCommand::Kind::kPosition;
  command.pan_rad = goal.pan_rad;
  command.tilt_rad = goal.tilt_rad;
  command.pan_rate_radps = rate(actual.pan_rad, step.pan_rad, goal.pan_rad, params_.pan.rate_radps);
  command.tilt_rate_radps = rate(actual.tilt_rad, step.tilt_rad, goal.tilt_rad, params_.tilt.rate_radps);
  sent_ = goal;
  sent_us_ = now;
  return command;
}

std::optional<PanTiltCommand> GazeController::imagesLost() {
  blind_ = true;
  return hold();
}

std::optional<PanTiltCommand> GazeController::hold() {
  if (!last_angles_ || mode_ == GazeMode::kOff || hold_sent_) return std::nullopt;
  hold_sent_ = true;
  sent_.reset();
  PanTiltCommand command;
  if (params_.control == Control::kProportional) return command;  // speed 0
  command.kind = PanTiltCommand::Kind::kPosition;
  const PanTilt kept = rig_.clamped(*last_angles_);
  command.pan_rad = kept.pan_rad;
  command.tilt_rad = kept.tilt_rad;
  return command;
}

void GazeController::select(const RobotObservation& observation, AttentionPool& pool) {
  target_.reset();
  // Unreachable points are given up at once; each try removes or resets one, so the loop ends.
  for (std::size_t tries = pool.size() + 2; tries > 0; --tries) {
    auto candidate = pool.mostSalient();
    if (!candidate) {
      pool.addScanningPoint();
      candidate = pool.mostSalient();
      if (!candidate) return;
    }
    if (aimAt(*candidate, observation.T_odom_robot).reachable) {
      target_ = candidate;
      return;
    }
    pool.giveUp(candidate->id);
    ++given_up_;
  }
}

void GazeController::review(const RobotObservation& observation, std::span<const MemorySegment> segments,
                            AttentionPool& pool) {
  const StampUs now = observation.frame.stamp_us;
  const PanTilt actual = *observation.pan_tilt;
  GazeConditions conditions;
  if (const auto current = pool.find(target_->id)) {
    target_ = current;
    const Aim aim = updateTarget(observation);
    const double in_state_s = toSeconds(now - entered_us_);
    conditions.arrived =
        largestDifference(*error_, {}) <= kArrived_rad && error_rate_radps_ <= params_.quiet_radps;
    conditions.timed_out = !aim.reachable || in_state_s >= kSaccadeTimeout_s;
    conditions.analysed = in_state_s >= params_.analyse_s;
    const bool client = target_->kind == AttentionKind::kClient;
    conditions.tracked = in_state_s >= (client ? params_.client_track_s : params_.track_s);
    // An urgent request ends the visit of an object, which keeps its salience.
    if (!client && pool.isUrgent()) conditions.target_gone = true;
    if (client) {
      conditions.relevant = true;
    } else if (const auto id = pool.segmentOf(target_->id)) {
      conditions.relevant = std::any_of(segments.begin(), segments.end(), [&](const MemorySegment& s) {
        return s.id == *id && s.last_seen_us == now;
      });
    }
  } else {
    conditions.target_gone = true;
  }
  const GazeState next = nextGazeState(state_, conditions);
  if (next == GazeState::kSelect) {
    if (state_ != GazeState::kSaccade) {
      pool.visited(target_->id, actual, observation.T_odom_robot);
      ++visits_;
    } else if (!conditions.target_gone) {
      pool.giveUp(target_->id);
      ++given_up_;
    }
    target_.reset();
  }
  enter(next, now);
}

GazeController::Aim GazeController::updateTarget(const RobotObservation& observation) {
  if (target_->kind == AttentionKind::kClient && target_->p_odom) {
    motion_.observe(target_->id, *target_->p_odom, observation.frame.stamp_us);
  }
  const Aim aim = aimAt(*target_, observation.T_odom_robot);
  const PanTilt actual = *observation.pan_tilt;
  const PanTilt error{aim.clamped.pan_rad - actual.pan_rad, aim.clamped.tilt_rad - actual.tilt_rad};
  const bool known = error_ && error_id_ == target_->id && dt_s_ > 0.0;
  error_rate_radps_ =
      known ? std::hypot(error.pan_rad - error_->pan_rad, error.tilt_rad - error_->tilt_rad) / dt_s_ : 0.0;
  error_ = error;
  error_id_ = target_->id;
  return aim;
}

std::optional<PanTiltCommand> GazeController::attend(const RobotObservation& observation,
                                                     std::span<const MemorySegment> segments,
                                                     AttentionPool& pool) {
  const bool selects = state_ == GazeState::kSelect;
  if (!selects) review(observation, segments, pool);
  // After an urgent request ended a visit, the next target is selected with the same image.
  if (selects || (state_ == GazeState::kSelect && pool.isUrgent())) {
    select(observation, pool);
    GazeConditions conditions;
    conditions.has_target = target_.has_value();
    enter(nextGazeState(state_, conditions), observation.frame.stamp_us);
    if (target_) updateTarget(observation);
  }
  if (!target_) return std::nullopt;
  return command(*target_, observation);
}

std::optional<PanTiltCommand> GazeController::preempt(AttentionPool& pool) {
  if (mode_ != GazeMode::kAttend || !last_angles_ || blind_) return std::nullopt;
  RobotObservation last;
  last.frame.stamp_us = last_stamp_us_;
  last.pan_tilt = last_angles_;
  last.T_odom_robot = last_pose_;
  if (!target_ || target_->kind != AttentionKind::kClient) {
    return pool.isUrgent() ? attend(last, {}, pool) : std::nullopt;
  }
  const auto current = pool.find(target_->id);
  if (!current) return std::nullopt;
  // Motion below saccade_rad is followed with the next image; a jump is a new place.
  const PanTilt before = aimAt(*target_, last_pose_).clamped;
  const PanTilt now = aimAt(*current, last_pose_).clamped;
  if (largestDifference(now, before) <= kSaccade_rad) return std::nullopt;
  target_ = current;
  updateTarget(last);
  return command(*target_, last);
}

std::optional<PanTiltCommand> GazeController::update(const RobotObservation& observation,
                                                     std::span<const MemorySegment> segments,
                                                     AttentionPool& pool) {
  blind_ = false;
  if (!observation.pan_tilt) return std::nullopt;
  const StampUs now = observation.frame.stamp_us;
  const PanTilt actual = *observation.pan_tilt;
  const double dt = toSeconds(now - last_stamp_us_);
  if (last_angles_ && dt > 0.0 && dt < 1.0) {
    dt_s_ = dt;
    const Pose2 moved = inverse(last_pose_) * observation.T_odom_robot;
    robot_v_mps_ = moved.x / dt;
    robot_w_radps_ = moved.theta / dt;
  } else {
    dt_s_ = robot_v_mps_ = robot_w_radps_ = 0.0;
  }
  last_angles_ = actual;
  last_pose_ = observation.T_odom_robot;
  last_stamp_us_ = now;

  switch (mode_) {
    case GazeMode::kOff:
      return std::nullopt;
    case GazeMode::kHold:
      return hold();
    case GazeMode::kFixate: {
      if (!fixation_) return hold();
      AttentionPoint point;
      point.kind = AttentionKind::kClient;
      point.p_odom = fixation_;
      target_ = point;
      const Aim aim = updateTarget(observation);
      enter(largestDifference(aim.clamped, actual) <= kArrived_rad ? GazeState::kTrack : GazeState::kSaccade,
            now);
      return command(point, observation);
    }
    case GazeMode::kAttend:
      break;
  }
  hold_sent_ = false;
  return attend(observation, segments, pool);
}

}  // namespace vismem
