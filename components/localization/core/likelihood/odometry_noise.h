/// @file Random errors of odometry. Pure. See B2, L12.
#pragma once

#include <Eigen/Core>

#include "common/config/parameter_visitor.h"

namespace vismem {

/// Standard deviations that grow with the way and the turn, beside the lasting errors (OdometryBias).
struct OdometryNoise {
  double share = 0.04;       ///< of the position per metre travelled
  double turn_share = 0.10;  ///< of the heading per radian turned
  double turn_per_m = 0.10;  ///< of the heading per metre travelled [rad/m]

  /// Variances of (x, y, theta) after a motion [m^2, m^2, rad^2]. @param turned_rad >= 0.
  Eigen::Vector3d variances(double travelled_m, double turned_rad) const {
    const double std_m = share * travelled_m;
    const double std_rad = turn_share * turned_rad + turn_per_m * travelled_m;
    return {std_m * std_m, std_m * std_m, std_rad * std_rad};
  }

  void visit(ParameterVisitor& v) {
    v.real(expert("OdometryShare", "error of odometry per metre (sigma)"), share, 0.0, 10.0);
    v.real(expert("OdometryTurnShare", "error of the heading per radian turned (sigma)"), turn_share, 0.0,
           10.0);
    v.angle(expert("OdometryTurn_degpm", "error of the heading per metre (sigma)"), turn_per_m, 0.0, 180.0);
  }
};

}  // namespace vismem
