#include "calibration/core/lens/adjustment.h"

#include <ceres/ceres.h>
#include <ceres/normal_prior.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <numeric>

namespace vismem {
namespace {

using CornerCost = ceres::AutoDiffCostFunction<CornerError, 2, kLensParameters, 6, 2>;

/// Errors of print and paper [px].
constexpr double kSigmaFloor_px = 0.02;
constexpr double kBowSigma_m = 0.002;
constexpr double kMinFocal_px = 10.0;

/// Entries from..size-1, for ceres::SubsetManifold.
std::vector<int> entriesFrom(int from, int size) {
  std::vector<int> entries(static_cast<std::size_t>(size - from));
  std::iota(entries.begin(), entries.end(), from);
  return entries;
}

}  // namespace

std::array<double, 6> poseVector(const Pose3& pose) {
  const Eigen::AngleAxisd turn(pose.linear());
  const Eigen::Vector3d w = turn.angle() * turn.axis();
  const Eigen::Vector3d t = pose.translation();
  return {w.x(), w.y(), w.z(), t.x(), t.y(), t.z()};
}

Pose3 poseFrom(const std::array<double, 6>& v) {
  const Eigen::Vector3d w(v[0], v[1], v[2]);
  const double angle = w.norm();
  Pose3 pose = Pose3::Identity();
  if (angle > 0.0) pose.linear() = Eigen::AngleAxisd(angle, w / angle).toRotationMatrix();
  pose.translation() = Eigen::Vector3d(v[3], v[4], v[5]);
  return pose;
}

Adjustment::Adjustment(const BoardSpec& board, const std::vector<BoardView>& views, int width, int height)
    : board_(board), views_(views) {
  prior_mean_ << width, width, 0.5 * (width - 1), 0.5 * (height - 1), 0, 0, 0, 0, 0;
  LensVector sigma;
  sigma << 5.0 * width, 5.0 * width, 0.1 * width, 0.1 * width, 1.0, 1.0, 0.05, 0.05, 1.0;
  prior_weight_ = sigma.cwiseInverse();
}

double Adjustment::sigmaOf(const BoardCorner& corner) const {
  return std::hypot(corner.sigma_px, kSigmaFloor_px);
}

CornerError Adjustment::errorOf(const BoardCorner& corner) const {
  return {cornerPosition(board_, corner.id), corner.pixel, sigmaOf(corner), &board_};
}

double Adjustment::solve(LensUnknowns& unknowns, const std::vector<std::vector<bool>>& is_used,
                         const AdjustmentOptions& options) const {
  ceres::Problem problem;
  double* lens = unknowns.lens.data();
  double* bow = unknowns.bow_m.data();
  int corners = 0;
  for (std::size_t view = 0; view < views_.size(); ++view) {
    for (std::size_t i = 0; i < views_[view].corners.size(); ++i) {
      if (!is_used[view][i]) continue;
      ceres::LossFunction* loss = options.cauchy > 0.0 ? new ceres::CauchyLoss(options.cauchy) : nullptr;
      problem.AddResidualBlock(new CornerCost(new CornerError(errorOf(views_[view].corners[i]))), loss, lens,
                               unknowns.poses[view].data(), bow);
      ++corners;
    }
  }
  if (corners == 0) return std::numeric_limits<double>::infinity();
  problem.AddResidualBlock(new ceres::NormalPrior(prior_weight_.asDiagonal().toDenseMatrix(), prior_mean_),
                           nullptr, lens);
  problem.AddResidualBlock(
      new ceres::NormalPrior(Eigen::Matrix2d::Identity() / kBowSigma_m, Eigen::Vector2d::Zero()), nullptr,
      bow);
  if (options.free_lens == 0) {
    problem.SetParameterBlockConstant(lens);
  } else {
    if (options.free_lens < kLensParameters) {
      problem.SetManifold(
          lens, new ceres::SubsetManifold(kLensParameters, entriesFrom(options.free_lens, kLensParameters)));
    }
    problem.SetParameterLowerBound(lens, 0, kMinFocal_px);
    problem.SetParameterLowerBound(lens, 1, kMinFocal_px);
  }
  if (!options.is_bow_free) problem.SetParameterBlockConstant(bow);
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::DENSE_SCHUR;
  solver.max_num_iterations = 100;
  solver.num_threads = 1;
  solver.logging_type = ceres::SILENT;
  solver.function_tolerance = 1e-9;
  solver.parameter_tolerance = 1e-10;
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &problem, &summary);
  if (!summary.IsSolutionUsable() || !unknowns.lens.allFinite())
    return std::numeric_limits<double>::infinity();
  return summary.final_cost / corners;
}

std::vector<std::vector<Eigen::Vector2d>> Adjustment::residuals(const LensUnknowns& unknowns) const {
  std::vector<std::vector<Eigen::Vector2d>> all(views_.size());
  for (std::size_t view = 0; view < views_.size(); ++view) {
    for (const BoardCorner& corner : views_[view].corners) {
      Eigen::Vector2d r;
      errorOf(corner)(unknowns.lens.data(), unknowns.poses[view].data(), unknowns.bow_m.data(), r.data());
      all[view].push_back(r * sigmaOf(corner));
    }
  }
  return all;
}

