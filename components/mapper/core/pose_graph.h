/// @file Relative poses of keyframes by odometry and by closings: which closings are consistent, and the
/// graph that keeps them. Pure. See B6.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "common/geometry/pose.h"

namespace vismem {

/// A relative pose found by a race: of keyframe `to` in the frame of keyframe `from`.
struct Closing {
  int from = 0;
  int to = 0;
  Pose2 T_from_to;
  Eigen::Matrix3d P = Eigen::Matrix3d::Identity();  ///< of (x, y, theta)
};

/// Drift of the poses that odometry and lines made together.
struct ChainErrors {
  double shift_per_m = 0.02;       ///< sigma, grows with the way
  double turn_per_sqrt_m = 0.012;  ///< sigma [rad], grows with the root of the way
  double least_m = 0.05;
  double least_rad = 0.02;
  double inflation = 2.0;  ///< of sigmas that the graph states: sightings are correlated
};

struct ConsistencyParams {
  ChainErrors chain;
  double chi2 = 11.345;        ///< 99 % of 3 degrees of freedom
  int least_closings = 2;      ///< that agree with each other ..
  double least_apart_m = 1.0;  ///< .. at places this far apart, so that they saw other landmarks
};

/// Ways of the keyframes since the first [m], one each.
using Ways = std::vector<double>;

/// The largest set of closings that agree pairwise and with the chain of poses (J. Mangelson et al.,
/// "Pairwise consistent measurement set maximization for robust multi-robot map merging", 2018).
/// @param P_chain  covariance of `to` relative to `from` by the graph alone, of each closing; empty: by the
/// way.
/// @return indices, in rising order; empty if fewer agree than asked for.
std::vector<int> consistentClosings(const std::vector<Pose2>& poses, const Ways& ways,
                                    const std::vector<Closing>& closings, const ConsistencyParams& params,
                                    const std::vector<Eigen::Matrix3d>& P_chain = {});

enum class RobustKernel { kLeastSquares, kCauchy, kGraduated };

struct PoseGraphResult {
  std::vector<Pose2> poses;
  std::vector<double> weights;  ///< of the closings, 0..1
  bool usable = false;
};

/// Poses with the first one fixed. Odometry's increments are taken from `poses`.
/// kCauchy begins at them; kGraduated is graduated non-convexity with truncated least squares (H. Yang et
/// al., 2020), which begins at the least squares solution of all closings.
PoseGraphResult solvePoseGraph(const std::vector<Pose2>& poses, const Ways& ways,
                               const std::vector<Closing>& closings, RobustKernel kernel,
                               const ChainErrors& chain);

/// The closings that both robust kernels keep: wrong closings that agree with each other deceive the
/// graduated one, a drift of half a corridor's period the other.
std::vector<int> closingsKeptByBoth(const std::vector<Pose2>& poses, const Ways& ways,
                                    const std::vector<Closing>& closings, const ChainErrors& chain);

}  // namespace vismem
