#include "localization/core/hypotheses/race.h"

#include <cmath>

#include "common/geometry/angles.h"

namespace vismem {

bool samePlace(const Pose2& a, const Pose2& b, const RaceParams& params) {
  return std::abs(a.x - b.x) <= params.same_place_m && std::abs(a.y - b.y) <= params.same_place_m &&
         std::abs(angleDifference(a.theta, b.theta)) <= params.same_place_rad;
}

}  // namespace vismem
