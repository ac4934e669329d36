/// @file Bounds of the lasting errors that DriftFilter and MapFilter estimate. Pure. See M6.
#pragma once

#include <Eigen/Core>

#include "active_visual_memory/core/ground/camera_tilt.h"

namespace vismem {

/// Share of the stated heading drift that changes from step to step and is no lasting rate.
inline constexpr double kUnbiasedDriftShare = 0.5;

/// Bounds the tilt by `max_sigmas` prior sigmas, and its variances from below by `floor_rad`.
/// @param P  covariance of the tilt [rad^2].
void limitCameraTilt(const TiltPrior& params, CameraTilt& camera_tilt, Eigen::Ref<CameraTiltCovariance> P);

/// Bounds the heading rates by three times the stated drift, and their sigmas from below by a tenth of it.
/// @param most  stated heading drift of the odometry [rad/rad, rad/m].
/// @param P     covariance of the rates.
void limitRates(const Eigen::Vector2d& most, Eigen::Vector2d& rates, Eigen::Ref<Eigen::Matrix2d> P);

}  // namespace vismem
