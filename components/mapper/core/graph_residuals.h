/// @file Residuals of the graph of poses, line landmarks, camera tilt and odometry errors, for automatic
/// differentiation. Pure. All residuals are in sigmas. See B6.
///
/// Parameter blocks: keyframe (x, y, theta, roll and pitch of its frame tilt), line (offset, turn), end (t),
/// circle (shift of the centre, change of both radii), camera tilt (CameraTilt), odometry errors
/// (MapState::odometry).
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/LU>
#include <array>
#include <cmath>

#include "mapper/core/keyframe.h"
#include "mapper/core/landmarks.h"

namespace vismem::graph {

constexpr int kKeyframe = 5;
constexpr int kLine = 2;
constexpr int kEnd = 1;
constexpr int kCircle = 4;
constexpr int kTilt = 4;
constexpr int kOdometry = 3;

template <typename T>
using Vector2 = Eigen::Matrix<T, 2, 1>;
template <typename T>
using Vector3 = Eigen::Matrix<T, 3, 1>;

/// Rotation by a small vector, exact to its third order.
template <typename T>
Vector3<T> turnedBy(const Vector3<T>& w, const Vector3<T>& v) {
  const Vector3<T> wv = w.cross(v);
  return v + wv + T(0.5) * w.cross(wv);
}

template <typename T>
T wrapped(const T& angle) {
  using std::floor;
  const double turns = 2.0 * 3.14159265358979323846;
  return angle - T(turns) * floor((angle + T(0.5 * turns)) / T(turns));
}

/// A direction of the robot's frame in the camera's, with the tilt errors of mount, frame and camera.
template <typename T>
Vector3<T> toCamera(const Eigen::Matrix3d& R_robot_camera, const T* tilt, const T* frame_tilt,
                    const Vector3<T>& v_robot) {
  const Vector3<T> mount(-(tilt[0] + frame_tilt[0]), -(tilt[1] + frame_tilt[1]), T(0.0));
  const Vector3<T> camera(-tilt[2], T(0.0), -tilt[3]);
  const Vector3<T> v = R_robot_camera.transpose().cast<T>() * turnedBy(mount, v_robot);
  return turnedBy(camera, v);
}

/// A direction of the camera's frame in the robot's.
template <typename T>
Vector3<T> toRobot(const Eigen::Matrix3d& R_robot_camera, const T* tilt, const T* frame_tilt,
                   const Vector3<T>& v_camera) {
  const Vector3<T> mount(tilt[0] + frame_tilt[0], tilt[1] + frame_tilt[1], T(0.0));
  const Vector3<T> camera(tilt[2], T(0.0), tilt[3]);
  const Vector3<T> v = R_robot_camera.cast<T>() * turnedBy(camera, v_camera);
  return turnedBy(mount, v);
}

/// The landmark's line in the frame of the anchor: a point and the direction.
template <typename T>
void lineOf(const Eigen::Vector2d& reference, double direction_rad, const T* line, const T& t,
            Vector2<T>& point, Vector2<T>& along) {
  using std::cos;
  using std::sin;
  const T angle = T(direction_rad) + line[1];
  along = Vector2<T>(cos(angle), sin(angle));
  const Vector2<T> normal(-along.y(), along.x());
  point = reference.cast<T>() + line[0] * normal + t * along;
}

/// From the frame of one pose to that of another.
template <typename T>
void between(const T* from, const T* to, Vector2<T>& point, Vector2<T>& along) {
  using std::cos;
  using std::sin;
  const auto rotate = [](const T& angle, const Vector2<T>& v) {
    const T c = cos(angle);
    const T s = sin(angle);
    return Vector2<T>(c * v.x() - s * v.y(), s * v.x() + c * v.y());
  };
  const Vector2<T> shift(from[0] - to[0], from[1] - to[1]);
  point = rotate(from[2] - to[2], point) + rotate(-to[2], shift);
  along = rotate(from[2] - to[2], along);
}

/// What a sighting measures: ends of the segment as rays of the camera.
struct Rays {
  Eigen::Matrix3d R_robot_camera = Eigen::Matrix3d::Identity();
  Eigen::Vector3d camera = Eigen::Vector3d::Zero();  ///< in the robot's frame [m]
  Eigen::Vector2d a = Eigen::Vector2d::Zero();       ///< at depth 1
  Eigen::Vector2d b = Eigen::Vector2d::Zero();
  double focal_px = 1.0;
  /// Height of the camera above what the body tilts about in single images: a tilt moves the camera, too [m].
  double lever_m = 0.0;

