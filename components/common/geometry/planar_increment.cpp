#include "common/geometry/planar_increment.h"

#include <cmath>

namespace vismem {

Eigen::Vector2d PlanarIncrement::apply(const Eigen::Vector2d& p) const {
  const double c = std::cos(turn_rad);
  const double s = std::sin(turn_rad);
  const Eigen::Vector2d d = p - pivot;
  return pivot + shift + Eigen::Vector2d(c * d.x() - s * d.y(), s * d.x() + c * d.y());
}

}  // namespace vismem
