#include "calibration/core/body/body_problem.h"

#include <ceres/ceres.h>

#include <Eigen/Cholesky>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "calibration/core/body/body_costs.h"
#include "common/geometry/angles.h"

namespace vismem {
namespace {

/// Residuals of wheels beyond this lose influence: a wheel may slip.
constexpr double kWheelLoss = 4.0;
/// Motion that the model of the wheels does not have: between two places at least this much.
constexpr double kWheelFloor_m = 1e-4;
constexpr double kWheelFloor_rad = degToRad(0.01);
/// Number of residuals in excess from which they say something about their own noise.
constexpr double kLeastRedundancy = 5.0;
constexpr double kSmallestScale = 0.3;
constexpr double kSmallestBase_m = 0.02;

using Blocks = std::vector<ceres::ResidualBlockId>;

/// Knowledge of one entry of a block: (block[index] - value) / sigma.
class EntryPrior final : public ceres::CostFunction {
 public:
  EntryPrior(std::size_t size, std::size_t index, double value, double sigma)
      : size_(size), index_(index), value_(value), inverse_sigma_(1.0 / sigma) {
    mutable_parameter_block_sizes()->push_back(static_cast<int>(size));
    set_num_residuals(1);
  }
  bool Evaluate(double const* const* blocks, double* residual, double** jacobians) const override {
    residual[0] = (blocks[0][index_] - value_) * inverse_sigma_;
    if (jacobians != nullptr && jacobians[0] != nullptr) {
      std::fill_n(jacobians[0], size_, 0.0);
      jacobians[0][index_] = inverse_sigma_;
    }
    return true;
  }

 private:
  std::size_t size_;
  std::size_t index_;
  double value_;
  double inverse_sigma_;
};

/// One of the three blocks of BodyParameters.
struct Block {
  double* values;
  std::size_t first;  ///< index of its first entry as of parameterOf()
  std::size_t size;
};

std::array<Block, 3> blocksOf(BodyParameters& p) {
  return {{{p.body.data(), 0, kBodySize},
           {p.lens.data(), kBodySize, kLensSize},
           {p.wheels.data(), kBodySize + kLensSize, kWheelsSize}}};
}

Eigen::SparseMatrix<double> toEigen(const ceres::CRSMatrix& m) {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(m.values.size());
  for (int row = 0; row < m.num_rows; ++row) {
    for (int k = m.rows[row]; k < m.rows[row + 1]; ++k) entries.emplace_back(row, m.cols[k], m.values[k]);
  }
  Eigen::SparseMatrix<double> result(m.num_rows, m.num_cols);
  result.setFromTriplets(entries.begin(), entries.end());
  return result;
}

}  // namespace

struct BodyProblem::Impl {
  struct ViewBlock {
    ceres::ResidualBlockId id;
    std::size_t view;
    std::vector<std::size_t> corners;  ///< that are used
  };

  Inputs in;
  BodyStage stage;
  BodyParameters& parameters;
  BodyPoses& poses;
  ceres::Problem problem;
  std::vector<ViewBlock> view_blocks;
  Blocks wheel_blocks;
  Blocks joint_blocks;
  Blocks fact_blocks;                        ///< knowledge
  std::vector<std::size_t> free_parameters;  ///< in the order of the blocks
  std::vector<double*> nuisance;             ///< poses and deviations

  Impl(Inputs inputs, BodyStage s, BodyParameters& p, BodyPoses& q)
      : in(std::move(inputs)), stage(s), parameters(p), poses(q) {
    addCorners();
    addWheels();
    addParameters();
  }

  bool isUsed(std::size_t view) const { return stage.moving_views || (*in.still)[view]; }
  double stampOf(std::size_t view) const { return toSeconds(in.record->views[view].stamp_us); }

