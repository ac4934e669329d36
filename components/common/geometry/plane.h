/// @file Vectors of a plane: cross product and quarter turn. Pure.
#pragma once

#include <Eigen/Core>

namespace vismem {

/// z of the cross product a x b: |a| |b| sin(angle from a to b). Positive where b points to the left of a.
inline double cross2(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// `v` turned by +90 degrees, counter-clockwise: the normal to the left of a direction, of the same length.
inline Eigen::Vector2d turned90(const Eigen::Vector2d& v) {
  return {-v.y(), v.x()};
}

}  // namespace vismem
