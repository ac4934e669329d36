/// @file A small rigid motion of the plane. Pure.
#pragma once

#include <Eigen/Core>

namespace vismem {

/// p moves to pivot + shift + R(turn) (p - pivot), all in one frame. *Value.*
struct PlanarIncrement {
  Eigen::Vector2d pivot = Eigen::Vector2d::Zero();  ///< centre of the rotation [m]
  Eigen::Vector2d shift = Eigen::Vector2d::Zero();  ///< [m]
  double turn_rad = 0.0;                            ///< counter-clockwise

  Eigen::Vector2d apply(const Eigen::Vector2d& p) const;
};

}  // namespace vismem
