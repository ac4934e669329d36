#include "mapper/core/pose_graph.h"

#include <ceres/ceres.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "common/geometry/angles.h"
#include "mapper/core/graph_residuals.h"

namespace vismem {
namespace {

constexpr double kKept = 0.5;  ///< least weight of a closing that a kernel keeps

Eigen::Vector3d differenceOf(const Pose2& measured, const Pose2& predicted) {
  const Pose2 off = inverse(measured) * predicted;
  return {off.x, off.y, off.theta};
}

/// Covariance of a chain of increments over a way, at its end.
Eigen::Matrix3d chainCovariance(const ChainErrors& errors, double way_m) {
  const double turn = std::hypot(errors.least_rad, errors.turn_per_sqrt_m * std::sqrt(way_m));
  // A heading error at the beginning moves the end aside.
  const double shift = std::hypot(errors.least_m, errors.shift_per_m * way_m, 0.6 * turn * way_m);
  return Eigen::Vector3d(shift * shift, shift * shift, turn * turn).asDiagonal();
}

double chi2Of(const Eigen::Vector3d& off, const Eigen::Matrix3d& P) {
  return off.dot(P.ldlt().solve(off));
}

Pose2 poseBetween(const std::vector<Pose2>& poses, int from, int to) {
  return inverse(poses[static_cast<std::size_t>(from)]) * poses[static_cast<std::size_t>(to)];
}

double wayBetween(const Ways& ways, int from, int to) {
  return std::abs(ways[static_cast<std::size_t>(to)] - ways[static_cast<std::size_t>(from)]);
}

bool agree(const std::vector<Pose2>& poses, const Ways& ways, const Closing& one, const Closing& other,
           const ConsistencyParams& params) {
  const Pose2 around =
      poseBetween(poses, one.from, other.from) * other.T_from_to * poseBetween(poses, other.to, one.to);
  const Eigen::Matrix3d P = one.P + other.P +
                            chainCovariance(params.chain, wayBetween(ways, one.to, other.to)) +
                            chainCovariance(params.chain, wayBetween(ways, one.from, other.from));
  return chi2Of(differenceOf(one.T_from_to, around), P) <= params.chi2;
}

class PoseProblem {
 public:
  PoseProblem(const std::vector<Pose2>& poses, const Ways& ways, const std::vector<Closing>& closings,
              const ChainErrors& chain)
      : odometry_(poses), ways_(ways), closings_(closings), chain_(chain) {
    for (const Pose2& pose : poses) blocks_.push_back({pose.x, pose.y, pose.theta});
  }

  bool solve(const std::vector<double>& weights, ceres::LossFunction* kernel) {
    ceres::Problem problem;
    constexpr int kPose = 3;
    using Cost = ceres::AutoDiffCostFunction<graph::RelativePose, 3, kPose, kPose>;
    const auto add = [&](int from, int to, const Pose2& T, const Eigen::Matrix3d& P,
                         ceres::LossFunction* loss) {
      problem.AddResidualBlock(new Cost(new graph::RelativePose{T, graph::whiteningOf(P)}), loss,
                               blocks_[static_cast<std::size_t>(from)].data(),
                               blocks_[static_cast<std::size_t>(to)].data());
    };
    for (int k = 1; k < static_cast<int>(blocks_.size()); ++k) {
      const double way = std::max(0.02, wayBetween(ways_, k - 1, k));
      const double turn = chain_.turn_per_sqrt_m * std::sqrt(way);
      const double shift = chain_.shift_per_m * std::sqrt(way);
      const Eigen::Matrix3d P = Eigen::Vector3d(shift * shift, shift * shift, turn * turn).asDiagonal();
      add(k - 1, k, poseBetween(odometry_, k - 1, k), P, nullptr);
    }
    for (std::size_t i = 0; i < closings_.size(); ++i) {
      if (weights[i] <= 1e-9) continue;
      const Closing& c = closings_[i];
      ceres::LossFunction* loss = new ceres::ScaledLoss(kernel, weights[i], ceres::DO_NOT_TAKE_OWNERSHIP);
      add(c.from, c.to, c.T_from_to, c.P, loss);
    }
    problem.SetParameterBlockConstant(blocks_.front().data());
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
    options.max_num_iterations = 60;
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
    return summary.IsSolutionUsable();
  }

  std::vector<double> chi2() const {
    std::vector<double> values;
    const std::vector<Pose2> at = poses();
    for (const Closing& c : closings_)
      values.push_back(chi2Of(differenceOf(c.T_from_to, poseBetween(at, c.from, c.to)), c.P));
    return values;
  }
  std::vector<Pose2> poses() const {
    std::vector<Pose2> result;
    for (const auto& b : blocks_) result.push_back({b[0], b[1], wrapAngle(b[2])});
    return result;
  }

