/// @file A simulated robot beside a board: the simulator's kinematics, and corner observations computed by a
/// camera model (no image is rendered). Its truth differs from its description.
#pragma once

#include <optional>
#include <random>
#include <vector>

#include "calibration/core/body/body_drive.h"
#include "calibration/core/body/body_estimator.h"
#include "common/kinematics/kinematics.h"

namespace vismem {

/// The true robot. Described: CameraMount{0 0 0.45, identity}, joints and wheels without errors, no delays.
struct TrueRobot {
  CameraMount mount;
  CameraIntrinsics intrinsics;
  CameraIntrinsics stated;    ///< the lens as its images state it; boardCamera() by default
  double pan_zero_rad = 0.0;  ///< true angle = zero + scale * reported
  double tilt_zero_rad = 0.0;
  double pan_scale = 1.0;
  double tilt_scale = 1.0;
  double axis_skew_rad = 0.0;
  double repeatability_rad = 0.0;  ///< normal error of each view's joint angles
  PanTilt backlash_rad{0.0, 0.0};  ///< of the true angles
  WheelModel wheels;               ///< true travel = scale * reported; true base
  double wheel_noise_sqrtm = 0.0;  ///< of each wheel after one metre [m]
  double joint_delay_s = 0.0;      ///< stamps of joint samples are late by this
  double odometry_delay_s = 0.0;
  double row_time_s = 0.0;
  double corner_sigma_px = 0.2;
  Eigen::Vector2d board_tilt_rad = Eigen::Vector2d::Zero();  ///< roll, pitch about its middle
  double board_scale = 1.0;                                  ///< printed size over described size
  Pose2 start{-1.1, 0.1, 0.0};                               ///< from the board's middle
  BoardSpec board;                                           ///< a3Board() by default

  TrueRobot();
};

/// Errors drawn by seed: mount askew by up to 3 degrees and 3 cm, zeros up to 5 degrees, scales up to 3 %,
/// wheels up to 3 % off, delays up to 150 ms, backlash up to 0.5 degrees.
TrueRobot drawnRobot(std::uint64_t seed);

/// Camera of 640x480 and 60 degrees without distortion.
CameraIntrinsics boardCamera();
/// Squares of 35 mm, 10 x 7: about A3.
BoardSpec a3Board();
CameraMount describedMount();
inline constexpr double kDescribedBase_m = 0.33;

/// The truth as parameters: zeros folded into yaw of the unit and pitch of the camera.
BodyParameters parametersOf(const TrueRobot& truth);
/// What a calibration should find: the same, with the camera's axis in the ray of the stated principal point.
BodyParameters soughtParameters(const TrueRobot& truth);
/// True pose of the camera on the robot for reported joint angles.
Pose3 trueCameraPose(const TrueRobot& robot, const PanTilt& reported);

class SimulatedBoardRobot {
 public:
  SimulatedBoardRobot(const TrueRobot& truth, std::uint64_t seed, BoardPlace place = BoardPlace::kFloor);

  /// Drives until the plan is done or stopped. @return what was recorded since the beginning.
  BodyRecord run(BodyDrive& drive);
  /// Drives at even speeds, then stands for a second.
  void move(double v_mps, double w_radps, double seconds);
  /// Farthest distance of the robot from the board's middle so far [m].
  double farthest() const { return farthest_; }
  double seconds() const { return toSeconds(now_us_); }
  const Pose2& truePose() const { return pose_; }

 private:
  /// Truth at one time.
  struct State {
    PanTilt head;  ///< behind the backlash, in the scale of the reports
    Pose2 pose;
  };

  void step(double v_mps, double w_radps);
  State stateAt(double time_s) const;
  void look(StampUs stamp_us, BodyDrive& drive);
  /// Corners of an image whose middle row was exposed at a stamp; empty if fewer than 8 are visible.
  BoardView viewAt(StampUs stamp_us);
  /// Raw pixel of a point of the board; empty behind the camera.
  std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& p_board, double time_s,
                                         const PanTilt& noise) const;

  TrueRobot truth_;
  BoardPlace place_;
  BoardSpec board_;
  std::mt19937_64 engine_;
  SimulatedPanTilt head_;
  std::vector<State> history_;  ///< every step since time 0
  Pose2 pose_;
  Pose2 odometry_;
  double v_ = 0.0;  ///< as its encoders measure it
  double w_ = 0.0;
  StampUs now_us_ = 0;
  double farthest_ = 0.0;
  BodyRecord record_;
};

/// Errors of an estimate against the truth, over the joints' working range.
struct BodyErrors {
  CameraPlace place = CameraPlace::Zero();  ///< of the camera on the robot at joint readings 0
  double worst_angle_rad = 0.0;             ///< over a grid of joint readings
  double pan_scale = 0.0;
  double tilt_scale = 0.0;
  Eigen::Vector2d backlash_rad = Eigen::Vector2d::Zero();  ///< of pan and tilt
  double joint_delay_s = 0.0;
  double odometry_delay_s = 0.0;
  double row_time_s = 0.0;
  double ring_m = 0.0;         ///< odometry's end after a ring of 25 m, without noise of the wheels
  double ring_before_m = 0.0;  ///< the same before the calibration
};
BodyErrors errorsOf(const BodyParameters& estimate, const TrueRobot& truth);

}  // namespace vismem
