/// @file Bounds of the lasting errors that MapFilter estimates. Pure. See M6.
#pragma once

#include <Eigen/Core>

#include "active_visual_memory/core/ground/camera_tilt.h"

namespace vismem {

/// Share of the stated heading drift that changes from step to step and is no lasting rate.
inline constexpr double kUnbiasedDriftShare = 0.5;

/// Bounds the tilt by `max_sigmas` prior sigmas, and its variances from below by `floor_rad`.
/// @param P  covariance of the tilt [rad^2].
void limitCameraTilt(const TiltPrior& params, CameraTilt& camera_tilt, Eigen::Ref<CameraTiltCovariance> P);

/// Bounds the lasting errors of odometry by three times their prior sigmas, and their sigmas from below by a tenth of
/// those.
/// @param most  prior sigmas.
/// @param P     covariance of the rates.
void limitRates(const Eigen::Ref<const Eigen::VectorXd>& most, Eigen::Ref<Eigen::VectorXd> rates,
                Eigen::Ref<Eigen::MatrixXd> P);

}  // namespace vismem