 private:
  const std::vector<Pose2>& odometry_;
  const Ways& ways_;
  const std::vector<Closing>& closings_;
  const ChainErrors& chain_;
  std::vector<std::array<double, 3>> blocks_;
};

constexpr double kTruncation = 11.345;  ///< squared sigmas

std::vector<double> solveGraduated(PoseProblem& problem, std::size_t closings, bool& usable) {
  std::vector<double> weights(closings, 1.0);
  usable = problem.solve(weights, nullptr);
  const std::vector<double> first = problem.chi2();
  const double worst = *std::max_element(first.begin(), first.end());
  if (worst <= kTruncation) return weights;
  double mu = kTruncation / (2.0 * worst - kTruncation);
  constexpr int kMost = 60;
  constexpr double kGrowth = 1.4;
  for (int i = 0; i < kMost && usable; ++i, mu *= kGrowth) {
    const std::vector<double> r2 = problem.chi2();
    bool decided = true;
    for (std::size_t k = 0; k < closings; ++k) {
      if (r2[k] >= (mu + 1.0) / mu * kTruncation) {
        weights[k] = 0.0;
      } else if (r2[k] <= mu / (mu + 1.0) * kTruncation) {
        weights[k] = 1.0;
      } else {
        weights[k] = std::sqrt(kTruncation * mu * (mu + 1.0) / r2[k]) - mu;
        decided = false;
      }
    }
    usable = problem.solve(weights, nullptr);
    if (decided) break;
  }
  return weights;
}

/// Extends `chosen` by the candidates from `next` on; keeps the largest set in `best`.
void grow(const std::vector<std::vector<bool>>& agrees, std::size_t next, std::vector<int>& chosen,
          std::vector<int>& best, int& budget) {
  if (chosen.size() > best.size()) best = chosen;
  for (std::size_t i = next; i < agrees.size() && --budget > 0; ++i) {
    if (chosen.size() + (agrees.size() - i) <= best.size()) return;
    const bool fits = std::all_of(chosen.begin(), chosen.end(),
                                  [&](int c) { return agrees[static_cast<std::size_t>(c)][i]; });
    if (!fits) continue;
    chosen.push_back(static_cast<int>(i));
    grow(agrees, i + 1, chosen, best, budget);
    chosen.pop_back();
  }
}

}  // namespace

std::vector<int> consistentClosings(const std::vector<Pose2>& poses, const Ways& ways,
                                    const std::vector<Closing>& closings, const ConsistencyParams& params,
                                    const std::vector<Eigen::Matrix3d>& P_chain) {
  std::vector<int> candidates;
  const ChainErrors& chain = params.chain;
  const double inflated = chain.inflation * chain.inflation;
  const Eigen::Vector3d least(chain.least_m * chain.least_m, chain.least_m * chain.least_m,
                              chain.least_rad * chain.least_rad);
  for (int i = 0; i < static_cast<int>(closings.size()); ++i) {
    const Closing& c = closings[static_cast<std::size_t>(i)];
    Eigen::Matrix3d P = c.P;
    if (P_chain.empty()) {
      P += chainCovariance(chain, wayBetween(ways, c.from, c.to));
    } else {
      P += inflated * P_chain[static_cast<std::size_t>(i)];
      P.diagonal() += least;
    }
    if (chi2Of(differenceOf(c.T_from_to, poseBetween(poses, c.from, c.to)), P) <= params.chi2) {
      candidates.push_back(i);
    }
  }
  std::vector<std::vector<bool>> agrees(candidates.size(), std::vector<bool>(candidates.size(), true));
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    for (std::size_t j = i + 1; j < candidates.size(); ++j) {
      agrees[i][j] = agrees[j][i] = agree(poses, ways, closings[static_cast<std::size_t>(candidates[i])],
                                          closings[static_cast<std::size_t>(candidates[j])], params);
    }
  }
  std::vector<int> chosen;
  std::vector<int> best;
  int budget = 200'000;
  grow(agrees, 0, chosen, best, budget);
  double low = 1e9;
  double high = -1e9;
  for (int& i : best) {
    i = candidates[static_cast<std::size_t>(i)];
    const double way = ways[static_cast<std::size_t>(closings[static_cast<std::size_t>(i)].to)];
    low = std::min(low, way);
    high = std::max(high, way);
  }
  const bool enough =
      static_cast<int>(best.size()) >= params.least_closings && high - low >= params.least_apart_m;
  return enough ? best : std::vector<int>{};
}

PoseGraphResult solvePoseGraph(const std::vector<Pose2>& poses, const Ways& ways,
                               const std::vector<Closing>& closings, RobustKernel kernel,
                               const ChainErrors& chain) {
  PoseGraphResult result;
  if (closings.empty()) {
    result.poses = poses;
    result.usable = true;
    return result;
  }
  PoseProblem problem(poses, ways, closings, chain);
  constexpr double kCauchy = 1.0;
  if (kernel == RobustKernel::kGraduated) {
    result.weights = solveGraduated(problem, closings.size(), result.usable);
  } else {
    ceres::CauchyLoss cauchy(kCauchy);
    const bool robust = kernel == RobustKernel::kCauchy;
    const std::vector<double> ones(closings.size(), 1.0);
    result.usable = problem.solve(ones, robust ? &cauchy : nullptr);
    for (const double r2 : problem.chi2()) {
      // A closing is kept by the same bound as the other kernel's.
      result.weights.push_back(!robust || r2 <= kTruncation ? 1.0 : kCauchy / (kCauchy + r2));
    }
  }
  result.poses = problem.poses();
  return result;
}

std::vector<int> closingsKeptByBoth(const std::vector<Pose2>& poses, const Ways& ways,
                                    const std::vector<Closing>& closings, const ChainErrors& chain) {
  const auto cauchy = solvePoseGraph(poses, ways, closings, RobustKernel::kCauchy, chain);
  const auto graduated = solvePoseGraph(poses, ways, closings, RobustKernel::kGraduated, chain);
  std::vector<int> kept;
  if (!cauchy.usable || !graduated.usable) return kept;
  for (int i = 0; i < static_cast<int>(closings.size()); ++i) {
    const auto at = static_cast<std::size_t>(i);
    if (cauchy.weights[at] > kKept && graduated.weights[at] > kKept) kept.push_back(i);
  }
  return kept;
}

}  // namespace vismem