Adjustment::ViewEquations Adjustment::equations(const LensUnknowns& unknowns, std::size_t view,
                                                const std::vector<bool>& is_used) const {
  ViewEquations sum;
  for (std::size_t i = 0; i < views_[view].corners.size(); ++i) {
    if (!is_used[i]) continue;
    const CornerCost cost(new CornerError(errorOf(views_[view].corners[i])));
    Eigen::Vector2d r;
    Eigen::Matrix<double, 2, kLensParameters, Eigen::RowMajor> J_lens;
    Eigen::Matrix<double, 2, 6, Eigen::RowMajor> J_pose;
    Eigen::Matrix<double, 2, 2, Eigen::RowMajor> J_bow;
    const double* parameters[] = {unknowns.lens.data(), unknowns.poses[view].data(), unknowns.bow_m.data()};
    double* jacobians[] = {J_lens.data(), J_pose.data(), J_bow.data()};
    cost.Evaluate(parameters, r.data(), jacobians);
    Eigen::Matrix<double, 2, ViewEquations::kCommon> J;
    J << J_lens, J_bow;
    sum.H += J.transpose() * J;
    sum.H_pose += J.transpose() * J_pose;
    sum.pose += J_pose.transpose() * J_pose;
    sum.g += J.transpose() * r;
    sum.g_pose += J_pose.transpose() * r;
    sum.squares += r.squaredNorm();
    ++sum.corners;
  }
  return sum;
}

Adjustment::Covariance Adjustment::covariance(const LensUnknowns& unknowns,
                                              const std::vector<std::vector<bool>>& is_used,
                                              const AdjustmentOptions& options) const {
  constexpr int kCommon = ViewEquations::kCommon;
  Eigen::Matrix<double, kCommon, kCommon> information = Eigen::Matrix<double, kCommon, kCommon>::Zero();
  double squares = 0.0;
  int corners = 0;
  for (std::size_t view = 0; view < views_.size(); ++view) {
    const ViewEquations one = equations(unknowns, view, is_used[view]);
    if (one.corners == 0) continue;
    information += one.H - one.H_pose * one.pose.ldlt().solve(one.H_pose.transpose());
    squares += one.squares;
    corners += one.corners;
  }
  const int free = options.free_lens + (options.is_bow_free ? 2 : 0);
  const double freedom = 2.0 * corners - 6.0 * static_cast<double>(views_.size()) - free;
  if (freedom > 0.0) information /= std::max(squares / freedom, 1e-6);
  information.diagonal().head<kLensParameters>() += prior_weight_.cwiseAbs2();
  information.diagonal().tail<2>().array() += 1.0 / (kBowSigma_m * kBowSigma_m);
  std::vector<int> entries(static_cast<std::size_t>(options.free_lens));
  std::iota(entries.begin(), entries.end(), 0);
  if (options.is_bow_free) entries.insert(entries.end(), {kLensParameters, kLensParameters + 1});
  const Eigen::MatrixXd selected = information(entries, entries);
  const Eigen::MatrixXd P =
      selected.ldlt().solve(Eigen::MatrixXd::Identity(selected.rows(), selected.cols()));
  Covariance result;
  result.P_lens.topLeftCorner(options.free_lens, options.free_lens) =
      P.topLeftCorner(options.free_lens, options.free_lens);
  if (options.is_bow_free) result.bow_sigma_m = P.diagonal().tail<2>().cwiseSqrt();
  return result;
}

std::vector<Adjustment::FocalChange> Adjustment::focalChanges(
    const LensUnknowns& unknowns, const std::vector<std::vector<bool>>& is_used) const {
  std::vector<FocalChange> changes;
  for (std::size_t view = 0; view < views_.size(); ++view) {
    const ViewEquations one = equations(unknowns, view, is_used[view]);
    // Derivative by the logarithm of both focal lengths.
    Eigen::Matrix<double, ViewEquations::kCommon, 1> way =
        Eigen::Matrix<double, ViewEquations::kCommon, 1>::Zero();
    way.head<2>() = unknowns.lens.head<2>();
    const auto solver = one.pose.ldlt();
    const Eigen::Matrix<double, 6, 1> coupling = one.H_pose.transpose() * way;
    const double information = way.dot(one.H * way) - coupling.dot(solver.solve(coupling));
    const double slope = way.dot(one.g) - coupling.dot(solver.solve(one.g_pose));
    const double freedom = 2.0 * one.corners - 7.0;
    if (!(information > 0.0) || freedom <= 0.0) {
      changes.push_back({0.0, std::numeric_limits<double>::infinity()});
      continue;
    }
    const double squares =
        one.squares - one.g_pose.dot(solver.solve(one.g_pose)) - slope * slope / information;
    const double noise = std::max(squares / freedom, 0.1);
    changes.push_back({-slope / information, std::sqrt(noise / information)});
  }
  return changes;
}

}  // namespace vismem
