#include "active_visual_memory/core/drift_limits.h"

#include <algorithm>

namespace vismem {
namespace {

constexpr double kMostRate = 3.0;   // times what odometry is said to drift: no rate is believed larger
constexpr double kLeastRate = 0.1;  // of that: no rate counts as better known

}  // namespace

void keepWithin(const LeanParams& params, Lean& lean, Eigen::Ref<LeanCovariance> P) {
  const Lean most = params.most_sigmas * params.prior().diagonal().cwiseSqrt();
  lean = lean.cwiseMax(-most).cwiseMin(most).eval();
  for (int i = 0; i < 4; ++i) {
    const double least = std::min(params.floor_rad, most[i]);
    P(i, i) = std::max(P(i, i), least * least);
  }
}

void keepRatesWithin(const Eigen::Vector2d& most, Eigen::Vector2d& rates, Eigen::Ref<Eigen::Matrix2d> P) {
  rates = rates.cwiseMax(-kMostRate * most).cwiseMin(kMostRate * most).eval();
  for (int i = 0; i < 2; ++i) {
    const double least = kLeastRate * most[i];
    P(i, i) = std::max(P(i, i), least * least);
  }
}

}  // namespace vismem
