#include "active_visual_memory/core/estimation/state_limits.h"

#include <algorithm>

namespace vismem {
namespace {

constexpr double kMaxRate = 3.0;       // largest rate, in configured drifts
constexpr double kMinRateSigma = 0.1;  // least sigma of a rate, in configured drifts

}  // namespace

void limitCameraTilt(const TiltPrior& params, CameraTilt& camera_tilt, Eigen::Ref<CameraTiltCovariance> P) {
  const CameraTilt most = params.max_sigmas * params.prior().diagonal().cwiseSqrt();
  camera_tilt = camera_tilt.cwiseMax(-most).cwiseMin(most).eval();
  for (int i = 0; i < 4; ++i) {
    const double least = std::min(params.floor_rad, most[i]);
    P(i, i) = std::max(P(i, i), least * least);
  }
}

void limitRates(const Eigen::Ref<const Eigen::VectorXd>& most, Eigen::Ref<Eigen::VectorXd> rates,
                Eigen::Ref<Eigen::MatrixXd> P) {
  rates = rates.cwiseMax(-kMaxRate * most).cwiseMin(kMaxRate * most);
  for (Eigen::Index i = 0; i < most.size(); ++i) {
    const double least = kMinRateSigma * most[i];
    P(i, i) = std::max(P(i, i), least * least);
  }
}

}  // namespace vismem
