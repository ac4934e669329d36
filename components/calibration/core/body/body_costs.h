/// @file Residuals of the least squares of `calibrate body`, as functors for Ceres. Pure.
/// See B5: corners of the board and travel of the wheels.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "calibration/core/body/body_parameters.h"
#include "calibration/core/body/body_record.h"
#include "calibration/core/body/joint_path.h"
#include "calibration/core/odometry/wheel_path.h"

namespace vismem {

inline double scalarOf(double value) {
  return value;
}
template <typename Jet>
double scalarOf(const Jet& jet) {
  return jet.a;
}

/// p turned by -angle about an axis: 0 x, 1 y, 2 z.
template <typename T>
void turnBack(int axis, const T& angle, Eigen::Matrix<T, 3, 1>& p) {
  using std::cos;
  using std::sin;
  const T c = cos(angle);
  const T s = sin(angle);
  const int i = (axis + 1) % 3;
  const int j = (axis + 2) % 3;
  const T a = p[i];
  p[i] = c * a + s * p[j];
  p[j] = c * p[j] - s * a;
}

/// The board's middle in its own frame.
inline Eigen::Vector3d middlePosition(const BoardSpec& board) {
  return {0.5 * board.columns * board.square_m.x(), 0.5 * board.rows * board.square_m.y(), 0.0};
}

/// A point of the board on the floor or wall, in world coordinates: z up, the board's nominal pose at its
/// origin. The board turns about its middle.
template <typename T>
Eigen::Matrix<T, 3, 1> worldOfBoard(const T* body, BoardPlace place, const Eigen::Vector3d& p_board,
                                    const Eigen::Vector3d& middle) {
  const Eigen::Vector3d d = p_board - middle;
  Eigen::Matrix<T, 3, 1> p(T(d.x()), T(d.y()), T(d.z()));
  turnBack<T>(0, -body[kBoardRoll], p);
  turnBack<T>(1, -body[kBoardPitch], p);
  p += middle.cast<T>();
  if (place == BoardPlace::kWall) p = Eigen::Matrix<T, 3, 1>(p[0], -p[2], p[1]);
  p[2] += body[kBoardHeight];
  return p;
}

/// Distances of the observed corners of one view from their projections, in standard deviations: two
/// residuals a corner. Blocks: body, lens, robot pose at the frame's stamp (x, y, heading in world),
/// deviations of pan and tilt.
struct ViewCost {
  /// That the rows of an image are cut into: the board is placed at the time of each end, and between two
  /// ends linearly. End 0 is the first row, end kPieces the last.
  static constexpr int kPieces = 4;

  struct Corner {
    Eigen::Vector2d pixel;
    Eigen::Vector2d p_board;
    double inverse_sigma = 1.0;
    double share = 0.5;  ///< of the last row's time in that of the corner's row; the rest is the first row's
  };
  std::vector<Corner> corners;
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  BoardPlace place = BoardPlace::kFloor;
  Eigen::Vector2d centre =
      Eigen::Vector2d::Zero();  ///< described principal point: its ray is the camera's axis
  const JointPath* joints = nullptr;
  double stamp_s = 0.0;
  double half_rows = 0.0;                                   ///< from the middle row to the last
  std::array<std::array<MotorLead, 2>, kPieces + 1> leads;  ///< of pan and tilt, at each end
  double v_mps = 0.0;                                       ///< of the robot at the stamp
  double w_radps = 0.0;

  /// Rows from the middle one to an end.
  double rowsLate(int end) const { return half_rows * (2.0 * end / kPieces - 1.0); }

  /// A point of the board in the camera's body axes (x ahead, y left, z up), at the time of an end.
  template <typename T>
  Eigen::Matrix<T, 3, 1> toCamera(const T* body, const T* lens, const T* pose, const T* deviation,
                                  const Eigen::Vector3d& p_board, int end) const {
    using std::cos;
    using std::sin;
    const T late = body[kRowTime] * rowsLate(end);
    Eigen::Matrix<T, 3, 1> p = worldOfBoard<T>(body, place, p_board, middle);
    // World to robot at the row's time.
    const T heading = pose[2] + late * w_radps;
    p[0] -= pose[0] + late * v_mps * cos(pose[2]);
    p[1] -= pose[1] + late * v_mps * sin(pose[2]);
    turnBack<T>(2, heading, p);
    // Robot to the unit.
    for (int i = 0; i < 3; ++i) p[i] -= body[kUnitX + i];
    turnBack<T>(2, body[kUnitYaw], p);
    turnBack<T>(1, body[kUnitPitch], p);
    turnBack<T>(0, body[kUnitRoll], p);
    // Unit to head.
    const T time = body[kJointDelay] + late + stamp_s;
    const Eigen::Matrix<T, 2, 1> reading = joints->at<T>(time, scalarOf(time));
    const auto angle = [&](std::size_t j) {
      const T& backlash = body[kPanBacklash + j];
      return leads[static_cast<std::size_t>(end)][j].template headAngle<T>(
                 body[kPanScale + j], backlash, scalarOf(backlash), reading[static_cast<int>(j)]) +
             deviation[j];
    };
    turnBack<T>(2, angle(0), p);
    turnBack<T>(0, body[kAxisSkew], p);
    turnBack<T>(1, -angle(1), p);
    // Head to the camera's body.
    for (int i = 0; i < 3; ++i) p[i] -= body[kCameraX + i];
    turnBack<T>(2, body[kCameraYaw], p);
    turnBack<T>(1, body[kCameraPitch], p);
    turnBack<T>(0, body[kCameraRoll], p);
    // An error of the principal point moves nothing else: the described one keeps its ray.
    turnBack<T>(2, (T(centre.x()) - lens[kCx]) / lens[kFx], p);
    turnBack<T>(1, (lens[kCy] - T(centre.y())) / lens[kFy], p);
    return p;
  }

