/// @file A small rigid motion of the plane. Pure.
#pragma once

#include <Eigen/Core>

namespace vismem {

/// p moves to pivot + shift + R(turn) (p - pivot), all in one frame. *Value.*
class PlanarIncrement {
 public:
  PlanarIncrement() = default;
  /// @param pivot     centre of the rotation [m].
  /// @param shift     [m].
  /// @param turn_rad  counter-clockwise.
  PlanarIncrement(const Eigen::Vector2d& pivot, const Eigen::Vector2d& shift, double turn_rad);

  Eigen::Vector2d apply(const Eigen::Vector2d& p) const { return pivot_ + shift_ + rotate(p - pivot_); }
  Eigen::Vector2d rotate(const Eigen::Vector2d& d) const {
    return {cos_ * d.x() - sin_ * d.y(), sin_ * d.x() + cos_ * d.y()};
  }
  const Eigen::Vector2d& shift() const { return shift_; }
  double turn_rad() const { return turn_rad_; }

 private:
  Eigen::Vector2d pivot_ = Eigen::Vector2d::Zero();
  Eigen::Vector2d shift_ = Eigen::Vector2d::Zero();
  double turn_rad_ = 0.0;
  double cos_ = 1.0;
  double sin_ = 0.0;
};

}  // namespace vismem