  void addCorners() {
    const BodyRecord& record = *in.record;
    const Eigen::Vector3d middle = middlePosition(record.board);
    for (std::size_t v = 0; v < record.views.size(); ++v) {
      if (!isUsed(v)) continue;
      auto cost = std::make_unique<ViewCost>();
      cost->middle = middle;
      cost->centre = {record.intrinsics.cx, record.intrinsics.cy};
      cost->place = record.place;
      cost->joints = in.joints;
      cost->stamp_s = stampOf(v);
      cost->half_rows = 0.5 * (record.intrinsics.height - 1);
      const double joints_s = cost->stamp_s + parameters.body[kJointDelay];
      const Eigen::Vector2d backlash(parameters.body[kPanBacklash] / parameters.body[kPanScale],
                                     parameters.body[kTiltBacklash] / parameters.body[kTiltScale]);
      for (int end = 0; end <= ViewCost::kPieces; ++end) {
        cost->leads[static_cast<std::size_t>(end)] =
            in.joints->leadAt(joints_s + parameters.body[kRowTime] * cost->rowsLate(end), backlash);
      }
      const WheelTravel speed = in.wheels->speedAt(cost->stamp_s + parameters.wheels[kOdometryDelay]);
      const double left = parameters.wheels[kLeftScale] * speed.left;
      const double right = parameters.wheels[kRightScale] * speed.right;
      cost->v_mps = 0.5 * (left + right);
      cost->w_radps = (right - left) / parameters.wheels[kBase];
      addView(v, std::move(cost));
    }
  }

  void addView(std::size_t v, std::unique_ptr<ViewCost> cost) {
    const BodyRecord& record = *in.record;
    ViewBlock block{nullptr, v, {}};
    for (std::size_t c = 0; c < record.views[v].corners.size(); ++c) {
      const double weight = (*in.weights)[v][c];
      if (weight <= 0.0) continue;
      const BoardCorner& corner = record.views[v].corners[c];
      cost->corners.push_back({corner.pixel, cornerPosition(record.board, corner.id).head<2>(),
                               std::sqrt(weight) / (in.noise.corners * corner.sigma_px),
                               corner.pixel.y() / (record.intrinsics.height - 1)});
      block.corners.push_back(c);
    }
    if (block.corners.empty()) return;
    double* deviation = poses.deviation[v].data();
    const int residuals = 2 * static_cast<int>(block.corners.size());
    block.id = problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<ViewCost, ceres::DYNAMIC, kBodySize, kLensSize, 3, 2>(cost.release(),
                                                                                              residuals),
        nullptr, parameters.body.data(), parameters.lens.data(), poses.poses[poses.pose_of_view[v]].data(),
        deviation);
    view_blocks.push_back(std::move(block));
    for (std::size_t j = 0; j < 2; ++j) {
      joint_blocks.push_back(problem.AddResidualBlock(new EntryPrior(2, j, 0.0, in.noise.repeatability_rad),
                                                      nullptr, deviation));
    }
    nuisance.push_back(deviation);
  }

  void addWheels() {
    std::optional<std::size_t> before;
    std::vector<bool> listed(poses.poses.size(), false);
    for (std::size_t v = 0; v < in.record->views.size(); ++v) {
      double* pose = poses.poses[poses.pose_of_view[v]].data();
      if (!problem.HasParameterBlock(pose)) continue;
      if (!listed[poses.pose_of_view[v]]) nuisance.push_back(pose);
      listed[poses.pose_of_view[v]] = true;
      if (before && poses.pose_of_view[*before] != poses.pose_of_view[v]) addWheelPiece(*before, v);
      before = v;
    }
  }

