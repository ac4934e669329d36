#include "calibration/core/body/body_drive.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>

#include "common/geometry/angles.h"

namespace vismem {
namespace {

/// Room between the ring and the fence: odometry is off by some percent before its calibration.
constexpr double kFenceMargin_m = 0.15;
/// Error of the distance to the board of a robot that is not calibrated yet.
constexpr double kFenceSlack_m = 0.05;
/// Rest before a view: longer than any time offset that is looked for, on both sides of the view.
constexpr double kSettle_s = 0.45;
constexpr double kAfterView_s = 0.35;
/// Between two views in motion: of the head, of the base.
constexpr StampUs kSweepView_us = 200'000;
constexpr StampUs kDriveView_us = 500'000;
constexpr int kRingCorners = 6;
/// Tilt beside the board's direction: the board goes through most of the image's height.
constexpr double kBesideTilt_rad = degToRad(14.0);
constexpr double kBesidePan_rad = degToRad(12.0);
/// The second way around the board is nearer: another range of tilts.
constexpr double kInnerRing = 0.75;
constexpr double kArrived_m = 0.02;
constexpr double kArrived_rad = degToRad(2.0);
/// A head that does not reach its aim (joint limits) is taken as it is after this time.
constexpr double kLookPatience_s = 2.0;
constexpr double kStepPatience_s = 60.0;
constexpr double kSweep_s = 6.0;
constexpr double kSweepPan_rad = degToRad(17.0);
constexpr double kSweepTilt_rad = degToRad(15.0);
constexpr double kSearchPatience_s = 80.0;
constexpr double kSearchRate_radps = 0.6;

/// Smallest radius whose sides keep the robot off the board.
double nearestRing_m(const BodyDriveParams& p) {
  constexpr double kRoom_m = 0.05;
  return (p.robot_radius_m + p.board_radius_m + kRoom_m) / std::cos(std::numbers::pi / kRingCorners);
}

}  // namespace

std::string checkBodyDrive(const BodyDriveParams& p) {
  std::ostringstream problem;
  if (!(p.ring_m >= nearestRing_m(p))) {
    problem << "way around the board of radius " << p.ring_m << " m (must be at least " << nearestRing_m(p)
            << " for this robot and board: it would drive over it)";
  } else if (p.ring_m + kFenceMargin_m > p.fence_m) {
    problem << "fence at " << p.fence_m << " m (must be at least " << p.ring_m + kFenceMargin_m
            << ", or the way around the board smaller)";
  } else if (p.rounds < 1 || p.rounds > 20) {
    problem << p.rounds << " rounds (must be 1..20)";
  } else if (!(p.speed_mps > 0.0) || !(p.turn_rate_radps > 0.0) || !(p.look_rate_radps > 0.0)) {
    problem << "a speed that is not positive";
  }
  return problem.str();
}

BodyDrive::BodyDrive(const BodyDriveParams& params) : params_(params) {}

void BodyDrive::seen(StampUs stamp_us, const Eigen::Vector3d& middle_odom) {
  middle_ = middle_odom;
  seen_us_ = stamp_us;
}

void BodyDrive::stop(const std::string& why) {
  phase_ = BodyDrivePhase::kStopped;
  why_stopped_ = why;
}

double BodyDrive::distanceToBoard(const BodyDriveState& state) const {
  return (state.T_odom_robot.position() - middle_->head<2>()).norm();
}

BodyDriveCommand BodyDrive::update(const BodyDriveState& state) {
  BodyDriveCommand command;
  if (phase_ == BodyDrivePhase::kDone || phase_ == BodyDrivePhase::kStopped) return command;
  if (middle_ && toSeconds(state.stamp_us - seen_us_) > kBlind_s) middle_.reset();
  if (!middle_) {
    search(state, command);
    return command;
  }
  if (search_us_) {  // found: the present step begins anew
    search_us_.reset();
    begun_us_ = state.stamp_us;
    arrived_us_.reset();
  }
  if (plan_.empty()) makePlan(state);
  if (!begun_us_) begun_us_ = state.stamp_us;
  const double here = distanceToBoard(state);
  std::ostringstream problem;
  if (params_.drive && here > params_.fence_m - kFenceSlack_m) {
    problem << "the robot is " << here << " m from the board, beyond the fence at " << params_.fence_m
            << " m";
  } else if (toSeconds(state.stamp_us - *begun_us_) > kStepPatience_s) {
    problem << "step " << next_ + 1 << " took more than " << kStepPatience_s << " s: is the robot blocked?";
  }
  if (!problem.str().empty()) {
    stop(problem.str());
    return command;
  }
  const double heading = state.T_odom_robot.theta;
  if (heading_rad_) turned_rad_ += angleDifference(heading, *heading_rad_);
  heading_rad_ = heading;
  phase_ = plan_[next_].phase;
  if (!perform(plan_[next_], state, command)) return command;
  ++next_;
  begun_us_.reset();
  arrived_us_.reset();
  turned_rad_ = 0.0;
  viewed_ = false;
  if (next_ == plan_.size()) phase_ = BodyDrivePhase::kDone;
  return command;
}

void BodyDrive::search(const BodyDriveState& state, BodyDriveCommand& command) {
  phase_ = BodyDrivePhase::kSearch;
  if (!search_us_) search_us_ = state.stamp_us;
  const double t = toSeconds(state.stamp_us - *search_us_);
  if (t > kSearchPatience_s) {
    stop("the board was not found: it must lie on the floor about " + std::to_string(params_.ring_m) +
         " m from the robot");
    return;
  }
  // From the middle to both sides, again and again, at several tilts.
  const double range = std::min(params_.rig.max_pan_rad, -params_.rig.min_pan_rad);
  const double round = 4.0 * range / kSearchRate_radps;
  const double place = std::fmod(t / round, 1.0);
  const double pan = range * (place < 0.25 ? 4 * place : place < 0.75 ? 2 - 4 * place : 4 * place - 4);
  static constexpr double kTilts_deg[] = {-20.0, -8.0, -28.0, 5.0};
  const double tilt = degToRad(kTilts_deg[static_cast<int>(t / round) % 4]);
  const PanTilt to = params_.rig.clamped({pan, tilt});
  command.head = PanTiltCommand{PanTiltCommand::Kind::kPosition, to.pan_rad, to.tilt_rad, 0.0, 0.0};
  viewInMotion(state.stamp_us, kSweepView_us, command);
}

BodyDrive::Step& BodyDrive::addStep(Step::Kind kind, BodyDrivePhase phase) {
  Step& step = plan_.emplace_back();
  step.kind = kind;
  step.phase = phase;
  return step;
}

void BodyDrive::addLooks(BodyDrivePhase phase, const std::vector<Eigen::Vector2d>& offsets_rad) {
  for (const auto& offset : offsets_rad) addStep(Step::Kind::kLook, phase).offset = offset;
}

void BodyDrive::addSweep(BodyDrivePhase phase, const Eigen::Vector2d& amplitude_rad) {
  Step& step = addStep(Step::Kind::kSweep, phase);
  step.offset = amplitude_rad;
  step.amount = kSweep_s;
}

void BodyDrive::addRing(double from_rad, double turn_rad, double radius_m) {
  int stops = 0;
  for (int i = 0; i < params_.rounds * kRingCorners; ++i) {
    const double angle = from_rad + (i + 1) * turn_rad;
    const Eigen::Vector2d corner = radius_m * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    addStep(Step::Kind::kFace, BodyDrivePhase::kRing).target = corner;
    addStep(Step::Kind::kGo, BodyDrivePhase::kRing).target = corner;
    // Wheels are noisy and need way, which costs less time than looks: at every second corner, in the next
    // round at the others.
    if ((i + i / kRingCorners) % 2 != 0) continue;
    // Across the board from all four sides in turn: the middle is reached in both directions of each joint,
    // which shows its backlash.
    const Eigen::Vector2d beside(stops % 2 == 0 ? kBesidePan_rad : -kBesidePan_rad,
                                 stops % 4 < 2 ? kBesideTilt_rad : -kBesideTilt_rad);
    addLooks(BodyDrivePhase::kRing, {beside, Eigen::Vector2d::Zero(), -beside});
    if (++stops % 3 == 0) addSweep(BodyDrivePhase::kRing, {0.0, kSweepTilt_rad});
  }
}

void BodyDrive::makePlan(const BodyDriveState& state) {
  // A grid of directions, each row from the other side than the one before, and down again: backlash shows.
  std::vector<Eigen::Vector2d> grid;
  for (int row = -1; row <= 1; ++row) {
    for (int column = -2; column <= 2; ++column) {
      const int side = row == 0 ? -column : column;
      grid.emplace_back(degToRad(9.0) * side, kBesideTilt_rad * row);
    }
  }
  grid.insert(grid.end(), {{0.0, 0.0}, {0.0, -kBesideTilt_rad}});
  addLooks(BodyDrivePhase::kLooks, grid);
  addSweep(BodyDrivePhase::kSweeps, {kSweepPan_rad, 0.0});
  addSweep(BodyDrivePhase::kSweeps, {0.0, kSweepTilt_rad});
  if (!params_.drive) return;
  const double full = 2.0 * std::numbers::pi;
  for (const double angle : {full, -full}) {
    addStep(Step::Kind::kTurn, BodyDrivePhase::kTurns).amount = angle;
    addLooks(BodyDrivePhase::kTurns, {{0.0, 0.0}});
  }
  const Eigen::Vector2d from = state.T_odom_robot.position() - middle_->head<2>();
  const double bearing = std::atan2(from.y(), from.x());
  const double corner = full / kRingCorners;
  addRing(bearing, corner, params_.ring_m);
  addRing(bearing, -corner, std::max(kInnerRing * params_.ring_m, nearestRing_m(params_)));
}

bool BodyDrive::perform(const Step& step, const BodyDriveState& state, BodyDriveCommand& command) {
  switch (step.kind) {
    case Step::Kind::kLook:
      return look(step, state, command);
    case Step::Kind::kSweep:
      return sweep(step, state, command);
    case Step::Kind::kTurn:
      return turn(step, state, command);
    case Step::Kind::kFace:
      return face(step, state, command);
    case Step::Kind::kGo:
      return go(step, state, command);
  }
  return true;
}

PanTiltCommand BodyDrive::aim(const BodyDriveState& state, const Eigen::Vector2d& offset,
                              double rate_radps) const {
  PanTilt to = panTiltTowards(params_.rig.mount, transform(inverse(state.T_odom_robot), *middle_));
  to = params_.rig.clamped({to.pan_rad + offset.x(), to.tilt_rad + offset.y()});
  return {PanTiltCommand::Kind::kPosition, to.pan_rad, to.tilt_rad, rate_radps, rate_radps};
}

void BodyDrive::viewInMotion(StampUs stamp_us, StampUs interval_us, BodyDriveCommand& command) {
  if (view_us_ != 0 && stamp_us - view_us_ < interval_us && stamp_us >= view_us_) return;
  view_us_ = stamp_us;
  command.take_view = true;
}

bool BodyDrive::look(const Step& step, const BodyDriveState& state, BodyDriveCommand& command) {
  // The aim is fixed when the look begins: a new sighting of the board must not move the head meanwhile.
  const double since = toSeconds(state.stamp_us - *begun_us_);
  if (!arrived_us_) {
    const PanTiltCommand to = aim(state, step.offset, params_.look_rate_radps);
    const double gap =
        std::max(std::abs(to.pan_rad - state.joints.pan_rad), std::abs(to.tilt_rad - state.joints.tilt_rad));
    command.head = to;
    if (gap < degToRad(0.2) || since > kLookPatience_s) arrived_us_ = state.stamp_us;
    return false;
  }
  const double rest = toSeconds(state.stamp_us - *arrived_us_);
  if (rest >= kSettle_s && !viewed_) {
    command.take_view = true;
    viewed_ = true;
  }
  return rest >= kSettle_s + kAfterView_s;
}

bool BodyDrive::sweep(const Step& step, const BodyDriveState& state, BodyDriveCommand& command) {
  const double t = toSeconds(state.stamp_us - *begun_us_);
  const double largest = step.offset.cwiseAbs().maxCoeff();
  const double frequency = params_.look_rate_radps / largest;
  command.head = aim(state, step.offset * std::sin(frequency * t), 0.0);
  viewInMotion(state.stamp_us, kSweepView_us, command);
  return t > step.amount;
}

bool BodyDrive::turn(const Step& step, const BodyDriveState& state, BodyDriveCommand& command) {
  command.head = aim(state, Eigen::Vector2d::Zero(), 0.0);
  viewInMotion(state.stamp_us, kDriveView_us, command);
  const double gap = step.amount - turned_rad_;
  if (std::abs(gap) < kArrived_rad) return true;
  command.w_radps = std::clamp(2.0 * gap, -params_.turn_rate_radps, params_.turn_rate_radps);
  return false;
}

bool BodyDrive::face(const Step& step, const BodyDriveState& state, BodyDriveCommand& command) {
  const Eigen::Vector2d way = middle_->head<2>() + step.target - state.T_odom_robot.position();
  if (way.norm() < 2.0 * kArrived_m) return true;
  command.head = aim(state, Eigen::Vector2d::Zero(), 0.0);
  viewInMotion(state.stamp_us, kDriveView_us, command);
  const double gap = angleDifference(std::atan2(way.y(), way.x()), state.T_odom_robot.theta);
  if (std::abs(gap) < kArrived_rad) return true;
  command.w_radps = std::clamp(2.0 * gap, -params_.turn_rate_radps, params_.turn_rate_radps);
  return false;
}

bool BodyDrive::go(const Step& step, const BodyDriveState& state, BodyDriveCommand& command) {
  const Eigen::Vector2d p =
      transform(inverse(state.T_odom_robot), Eigen::Vector2d(middle_->head<2>() + step.target));
  command.head = aim(state, Eigen::Vector2d::Zero(), 0.0);
  viewInMotion(state.stamp_us, kDriveView_us, command);
  if (p.x() < kArrived_m) return true;  // reached, or level with it
  command.v_mps = std::min(params_.speed_mps, 1.5 * p.x());
  if (p.x() > 0.2) {
    command.w_radps =
        std::clamp(1.5 * std::atan2(p.y(), p.x()), -params_.turn_rate_radps, params_.turn_rate_radps);
  }
  return false;
}

}  // namespace vismem
