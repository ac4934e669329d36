#include "calibration/simulated_board_robot.h"

#include <algorithm>
#include <cmath>

#include "calibration/core/body/body_costs.h"
#include "calibration/core/body/body_start.h"
#include "calibration/core/lens/board_pose.h"
#include "common/geometry/angles.h"
#include "common/kinematics/random_stream.h"
#include "common/robot/history.h"

namespace vismem {
namespace {

constexpr StampUs kStep_us = 10'000;
constexpr double kStep_s = 0.01;
constexpr std::size_t kLeastCorners = 8;
/// A finder needs squares of about this area [px^2].
constexpr double kLeastSquare_px2 = 64.0;

/// The end of a ring of 25 m, 9 x 3.5 m, driven along its sides and quarter turns, as wheels report it.
Pose2 ringEnd(const WheelModel& truth, const WheelModel& believed) {
  Eigen::Vector3d pose = Eigen::Vector3d::Zero();
  const auto piece = [&](double travel, double turn) {
    // Reported travel of each wheel for a true motion, then the believed motion.
    const double left = (travel - 0.5 * truth.base_m * turn) / truth.left_scale;
    const double right = (travel + 0.5 * truth.base_m * turn) / truth.right_scale;
    const double l = believed.left_scale * left;
    const double r = believed.right_scale * right;
    pose = advanced<double>(pose, 0.5 * (l + r), (r - l) / believed.base_m);
  };
  for (int side = 0; side < 4; ++side) {
    for (int i = 0; i < 100; ++i) piece((side % 2 == 0 ? 9.0 : 3.5) / 100.0, 0.0);
    for (int i = 0; i < 100; ++i) piece(0.0, M_PI_2 / 100.0);
  }
  return {pose.x(), pose.y(), pose.z()};
}

}  // namespace

BodyParameters parametersOf(const TrueRobot& truth) {
  CameraMount mount = truth.mount;
  mount.T_robot_pantilt = mount.T_robot_pantilt * poseFromXyzRpy(0, 0, 0, 0, 0, truth.pan_zero_rad);
  mount.T_head_camera_body = poseFromXyzRpy(0, 0, 0, 0, -truth.tilt_zero_rad, 0) * mount.T_head_camera_body;
  BodyParameters p = nominalBody(mount, truth.intrinsics, truth.wheels.base_m);
  p.body[kPanScale] = truth.pan_scale;
  p.body[kTiltScale] = truth.tilt_scale;
  p.body[kAxisSkew] = truth.axis_skew_rad;
  p.wheels[kLeftScale] = truth.wheels.left_scale;
  p.wheels[kRightScale] = truth.wheels.right_scale;
  p.wheels[kOdometryDelay] = truth.odometry_delay_s;
  p.body[kPanBacklash] = truth.backlash_rad.pan_rad;
  p.body[kTiltBacklash] = truth.backlash_rad.tilt_rad;
  p.body[kJointDelay] = truth.joint_delay_s;
  p.body[kRowTime] = truth.row_time_s;
  p.body[kBoardRoll] = truth.board_tilt_rad.x();
  p.body[kBoardPitch] = truth.board_tilt_rad.y();
  return p;
}

BodyParameters soughtParameters(const TrueRobot& truth) {
  const CameraIntrinsics& k = truth.intrinsics;
  BodyParameters p = parametersOf(truth);
  CameraMount mount = mountOf(p);
  mount.T_head_camera_body =
      mount.T_head_camera_body *
      poseFromXyzRpy(0, 0, 0, 0, -(k.cy - truth.stated.cy) / k.fy, (k.cx - truth.stated.cx) / k.fx);
  const BodyParameters turned = nominalBody(mount, k, truth.wheels.base_m);
  for (const BodyIndex i : {kCameraRoll, kCameraPitch, kCameraYaw}) p.body[i] = turned.body[i];
  return p;
}

CameraIntrinsics boardCamera() {
  return intrinsicsFromFieldOfView(640, 480, degToRad(60.0));
}

BoardSpec a3Board() {
  BoardSpec board;
  board.columns = 10;
  board.rows = 7;
  board.square_m = {0.035, 0.035};
  return board;
}

TrueRobot::TrueRobot()
    : mount(describedMount()), intrinsics(boardCamera()), stated(boardCamera()), board(a3Board()) {}

CameraMount describedMount() {
  CameraMount mount;
  mount.T_robot_pantilt = poseFromXyzRpy(0, 0, 0.45, 0, 0, 0);
  return mount;
}

TrueRobot drawnRobot(std::uint64_t seed) {
  std::mt19937_64 engine(subStream(seed, "drawn robot"));
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  std::normal_distribution<double> normal(0.0, 1.0);
  const auto degrees = [&](double most) { return degToRad(most * unit(engine)); };
  const auto draw = [&](double most) { return most * unit(engine); };
  TrueRobot robot;
  robot.mount.T_robot_pantilt =
      poseFromXyzRpy(draw(0.03), draw(0.03), 0.45 + draw(0.03), degrees(3.0), degrees(3.0), degrees(3.0));
  robot.mount.T_head_camera_body =
      poseFromXyzRpy(draw(0.03), draw(0.03), draw(0.03), degrees(3.0), degrees(3.0), degrees(3.0));
  // The lens is calibrated, not perfect.
  robot.intrinsics = boardCamera();
  robot.intrinsics.fx += normal(engine);
  robot.intrinsics.fy = robot.intrinsics.fx;
  robot.intrinsics.cx += normal(engine);
  robot.intrinsics.cy += normal(engine);
  robot.pan_zero_rad = degrees(5.0);
  robot.tilt_zero_rad = degrees(5.0);
  robot.pan_scale = 1.0 + draw(0.03);
  robot.tilt_scale = 1.0 + draw(0.03);
  robot.axis_skew_rad = degrees(1.0);
  robot.repeatability_rad = degToRad(0.05);
  robot.wheels = {1.0 + draw(0.03), 1.0 + draw(0.03), kDescribedBase_m * (1.0 + draw(0.03))};
  robot.wheel_noise_sqrtm = 0.0005;
  robot.joint_delay_s = 0.075 + draw(0.075);
  robot.odometry_delay_s = 0.075 + draw(0.075);
  robot.row_time_s = 25e-6 * (1.0 + unit(engine));
  robot.start = {-1.1 + draw(0.1), draw(0.2), degrees(10.0)};
  robot.backlash_rad = {degToRad(0.25) + degrees(0.25), degToRad(0.25) + degrees(0.25)};
  return robot;
}

Pose3 trueCameraPose(const TrueRobot& robot, const PanTilt& reported) {
  return cameraPose(parametersOf(robot), reported);
}

namespace {

/// Its joints' angles are the reported ones.
PanTiltParams headOf(const TrueRobot& truth) {
  PanTiltParams params;
  params.backlash_rad = {truth.backlash_rad.pan_rad / truth.pan_scale,
                         truth.backlash_rad.tilt_rad / truth.tilt_scale};
  return params;
}

}  // namespace

SimulatedBoardRobot::SimulatedBoardRobot(const TrueRobot& truth, std::uint64_t seed, BoardPlace place)
    : truth_(truth),
      place_(place),
      board_(truth.board),
      engine_(subStream(seed, "board robot")),
      head_(headOf(truth)) {
  const Eigen::Vector3d middle = middlePosition(board_);
  pose_ = {truth.start.x + middle.x(), truth.start.y + middle.y(), truth.start.theta};
  history_.push_back({head_.headAngles(), pose_});
  record_.board = board_;
  record_.place = place;
  record_.intrinsics = truth.stated;
  record_.joints.push_back({toStampUs(truth.joint_delay_s), 0, 0.0, 0.0});
  record_.odometry.push_back({toStampUs(truth.odometry_delay_s), 0, {}, 0.0, 0.0});
}

void SimulatedBoardRobot::step(double v_mps, double w_radps) {
  const auto towards = [](double value, double wanted, double most) {
    return value + std::clamp(wanted - value, -most, most);
  };
  std::normal_distribution<double> normal(0.0, 1.0);
  v_ = towards(v_, v_mps, 0.8 * kStep_s);
  w_ = towards(w_, w_radps, degToRad(300.0) * kStep_s);
  // What its encoders report, and what the wheels really do.
  const WheelTravel reported{(v_ - 0.5 * kDescribedBase_m * w_) * kStep_s,
                             (v_ + 0.5 * kDescribedBase_m * w_) * kStep_s};
  const auto real = [&](double travel, double scale) {
    return scale * travel + truth_.wheel_noise_sqrtm * std::sqrt(std::abs(travel)) * normal(engine_);
  };
  const double left = real(reported.left, truth_.wheels.left_scale);
  const double right = real(reported.right, truth_.wheels.right_scale);
  pose_ = pose_ * arcMotion(0.5 * (left + right), (right - left) / truth_.wheels.base_m, 1.0);
  odometry_ = odometry_ * arcMotion(v_, w_, kStep_s);
  head_.step(kStep_s);
  const PanTilt angles = head_.angles();
  now_us_ += kStep_us;
  history_.push_back({head_.headAngles(), pose_});
  const auto seq = static_cast<std::uint64_t>(now_us_ / kStep_us);
  record_.joints.push_back({now_us_ + toStampUs(truth_.joint_delay_s), seq, angles.pan_rad, angles.tilt_rad});
  record_.odometry.push_back({now_us_ + toStampUs(truth_.odometry_delay_s), seq, odometry_, v_, w_});
  const Eigen::Vector3d middle = middlePosition(board_);
  farthest_ = std::max(farthest_, (pose_.position() - middle.head<2>()).norm());
}

SimulatedBoardRobot::State SimulatedBoardRobot::stateAt(double time_s) const {
  const double place = std::clamp(time_s / kStep_s, 0.0, static_cast<double>(history_.size() - 1) - 1e-9);
  const auto i = static_cast<std::size_t>(place);
  const double share = place - static_cast<double>(i);
  const State& from = history_[i];
  const State& to = history_[i + 1];
  return {interpolate(from.head, to.head, share), interpolate(from.pose, to.pose, share)};
}

std::optional<Eigen::Vector2d> SimulatedBoardRobot::project(const Eigen::Vector3d& p_board, double time_s,
                                                            const PanTilt& noise) const {
  std::array<double, kBodySize> board{};
  board[kBoardRoll] = truth_.board_tilt_rad.x();
  board[kBoardPitch] = truth_.board_tilt_rad.y();
  board[kBoardHeight] = place_ == BoardPlace::kWall ? 0.3 : 0.0;
  const Eigen::Vector3d middle = middlePosition(board_);
  const Eigen::Vector3d real = middle + truth_.board_scale * (p_board - middle);
  const Eigen::Vector3d p_world = worldOfBoard<double>(board.data(), place_, real, middle);
  const State state = stateAt(time_s);
  // Repeatability acts on the true angle.
  const PanTilt shifted{state.head.pan_rad + noise.pan_rad / truth_.pan_scale,
                        state.head.tilt_rad + noise.tilt_rad / truth_.tilt_scale};
  const Pose3 T_world_camera = toPose3(state.pose) * cameraPose(parametersOf(truth_), shifted);
  const auto ideal = projectToIdeal(truth_.intrinsics, T_world_camera.inverse(Eigen::Isometry) * p_world);
  if (!ideal) return std::nullopt;
  // Far beside the image the polynomial of the distortion folds back into it; a lens does not.
  constexpr double kWidest = 1.5;
  const CameraIntrinsics& k = truth_.intrinsics;
  if (std::hypot((ideal->x() - k.cx) / k.fx, (ideal->y() - k.cy) / k.fy) > kWidest) return std::nullopt;
  return distortPixel(k, *ideal);
}

BoardView SimulatedBoardRobot::viewAt(StampUs stamp_us) {
  std::normal_distribution<double> normal(0.0, 1.0);
  const PanTilt noise{truth_.repeatability_rad * normal(engine_), truth_.repeatability_rad * normal(engine_)};
  BoardView view;
  view.stamp_us = stamp_us;
  const double stamp_s = toSeconds(stamp_us);
  const double middle_row = 0.5 * (truth_.intrinsics.height - 1);
  constexpr double kNowhere = 1e9;
  Eigen::Vector2d first(kNowhere, kNowhere);
  Eigen::Vector2d right = first;
  Eigen::Vector2d above = first;
  for (int id = 0; id < board_.corners(); ++id) {
    const Eigen::Vector3d p = cornerPosition(board_, id);
    auto px = project(p, stamp_s, noise);
    // The row at whose time the corner was exposed is its own.
    for (int i = 0; i < 3 && px; ++i) {
      px = project(p, stamp_s + truth_.row_time_s * (px->y() - middle_row), noise);
    }
    if (id == 0) first = px.value_or(first);
    if (id == 1) right = px.value_or(right);
    if (id == board_.cornerColumns()) above = px.value_or(above);
    if (!px || px->x() < 4 || px->y() < 4 || px->x() > truth_.intrinsics.width - 5 ||
        px->y() > truth_.intrinsics.height - 5) {
      continue;
    }
    const Eigen::Vector2d seen =
        *px + truth_.corner_sigma_px * Eigen::Vector2d(normal(engine_), normal(engine_));
    view.corners.push_back({id, seen, 0.2});
  }
  const Eigen::Vector2d across = right - first;
  const Eigen::Vector2d up = above - first;
  const bool fine = std::abs(across.x() * up.y() - across.y() * up.x()) >= kLeastSquare_px2;
  if (view.corners.size() < kLeastCorners || !fine) view.corners.clear();
  return view;
}

void SimulatedBoardRobot::look(StampUs stamp_us, BodyDrive& drive) {
  BoardView seen = viewAt(stamp_us);
  if (seen.corners.empty()) return;
  // Where the described robot sees the board.
  const BodyParameters described = nominalBody(describedMount(), record_.intrinsics, kDescribedBase_m);
  if (const auto board = boardPoseFrom(record_.intrinsics, board_, seen)) {
    const Eigen::Vector3d p = middleFromRobot(cameraPose(described, head_.angles()), *board, board_, place_);
    drive.seen(now_us_, transform(odometry_, p));
  }
  record_.views.push_back(std::move(seen));
}

BodyRecord SimulatedBoardRobot::run(BodyDrive& drive) {
  // An image is there when its last row was exposed.
  constexpr StampUs kReadOut_us = 30'000;
  std::optional<StampUs> exposed_us;
  while (drive.phase() != BodyDrivePhase::kDone && drive.phase() != BodyDrivePhase::kStopped) {
    const BodyDriveCommand command = drive.update({now_us_, head_.angles(), odometry_});
    if (command.head) head_.command(*command.head);
    if (command.take_view) exposed_us = now_us_;
    step(command.v_mps, command.w_radps);
    if (!exposed_us || now_us_ < *exposed_us + kReadOut_us) continue;
    look(*exposed_us, drive);
    exposed_us.reset();
  }
  for (int i = 0; i < 50; ++i) step(0.0, 0.0);
  return record_;
}

void SimulatedBoardRobot::move(double v_mps, double w_radps, double seconds) {
  for (int i = 0; i < static_cast<int>(seconds / kStep_s); ++i) step(v_mps, w_radps);
  for (int i = 0; i < 100; ++i) step(0.0, 0.0);
}

BodyErrors errorsOf(const BodyParameters& estimate, const TrueRobot& truth) {
  BodyErrors e;
  const BodyParameters real = soughtParameters(truth);
  e.place = placeOf(cameraPose(estimate, {})) - placeOf(cameraPose(real, {}));
  for (int pan = -90; pan <= 90; pan += 45) {
    for (int tilt = -30; tilt <= 0; tilt += 15) {
      const PanTilt reported{degToRad(pan), degToRad(tilt)};
      const Eigen::Matrix3d R =
          cameraPose(estimate, reported).linear().transpose() * cameraPose(real, reported).linear();
      e.worst_angle_rad = std::max(e.worst_angle_rad, Eigen::AngleAxisd(R).angle());
    }
  }
  const auto error = [&](BodyIndex index) { return estimate.body[index] - real.body[index]; };
  e.pan_scale = estimate.body[kPanScale] / truth.pan_scale - 1.0;
  e.tilt_scale = estimate.body[kTiltScale] / truth.tilt_scale - 1.0;
  e.joint_delay_s = error(kJointDelay);
  e.odometry_delay_s = estimate.wheels[kOdometryDelay] - truth.odometry_delay_s;
  e.backlash_rad = {error(kPanBacklash), error(kTiltBacklash)};
  e.row_time_s = error(kRowTime);
  const WheelModel believed{estimate.wheels[kLeftScale], estimate.wheels[kRightScale],
                            estimate.wheels[kBase]};
  e.ring_m = ringEnd(truth.wheels, believed).position().norm();
  e.ring_before_m = ringEnd(truth.wheels, {1.0, 1.0, kDescribedBase_m}).position().norm();
  return e;
}

}  // namespace vismem