  /// From the camera to a floor point of the robot's frame.
  template <typename T>
  Vector3<T> to(const Vector2<T>& p, const T* frame_tilt) const {
    return {p.x() - T(camera.x()) - T(lever_m) * frame_tilt[1],
            p.y() - T(camera.y()) + T(lever_m) * frame_tilt[0], T(-camera.z())};
  }
  /// Where a direction of the robot's frame meets the floor. @return false for none.
  template <typename T>
  bool floorAt(const Vector3<T>& direction, const T* frame_tilt, Vector2<T>& p) const {
    if (!(direction.z() < T(-1e-3))) return false;  // a low camera sees far lines at flat angles
    const T depth = T(-camera.z()) / direction.z();
    p = Vector2<T>(T(camera.x()) + T(lever_m) * frame_tilt[1] + depth * direction.x(),
                   T(camera.y()) - T(lever_m) * frame_tilt[0] + depth * direction.y());
    return true;
  }
};

/// Distances of both observed ends from the projected line [sigma].
struct LineResidual {
  Rays rays;
  Eigen::Vector2d reference;
  double direction_rad;
  double sigma_px;

  template <typename T>
  bool evaluate(const T* anchor, const T* keyframe, const T* line, const T* tilt, T* residual) const {
    using std::sqrt;
    Vector2<T> q;
    Vector2<T> u;
    lineOf(reference, direction_rad, line, T(0.0), q, u);
    if (anchor != keyframe) between(anchor, keyframe, q, u);
    const Vector3<T> from = rays.to(q, keyframe + 3);
    const Vector3<T> plane = from.cross(Vector3<T>(u.x(), u.y(), T(0.0)));
    const Vector3<T> n = toCamera(rays.R_robot_camera, tilt, keyframe + 3, plane);
    const T norm = sqrt(n.x() * n.x() + n.y() * n.y() + T(1e-12));
    const double factor = rays.focal_px / sigma_px;
    residual[0] = T(factor) * (n.x() * rays.a.x() + n.y() * rays.a.y() + n.z()) / norm;
    residual[1] = T(factor) * (n.x() * rays.b.x() + n.y() * rays.b.y() + n.z()) / norm;
    return true;
  }
  template <typename T>
  bool operator()(const T* anchor, const T* keyframe, const T* line, const T* tilt, T* residual) const {
    return evaluate(anchor, keyframe, line, tilt, residual);
  }
  template <typename T>
  bool operator()(const T* keyframe, const T* line, const T* tilt, T* residual) const {
    return evaluate(keyframe, keyframe, line, tilt, residual);
  }
};

/// Distance of an observed closed end from the projected one along the observed segment [sigma].
struct EndResidual {
  Rays rays;
  bool at_b;
  Eigen::Vector2d reference;
  double direction_rad;
  double sigma_px;

  template <typename T>
  bool evaluate(const T* anchor, const T* keyframe, const T* line, const T* end, const T* tilt,
                T* residual) const {
    Vector2<T> q;
    Vector2<T> u;
    lineOf(reference, direction_rad, line, end[0], q, u);
    if (anchor != keyframe) between(anchor, keyframe, q, u);
    const Vector3<T> ray = rays.to(q, keyframe + 3);
    const Vector3<T> p = toCamera(rays.R_robot_camera, tilt, keyframe + 3, ray);
    if (!(p.z() > T(0.02))) return false;
    const Eigen::Vector2d& seen = at_b ? rays.b : rays.a;
    const Eigen::Vector2d along = (rays.b - rays.a).normalized();
    const T off = (p.x() / p.z() - T(seen.x())) * T(along.x()) + (p.y() / p.z() - T(seen.y())) * T(along.y());
    residual[0] = T(rays.focal_px / sigma_px) * off;
    return true;
  }
  template <typename T>
  bool operator()(const T* anchor, const T* keyframe, const T* line, const T* end, const T* tilt,
                  T* residual) const {
    return evaluate(anchor, keyframe, line, end, tilt, residual);
  }
  template <typename T>
  bool operator()(const T* keyframe, const T* line, const T* end, const T* tilt, T* residual) const {
    return evaluate(keyframe, keyframe, line, end, tilt, residual);
  }
};

/// Distances of the points where a seen chord cuts its arc from the circle [sigma].
struct CircleResidual {
  Rays rays;  ///< of both cuts
  Eigen::Vector2d centre;
  double radius_m;
  bool is_left;
  double sigma_m;