  void addWheelPiece(std::size_t from, std::size_t to) {
    WheelCost cost;
    cost.path = in.wheels;
    cost.from_s = stampOf(from);
    cost.to_s = stampOf(to);
    const double delay = parameters.wheels[kOdometryDelay];
    const WheelModel model{parameters.wheels[kLeftScale], parameters.wheels[kRightScale],
                           parameters.wheels[kBase]};
    Eigen::Matrix3d P =
        in.wheels->covariance(model, cost.from_s + delay, cost.to_s + delay, in.noise.wheel_sqrtm);
    P.diagonal() += Eigen::Vector3d(kWheelFloor_m * kWheelFloor_m, kWheelFloor_m * kWheelFloor_m,
                                    kWheelFloor_rad * kWheelFloor_rad);
    const Eigen::Matrix3d L = P.llt().matrixL();
    cost.whitening = L.triangularView<Eigen::Lower>().solve(Eigen::Matrix3d::Identity());
    wheel_blocks.push_back(problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<WheelCost, 3, kWheelsSize, 3, 3>(new WheelCost(cost)),
        new ceres::CauchyLoss(kWheelLoss), parameters.wheels.data(),
        poses.poses[poses.pose_of_view[from]].data(), poses.poses[poses.pose_of_view[to]].data()));
  }

  bool isFixed(std::size_t index) const {
    const bool delay = index == kJointDelay || index == kRowTime || index == wheelParameter(kOdometryDelay);
    return (delay && !stage.delays) || std::find(in.fixed.begin(), in.fixed.end(), index) != in.fixed.end();
  }

  void addParameters() {
    for (const Block& block : blocksOf(parameters)) {
      if (!problem.HasParameterBlock(block.values)) continue;
      std::vector<int> constant;
      for (std::size_t i = 0; i < block.size; ++i) {
        const std::size_t index = block.first + i;
        if (isFixed(index)) {
          constant.push_back(static_cast<int>(i));
          continue;
        }
        free_parameters.push_back(index);
        problem.AddResidualBlock(
            new EntryPrior(block.size, i, parameterOf(in.start, index), parameterInfos()[index].weak_sigma),
            nullptr, block.values);
      }
      if (constant.size() == block.size) {
        problem.SetParameterBlockConstant(block.values);
      } else if (!constant.empty()) {
        problem.SetManifold(block.values, new ceres::SubsetManifold(static_cast<int>(block.size), constant));
      }
      for (const BodyKnowledge& fact : in.knowledge) {
        if (fact.parameter < block.first || fact.parameter >= block.first + block.size) continue;
        fact_blocks.push_back(problem.AddResidualBlock(
            new EntryPrior(block.size, fact.parameter - block.first, fact.value, fact.sigma), nullptr,
            block.values));
      }
    }
    if (in.aspect_sigma > 0.0 && problem.HasParameterBlock(parameters.lens.data())) {
      const CameraIntrinsics& k = in.record->intrinsics;
      fact_blocks.push_back(
          problem.AddResidualBlock(new ceres::AutoDiffCostFunction<AspectCost, 1, kLensSize>(
                                       new AspectCost{k.fx, k.fy, 1.0 / in.aspect_sigma}),
                                   nullptr, parameters.lens.data()));
    }
    if (!problem.HasParameterBlock(parameters.wheels.data())) return;
    // Wheels of negative radius at a negative distance drive the mirrored path: same residuals, wrong robot.
    problem.SetParameterLowerBound(parameters.wheels.data(), kLeftScale, kSmallestScale);
    problem.SetParameterLowerBound(parameters.wheels.data(), kRightScale, kSmallestScale);
    problem.SetParameterLowerBound(parameters.wheels.data(), kBase, kSmallestBase_m);
  }

  std::vector<double> residualsOf(const Blocks& blocks) {
    std::vector<double> residuals;
    if (blocks.empty()) return residuals;
    ceres::Problem::EvaluateOptions options;
    options.apply_loss_function = false;
    options.residual_blocks = blocks;
    problem.Evaluate(options, nullptr, &residuals, nullptr, nullptr);
    return residuals;
  }

  Blocks cornerBlocks() const {
    Blocks blocks;
    for (const ViewBlock& block : view_blocks) blocks.push_back(block.id);
    return blocks;
  }

  /// Blocks that say something about the robot: all but the weak priors.
  Blocks dataBlocks() const {
    Blocks blocks = cornerBlocks();
    for (const auto* group : {&wheel_blocks, &joint_blocks, &fact_blocks}) {
      blocks.insert(blocks.end(), group->begin(), group->end());
    }
    return blocks;
  }

  /// Columns: the free parameters, then poses and deviations.
  Eigen::SparseMatrix<double> jacobian(const Blocks& blocks) {
    ceres::Problem::EvaluateOptions options;
    options.residual_blocks = blocks;
    for (const Block& block : blocksOf(parameters)) {
      if (problem.HasParameterBlock(block.values) && !problem.IsParameterBlockConstant(block.values)) {
        options.parameter_blocks.push_back(block.values);
      }
    }
    options.parameter_blocks.insert(options.parameter_blocks.end(), nuisance.begin(), nuisance.end());
    ceres::CRSMatrix crs;
    problem.Evaluate(options, nullptr, nullptr, nullptr, &crs);
    return toEigen(crs);
  }

  /// Calls use(view, corner, residual) for every used corner; the residual without its weight, in standard
  /// deviations of the corners' finder.
  template <typename Use>
  void forCorners(const Use& use) {
    const std::vector<double> residuals = residualsOf(cornerBlocks());
    std::size_t at = 0;
    for (const ViewBlock& block : view_blocks) {
      for (const std::size_t corner : block.corners) {
        const double scale = in.noise.corners / std::sqrt((*in.weights)[block.view][corner]);
        use(block.view, corner, std::hypot(residuals[at], residuals[at + 1]) * scale);
        at += 2;
      }
    }
  }
};

