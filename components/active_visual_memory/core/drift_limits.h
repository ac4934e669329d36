/// @file What both filters of drift (DriftAlignment, JointAlignment) believe of lasting errors at most. Pure.
/// SPEC M1, M6.
#pragma once

#include <Eigen/Core>

#include "active_visual_memory/core/camera_lean.h"

namespace vismem {

inline constexpr double kChangingDrift = 0.5;  ///< share of the heading's drift that is no lasting rate

/// @param P of the lean, not smaller afterwards than LeanParams says.
void keepWithin(const LeanParams& params, Lean& lean, Eigen::Ref<LeanCovariance> P);

/// @param most what odometry is said to drift in its heading [rad/rad, rad/m]. @param P of the rates.
void keepRatesWithin(const Eigen::Vector2d& most, Eigen::Vector2d& rates, Eigen::Ref<Eigen::Matrix2d> P);

}  // namespace vismem