  template <typename T>
  bool evaluate(const T* anchor, const T* keyframe, const T* circle, const T* tilt, T* residual) const {
    using std::sqrt;
    for (int i = 0; i < 2; ++i) {
      const Eigen::Vector2d& seen = i == 0 ? rays.a : rays.b;
      const Vector3<T> ray(T(seen.x()), T(seen.y()), T(1.0));
      Vector2<T> p;
      if (!rays.floorAt(toRobot(rays.R_robot_camera, tilt, keyframe + 3, ray), keyframe + 3, p)) return false;
      Vector2<T> along(T(1.0), T(0.0));
      if (anchor != keyframe) between(keyframe, anchor, p, along);
      const Vector2<T> from = p - centre.cast<T>() - Vector2<T>(circle[0], circle[1]);
      const T distance = sqrt(from.squaredNorm() + T(1e-12));
      residual[i] = (distance - T(radius_m) - circle[is_left ? 3 : 2]) / T(sigma_m);
    }
    return true;
  }
  template <typename T>
  bool operator()(const T* anchor, const T* keyframe, const T* circle, const T* tilt, T* residual) const {
    return evaluate(anchor, keyframe, circle, tilt, residual);
  }
  template <typename T>
  bool operator()(const T* keyframe, const T* circle, const T* tilt, T* residual) const {
    return evaluate(keyframe, keyframe, circle, tilt, residual);
  }
};

/// Odometry between two keyframes, corrected by its lasting errors [sigma].
struct OdometryResidual {
  Pose2 measured;  ///< of the later keyframe in the frame of the earlier one
  double sigma_m;
  double sigma_rad;

  template <typename T>
  bool operator()(const T* from, const T* to, const T* errors, T* residual) const {
    using std::cos;
    using std::sin;
    const double way = std::hypot(measured.x, measured.y);
    const T turn = T(measured.theta) * (T(1.0) + errors[1]) + T(way) * errors[2];
    // The way lies half of the further turn aside.
    const T aside = T(0.5) * (turn - T(measured.theta));
    const T c = cos(aside) * (T(1.0) + errors[0]);
    const T s = sin(aside) * (T(1.0) + errors[0]);
    const T x = c * T(measured.x) - s * T(measured.y);
    const T y = s * T(measured.x) + c * T(measured.y);
    const T cf = cos(from[2]);
    const T sf = sin(from[2]);
    const T dx = to[0] - from[0];
    const T dy = to[1] - from[1];
    residual[0] = (cf * dx + sf * dy - x) / T(sigma_m);
    residual[1] = (-sf * dx + cf * dy - y) / T(sigma_m);
    residual[2] = wrapped(T(to[2] - from[2] - turn)) / T(sigma_rad);
    return true;
  }
};

/// A prior of independent values about zero [sigma]; values with a sigma of 0 are left out.
template <int N>
struct PriorResidual {
  int first;
  std::array<double, N> sigma;

  template <typename T>
  bool operator()(const T* values, T* residual) const {
    for (int i = 0; i < N; ++i) residual[i] = sigma[i] > 0.0 ? T(values[first + i] / T(sigma[i])) : T(0.0);
    return true;
  }
};

/// A line along or across the dominant direction of the place [sigma].
struct RightAngleResidual {
  double direction_rad;  ///< of the landmark in its anchor
  double sigma_rad;