BodyProblem::BodyProblem(Inputs inputs, BodyStage stage, BodyParameters& parameters, BodyPoses& poses)
    : impl_(std::make_unique<Impl>(std::move(inputs), stage, parameters, poses)) {}
BodyProblem::~BodyProblem() = default;

BodyFit BodyProblem::solve() {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.max_num_iterations = 60;
  options.function_tolerance = 1e-9;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &impl_->problem, &summary);

  BodyFit fit;
  fit.converged = summary.IsSolutionUsable();
  fit.message = summary.message;
  double px = 0.0;
  double normalised = 0.0;
  impl_->forCorners([&](std::size_t view, std::size_t corner, double error) {
    px += std::pow(error * impl_->in.record->views[view].corners[corner].sigma_px, 2);
    normalised += error * error;
    ++fit.corners;
  });
  const double count = std::max(1.0, 2.0 * static_cast<double>(fit.corners));
  fit.rms_px = std::sqrt(px / count);
  fit.normalised_rms = std::sqrt(normalised / count);
  return fit;
}

std::vector<std::vector<double>> BodyProblem::cornerErrors() const {
  std::vector<std::vector<double>> errors;
  for (const BoardView& view : impl_->in.record->views) errors.emplace_back(view.corners.size(), 0.0);
  impl_->forCorners(
      [&](std::size_t view, std::size_t corner, double error) { errors[view][corner] = error; });
  return errors;
}

ParameterInformation BodyProblem::information() {
  const Eigen::SparseMatrix<double> J = impl_->jacobian(impl_->dataBlocks());
  const auto n = static_cast<Eigen::Index>(impl_->free_parameters.size());
  const Eigen::SparseMatrix<double> H = J.transpose() * J;
  const auto rest = H.cols() - n;
  ParameterInformation result;
  result.parameters = impl_->free_parameters;
  result.matrix = Eigen::MatrixXd(H.topLeftCorner(n, n));
  if (rest > 0) {
    const Eigen::SparseMatrix<double> H_rest = H.bottomRightCorner(rest, rest);
    const Eigen::MatrixXd H_mixed = Eigen::MatrixXd(H.bottomLeftCorner(rest, n));
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(H_rest);
    result.matrix -= H_mixed.transpose() * solver.solve(H_mixed);
  }
  return result;
}

NoiseRatio BodyProblem::noiseRatio() {
  const Eigen::SparseMatrix<double> J = impl_->jacobian(impl_->dataBlocks());
  Eigen::SparseMatrix<double> H = J.transpose() * J;
  // The weak priors make it regular also where the data do not.
  const auto free = static_cast<Eigen::Index>(impl_->free_parameters.size());
  Eigen::SparseMatrix<double> weak(free, H.cols());
  for (Eigen::Index i = 0; i < free; ++i) {
    weak.insert(i, i) =
        1.0 / parameterInfos()[impl_->free_parameters[static_cast<std::size_t>(i)]].weak_sigma;
  }
  H += Eigen::SparseMatrix<double>(weak.transpose() * weak);
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(H);
  const auto leverageOf = [&](const Eigen::SparseMatrix<double>& rows) {
    const Eigen::MatrixXd cofactor = solver.solve(Eigen::MatrixXd(rows.transpose()));
    return rows.transpose().cwiseProduct(cofactor).sum();
  };
  // All leverages together are the number of unknowns: the many corners have what the others leave.
  double others = leverageOf(weak);
  const auto ratioOf = [&](const Blocks& blocks, double leverage) -> std::optional<double> {
    const std::vector<double> residuals = impl_->residualsOf(blocks);
    const double redundancy = static_cast<double>(residuals.size()) - leverage;
    if (redundancy < kLeastRedundancy) return std::nullopt;
    double squares = 0.0;
    for (const double r : residuals) squares += std::min(r * r, kWheelLoss * kWheelLoss);
    return std::sqrt(squares / redundancy);
  };
  const auto ratioOfFew = [&](const Blocks& blocks) -> std::optional<double> {
    if (blocks.empty()) return std::nullopt;
    const double leverage = leverageOf(impl_->jacobian(blocks));
    others += leverage;
    return ratioOf(blocks, leverage);
  };
  NoiseRatio ratio;
  ratio.wheels = ratioOfFew(impl_->wheel_blocks);
  ratio.joints = ratioOfFew(impl_->joint_blocks);
  ratioOfFew(impl_->fact_blocks);
  ratio.corners = ratioOf(impl_->cornerBlocks(), static_cast<double>(H.cols()) - others);
  return ratio;
}

}  // namespace vismem