  template <typename T>
  bool operator()(const T* body, const T* lens, const T* pose, const T* deviation, T* residual) const {
    // The board's plane, origin and axes. One piece would not do: a head that speeds up during the image
    // bends the way of a point.
    Eigen::Matrix<T, 3, 1> plane[kPieces + 1][3];
    for (int end = 0; end <= kPieces; ++end) {
      plane[end][0] = toCamera<T>(body, lens, pose, deviation, Eigen::Vector3d::Zero(), end);
      plane[end][1] = toCamera<T>(body, lens, pose, deviation, Eigen::Vector3d::UnitX(), end) - plane[end][0];
      plane[end][2] = toCamera<T>(body, lens, pose, deviation, Eigen::Vector3d::UnitY(), end) - plane[end][0];
    }
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const Corner& c = corners[i];
      const int piece = std::clamp(static_cast<int>(kPieces * c.share), 0, kPieces - 1);
      const double share = kPieces * c.share - piece;
      const auto& from = plane[piece];
      const auto& to = plane[piece + 1];
      Eigen::Matrix<T, 3, 1> p;
      for (int k = 0; k < 3; ++k) {
        const T first = from[0][k] + from[1][k] * c.p_board.x() + from[2][k] * c.p_board.y();
        const T last = to[0][k] + to[1][k] * c.p_board.x() + to[2][k] * c.p_board.y();
        p[k] = first * (1.0 - share) + last * share;
      }
      if (!project<T>(lens, p, c, residual + 2 * i)) return false;
    }
    return true;
  }

 private:
  /// @return false behind the camera: the step was too long.
  template <typename T>
  static bool project(const T* lens, const Eigen::Matrix<T, 3, 1>& p, const Corner& c, T* residual) {
    constexpr double kNearest_m = 0.01;
    if (scalarOf(p[0]) < kNearest_m) return false;
    const T x = -p[1] / p[0];
    const T y = -p[2] / p[0];
    const T r2 = x * x + y * y;
    const T radial = 1.0 + r2 * (lens[kK1] + r2 * (lens[kK2] + r2 * lens[kK3]));
    const T u = x * radial + 2.0 * lens[kP1] * x * y + lens[kP2] * (r2 + 2.0 * x * x);
    const T v = y * radial + lens[kP1] * (r2 + 2.0 * y * y) + 2.0 * lens[kP2] * x * y;
    residual[0] = (lens[kFx] * u + lens[kCx] - c.pixel.x()) * c.inverse_sigma;
    residual[1] = (lens[kFy] * v + lens[kCy] - c.pixel.y()) * c.inverse_sigma;
    return true;
  }
};

/// Ratio of both focal lengths against the described one. Block: lens.
struct AspectCost {
  double fx = 1.0;  ///< as described
  double fy = 1.0;
  double inverse_sigma = 1.0;

  template <typename T>
  bool operator()(const T* lens, T* residual) const {
    residual[0] = (lens[kFy] / fy - lens[kFx] / fx) * inverse_sigma;
    return true;
  }
};

/// Motion between two robot poses against that of the wheels, whitened. Blocks: wheels, both poses.
struct WheelCost {
  const WheelPath* path = nullptr;
  double from_s = 0.0;
  double to_s = 0.0;
  Eigen::Matrix3d whitening = Eigen::Matrix3d::Identity();  ///< inverse Cholesky factor of the covariance

  template <typename T>
  bool operator()(const T* wheels, const T* from, const T* to, T* residual) const {
    using std::cos;
    using std::sin;
    const T from_time = wheels[kOdometryDelay] + from_s;
    const T to_time = wheels[kOdometryDelay] + to_s;
    const Eigen::Matrix<T, 3, 1> expected =
        path->motion<T>(wheels[kLeftScale], wheels[kRightScale], wheels[kBase], from_time, to_time,
                        scalarOf(from_time), scalarOf(to_time));
    const T dx = to[0] - from[0];
    const T dy = to[1] - from[1];
    const T c = cos(from[2]);
    const T s = sin(from[2]);
    T turn = to[2] - from[2] - expected[2];
    turn -= T(2.0 * M_PI * std::round(scalarOf(turn) / (2.0 * M_PI)));
    const Eigen::Matrix<T, 3, 1> error(c * dx + s * dy - expected[0], c * dy - s * dx - expected[1], turn);
    Eigen::Map<Eigen::Matrix<T, 3, 1>>(residual).noalias() = whitening.cast<T>() * error;
    return true;
  }
};

}  // namespace vismem
