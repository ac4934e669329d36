#include "common/geometry/planar_increment.h"

#include <cmath>

namespace vismem {

PlanarIncrement::PlanarIncrement(const Eigen::Vector2d& pivot, const Eigen::Vector2d& shift, double turn_rad)
    : pivot_(pivot), shift_(shift), turn_rad_(turn_rad), cos_(std::cos(turn_rad)), sin_(std::sin(turn_rad)) {}

}  // namespace vismem