  template <typename T>
  bool operator()(const T* anchor, const T* line, const T* dominant, T* residual) const {
    using std::sin;
    const T angle = anchor[2] + T(direction_rad) + line[1] - dominant[0];
    residual[0] = sin(T(2.0) * angle) / T(2.0 * sigma_rad);
    return true;
  }
};

/// Both ends of one landmark on the line of another [sigma]. Blocks: anchor, line, anchor, line.
struct StraightResidual {
  Eigen::Vector2d reference, reference_other;
  double direction_rad, direction_other_rad;
  double a_m, b_m;  ///< of the other one
  double sigma_m;

  template <typename T>
  bool operator()(const T* anchor, const T* line, const T* anchor_other, const T* line_other,
                  T* residual) const {
    return evaluate(anchor, line, anchor_other, line_other, residual);
  }
  /// Both in one anchor.
  template <typename T>
  bool operator()(const T* anchor, const T* line, const T* line_other, T* residual) const {
    return evaluate(anchor, line, anchor, line_other, residual);
  }
  template <typename T>
  bool evaluate(const T* anchor, const T* line, const T* anchor_other, const T* line_other,
                T* residual) const {
    Vector2<T> q;
    Vector2<T> u;
    lineOf(reference, direction_rad, line, T(0.0), q, u);
    for (int i = 0; i < 2; ++i) {
      Vector2<T> p;
      Vector2<T> along;
      lineOf(reference_other, direction_other_rad, line_other, T(i == 0 ? a_m : b_m), p, along);
      if (anchor != anchor_other) between(anchor_other, anchor, p, along);
      residual[i] = (u.x() * (p.y() - q.y()) - u.y() * (p.x() - q.x())) / T(sigma_m);
    }
    return true;
  }
};

/// Two landmarks at right angles [sigma]. Blocks as of StraightResidual.
struct SquareResidual {
  double direction_rad, direction_other_rad;
  double sigma_rad;

  template <typename T>
  bool operator()(const T* anchor, const T* line, const T* anchor_other, const T* line_other,
                  T* residual) const {
    using std::cos;
    residual[0] = cos(anchor[2] + T(direction_rad) + line[1] - anchor_other[2] - T(direction_other_rad) -
                      line_other[1]) /
                  T(sigma_rad);
    return true;
  }
  template <typename T>
  bool operator()(const T* /*anchor*/, const T* line, const T* line_other, T* residual) const {
    using std::cos;
    residual[0] = cos(T(direction_rad - direction_other_rad) + line[1] - line_other[1]) / T(sigma_rad);
    return true;
  }
};

/// A known place of an end along its line [sigma].
struct PlacedEndResidual {
  double t_m, sigma_m;

  template <typename T>
  bool operator()(const T* end, T* residual) const {
    residual[0] = (end[0] - T(t_m)) / T(sigma_m);
    return true;
  }
};

/// The distance of both ends of a landmark [sigma].
struct LengthResidual {
  double length_m, sigma_m;

  template <typename T>
  bool operator()(const T* a, const T* b, T* residual) const {
    residual[0] = (b[0] - a[0] - T(length_m)) / T(sigma_m);
    return true;
  }
};

/// A pose in the plane relative to another [sigma, whitened].
struct RelativePose {
  Pose2 measured;
  Eigen::Matrix3d whitening;  ///< square root of the information

  template <typename T>
  bool operator()(const T* from, const T* to, T* residual) const {
    using std::cos;
    using std::sin;
    const T c = cos(from[2]);
    const T s = sin(from[2]);
    const T dx = to[0] - from[0];
    const T dy = to[1] - from[1];
    Eigen::Matrix<T, 3, 1> off(c * dx + s * dy - T(measured.x), -s * dx + c * dy - T(measured.y),
                               wrapped(T(to[2] - from[2] - T(measured.theta))));
    off = whitening.cast<T>() * off;
    for (int i = 0; i < 3; ++i) residual[i] = off[i];
    return true;
  }
};

/// Of the information: W^T W = P^-1.
inline Eigen::Matrix3d whiteningOf(const Eigen::Matrix3d& P) {
  const Eigen::Matrix3d information = P.inverse();
  return Eigen::LLT<Eigen::Matrix3d>(0.5 * (information + information.transpose())).matrixU();
}

}  // namespace vismem::graph
