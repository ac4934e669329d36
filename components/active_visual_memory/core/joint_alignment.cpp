#include "active_visual_memory/core/joint_alignment.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "active_visual_memory/core/drift_limits.h"
#include "active_visual_memory/core/drift_residuals.h"
#include "common/geometry/angles.h"

namespace vismem {
namespace {

Eigen::Vector2d turned90(const Eigen::Vector2d& v) {
  return {-v.y(), v.x()};
}

constexpr double kLeastVariance = 1e-12;  // [m^2], [rad^2]: of what cannot change
constexpr double kFirstCourse = 0.2;      // [rad] sigma of the course of a place when it is first told
constexpr double kMemory = 5.0;           // steps that odometry errs alike
constexpr double kNothing = 1e12;         // variance of what does not count

}  // namespace

JointAlignment::JointAlignment(const LeanParams& lean) : lean_params_(lean) {
  lines_.reserve(kMostLines);
  P_.setZero(kLines, kLines);
  P_.block<4, 4>(kLean, kLean) = lean.prior();
}

void JointAlignment::reset() {
  const LeanCovariance lean = leanCovariance();
  const Eigen::Matrix2d rates = P_.block<2, 2>(kRates, kRates);
  lines_.clear();
  corrections_.clear();
  course_rad_.reset();
  P_.setZero(kLines, kLines);
  P_.block<4, 4>(kLean, kLean) = lean;
  P_.block<2, 2>(kRates, kRates) = rates;
}

int JointAlignment::slotOf(std::uint64_t line) const {
  for (std::size_t i = 0; i < lines_.size(); ++i) {
    if (lines_[i].id == line) return static_cast<int>(i);
  }
  return -1;
}

void JointAlignment::remove(int slot) {
  const int at = kLines + 2 * slot;
  const int behind = size() - at - 2;
  const int n = size();
  Matrix kept = P_;
  kept.middleRows(at, behind) = P_.middleRows(at + 2, behind);
  P_ = kept;
  P_.middleCols(at, behind) = kept.middleCols(at + 2, behind);
  P_ = Matrix(P_.topLeftCorner(n - 2, n - 2));
  lines_.erase(lines_.begin() + slot);
}

void JointAlignment::rename(std::uint64_t known, std::uint64_t line) {
  if (!knows(known)) return;
  forget(line);
  lines_[static_cast<std::size_t>(slotOf(known))].id = line;
}

void JointAlignment::forget(std::uint64_t line) {
  const int slot = slotOf(line);
  if (slot >= 0) remove(slot);
}

SmallMotion JointAlignment::travel(const Pose2& before, const Pose2& now, const Params& params) {
  const Pose2 moved = inverse(before) * now;
  const double way = moved.position().norm();
  const double turn = std::abs(moved.theta);
  SmallMotion expected{before.position(), Eigen::Vector2d::Zero(), 0.0};
  if (way == 0.0 && turn == 0.0) return expected;
  const Eigen::Vector2d most{params.drift.turn_per_rad, params.drift.turn_per_m};
  if (!moved_) {
    P_.block<2, 2>(kRates, kRates) = most.cwiseAbs2().asDiagonal();
    moved_ = true;
  }
  const Eigen::Vector2d gone{moved.theta, std::copysign(way, moved.x)};
  expected.turn_rad = gone.dot(rates_);
  // turn += gone * rates; and all is told about where the robot is now.
  const auto addRow = [&](int to, double factor, int from) {
    P_.row(to) += factor * P_.row(from);
    P_.col(to) += factor * P_.col(from);
  };
  addRow(kTurn, gone[0], kRates);
  addRow(kTurn, gone[1], kRates + 1);
  const Eigen::Vector2d lever = turned90(now.position() - before.position());
  addRow(0, lever.x(), kTurn);
  addRow(1, lever.y(), kTurn);
  // Drift of the same cause goes on in the same direction for a while: standard deviations add up, but not
  // for long.
  const auto grow = [](double& variance, double sigma) {
    const double grown = std::sqrt(std::max(0.0, variance)) + sigma;
    variance = std::min(grown * grown, variance + kMemory * kMemory * sigma * sigma);
  };
  const double shift = params.drift.shift_per_m * way + params.drift.shift_per_rad * turn;
  grow(P_(0, 0), shift);
  grow(P_(1, 1), shift);
  P_(kTurn, kTurn) += params.turn_noise * params.turn_noise * (way + params.feet_per_rad_m * turn);
  grow(P_(kTurn, kTurn), kChangingDrift * (params.drift.turn_per_rad * turn + params.drift.turn_per_m * way));
  if (course_rad_) *course_rad_ += expected.turn_rad;
  for (Line& line : lines_) line.reference = expected.apply(line.reference);
  return expected;
}

double JointAlignment::placeVariance(std::uint64_t line, const Eigen::Vector2d& n,
                                     const Eigen::Vector2d& p) const {
  const int slot = slotOf(line);
  if (slot < 0) return 0.0;
  const int at = kLines + 2 * slot;
  const Eigen::Vector2d along{n.y(), -n.x()};
  const Eigen::Vector3d drift{n.x(), n.y(), n.dot(turned90(p - pivot_))};
  const Eigen::Vector2d own{1.0, along.dot(p - lines_[static_cast<std::size_t>(slot)].reference)};
  return drift.dot(P_.topLeftCorner<3, 3>() * drift) + own.dot(P_.block<2, 2>(at, at) * own) +
         2.0 * drift.dot(P_.block<3, 2>(0, at) * own);
}

SmallMotion JointAlignment::slip(const Eigen::Vector2d& robot, double turn_rad, double sigma_rad) {
  const SmallMotion motion{robot, Eigen::Vector2d::Zero(), turn_rad};
  P_(kTurn, kTurn) += sigma_rad * sigma_rad;
  if (course_rad_) *course_rad_ += turn_rad;
  for (Line& line : lines_) line.reference = motion.apply(line.reference);
  return motion;
}

void JointAlignment::beginImage(const Eigen::Vector2d& robot, const std::optional<double>& course_rad,
                                const Params& params) {
  corrections_.clear();
  pivot_ = robot;
  P_sway_.setZero();
  P_.middleRows<4>(kSway).setZero();
  P_.middleCols<4>(kSway).setZero();
  P_.block<2, 2>(kSway, kSway).diagonal().setConstant(lean_params_.sway_rad * lean_params_.sway_rad);
  P_.block<2, 2>(kSway + 2, kSway + 2).diagonal().setConstant(params.sway_shift_m * params.sway_shift_m);
  for (Line& line : lines_) ++line.unseen;
  if (!course_rad || course_rad_) return;
  course_rad_ = course_rad;
  P_.row(kCourse).setZero();
  P_.col(kCourse).setZero();
  P_(kCourse, kCourse) = kFirstCourse * kFirstCourse;
}

std::optional<JointAlignment::Told> JointAlignment::hear(const Eigen::Vector2d& robot,
                                                         std::span<const JointResidual> residuals,
                                                         std::span<const LineDirection> directions,
                                                         const Params& params) {
  std::vector<std::pair<int, double>> in_course;
  for (const LineDirection& line : directions) {
    const int slot = slotOf(line.line);
    if (!course_rad_ || slot < 0 || lines_[static_cast<std::size_t>(slot)].in_course) continue;
    const double off = offCourse(line.direction_rad, *course_rad_);
    if (std::abs(off) <= params.together_rad) in_course.emplace_back(slot, off);
  }
  const int courses = std::min(static_cast<int>(in_course.size()), kMostResiduals);
  const int seen = std::min(static_cast<int>(residuals.size()), kMostResiduals - courses);
  const int n = size();
  const int m = seen + courses;
  if (m == 0) return std::nullopt;
  Told told{Matrix::Zero(m, n), Eigen::VectorXd(m), Eigen::VectorXd(m), {}, {}, Eigen::VectorXd::Zero(n)};
  Matrix& H = told.H;
  for (int i = 0; i < seen; ++i) {
    const JointResidual& residual = residuals[static_cast<std::size_t>(i)];
    const DriftResidual& c = residual.common;
    H.row(i).head<2>() = c.direction;
    H(i, kTurn) = c.direction.dot(turned90(c.p - robot));
    H.row(i).segment<4>(kLean) = -c.d_lean;
    H.row(i).segment<2>(kSway) = -c.d_sway;
    H.row(i).segment<2>(kSway + 2) = c.direction;
    told.residual[i] = c.residual_m;
    told.variance[i] = c.variance_m2;
    const int slot = residual.line ? slotOf(residual.line) : -1;
    if (slot < 0) continue;
    Line& line = lines_[static_cast<std::size_t>(slot)];
    const int at = kLines + 2 * slot;
    if (line.unseen > 0) {
      P_(at, at) += params.offset_noise_m * params.offset_noise_m;
      P_(at + 1, at + 1) += params.turn_noise_rad * params.turn_noise_rad;
      line.unseen = 0;
    }
    // The direction across the line looks to its left.
    const Eigen::Vector2d along{c.direction.y(), -c.direction.x()};
    H(i, at) = 1.0;
    H(i, at + 1) = along.dot(c.p - line.reference);
  }
  for (int i = 0; i < courses; ++i) {
    const auto& [slot, off] = in_course[static_cast<std::size_t>(i)];
    H(seen + i, kLines + 2 * slot + 1) = 1.0;
    H(seen + i, kCourse) = -1.0;
    told.residual[seen + i] = -off;
    told.variance[seen + i] = params.course_rad * params.course_rad;
    lines_[static_cast<std::size_t>(slot)].in_course = true;
  }

  // Each row names few of the unknowns.
  told.PHt = Matrix::Zero(n, m);
  for (int i = 0; i < m; ++i) {
    for (int k = 0; k < n; ++k) {
      if (H(i, k) != 0.0) told.PHt.col(i) += H(i, k) * P_.col(k);
    }
  }
  const Matrix spread = H * told.PHt;
  for (int iteration = 0; iteration < params.drift.iterations; ++iteration) {
    Matrix all = spread;
    const Eigen::VectorXd left = told.residual - H * told.x;
    for (int i = 0; i < m; ++i) {
      // The gate opens by what the drift may be; at the end only what agrees with the rest counts.
      const double known = told.variance[i] + (iteration == 0 ? spread(i, i) : 0.0);
      const double off = std::abs(left[i]) / std::sqrt(known);
      all(i, i) += off > params.drift.gate    ? kNothing
                   : off > params.drift.huber ? told.variance[i] * off / params.drift.huber
                                              : told.variance[i];
    }
    told.S.compute(all);
    told.x = told.PHt * told.S.solve(told.residual);
  }
  const Matrix PHt_sway = told.PHt.middleRows<2>(kSway);
  P_sway_ = P_.block<2, 2>(kSway, kSway) - PHt_sway * told.S.solve(PHt_sway.transpose());
  return told;
}

std::optional<Correction> JointAlignment::look(const Eigen::Vector2d& robot,
                                               std::span<const JointResidual> residuals,
                                               const std::optional<double>& course_rad,
                                               std::span<const LineDirection> directions,
                                               const Params& params) const {
  JointAlignment trial = *this;
  trial.beginImage(robot, course_rad, params);
  const auto told = trial.hear(robot, residuals, directions, params);
  if (!told) return std::nullopt;
  return Correction{{robot, told->x.head<2>(), told->x[kTurn]},
                    told->x.segment<4>(kLean),
                    told->x.segment<2>(kSway),
                    trial.P_sway_};
}

std::optional<Correction> JointAlignment::solve(const Eigen::Vector2d& robot,
                                                std::span<const JointResidual> residuals,
                                                const std::optional<double>& course_rad,
                                                std::span<const LineDirection> directions,
                                                const Params& params) {
  beginImage(robot, course_rad, params);
  const auto told = hear(robot, residuals, directions, params);
  if (!told) return std::nullopt;
  P_.noalias() -= told->PHt * told->S.solve(told->PHt.transpose());
  P_ = (0.5 * (P_ + P_.transpose())).eval();
  P_.diagonal() = P_.diagonal().cwiseMax(kLeastVariance).eval();

  const Eigen::VectorXd& x = told->x;
  Correction correction{{robot, x.head<2>(), x[kTurn]}, Lean::Zero(), x.segment<2>(kSway), P_sway_};
  const Lean before = lean_;
  lean_ += x.segment<4>(kLean);
  rates_ += x.segment<2>(kRates);
  const Eigen::Vector2d most_rates{params.drift.turn_per_rad, params.drift.turn_per_m};
  keepRatesWithin(most_rates, rates_, P_.block<2, 2>(kRates, kRates));
  keepWithin(lean_params_, lean_, P_.block<4, 4>(kLean, kLean));
  correction.lean = lean_ - before;
  if (course_rad_) *course_rad_ += x[kTurn] + x[kCourse];
  const Eigen::Matrix4d lean_information = leanCovariance().inverse();
  for (std::size_t i = 0; i < lines_.size(); ++i) {
    const int at = kLines + 2 * static_cast<int>(i);
    lines_[i].reference = correction.motion.apply(lines_[i].reference);
    LineCorrection line{lines_[i].id, lines_[i].reference, x[at], x[at + 1], P_.block<2, 2>(at, at), {}};
    line.J = P_.block<2, 4>(at, kLean) * lean_information;
    line.P -= line.J * P_.block<4, 2>(kLean, at);
    corrections_.push_back(line);
  }
  return correction;
}

void JointAlignment::begin(std::uint64_t line, const FloorSegment& observed, const LeaningView& view,
                           double noise, double slack_m) {
  if (static_cast<int>(lines_.size()) >= kMostLines) {
    const auto longest = std::max_element(lines_.begin(), lines_.end(),
                                          [](const Line& a, const Line& b) { return a.unseen < b.unseen; });
    remove(static_cast<int>(longest - lines_.begin()));
  }
  const int n = size();
  const Eigen::Vector2d middle = observed.odom.middle();
  const double length = observed.odom.length();
  const Eigen::Vector2d along = (observed.odom.b - observed.odom.a) / length;
  const Eigen::Vector2d normal = turned90(along);
  const auto row = [&](const Eigen::Vector2d& p) {
    Eigen::RowVectorXd g = Eigen::RowVectorXd::Zero(n);
    const LeanRow d = normal.transpose() * view.derivativeAt(p);
    g.head<2>() = -normal;
    g[kTurn] = -normal.dot(turned90(p - pivot_));
    g.segment<4>(kLean) = d;
    g.segment<2>(kSway) = d.head<2>();
    g.segment<2>(kSway + 2) = -normal;
    return g;
  };
  const Eigen::RowVectorXd a = row(observed.odom.a);
  const Eigen::RowVectorXd b = row(observed.odom.b);
  Eigen::MatrixXd G(2, n);
  G.row(0) = 0.5 * (a + b);
  G.row(1) = (b - a) / length;
  const auto own = [&](const Eigen::Matrix2d& P, const FloorLean& D) {
    const Eigen::Matrix2d without = P - D.leftCols<2>() * P_sway_ * D.leftCols<2>().transpose();
    return noise * (ownVariance(normal, without, D, observed.pitch_sigma_rad) + slack_m * slack_m);
  };
  const double va = own(observed.P_a, observed.D_a);
  const double vb = own(observed.P_b, observed.D_b);
  Eigen::Matrix2d R;
  R << 0.25 * (va + vb), 0.5 * (vb - va) / length, 0.5 * (vb - va) / length, (va + vb) / (length * length);
  Matrix grown = Matrix::Zero(n + 2, n + 2);
  grown.topLeftCorner(n, n) = P_;
  grown.bottomLeftCorner(2, n) = G * P_;
  grown.topRightCorner(n, 2) = grown.bottomLeftCorner(2, n).transpose();
  grown.bottomRightCorner(2, 2) = G * P_ * G.transpose() + R;
  P_ = grown;
  lines_.push_back({line, middle, false, 0});
}

void JointAlignment::beginAs(std::uint64_t line, std::uint64_t known) {
  const int slot = slotOf(known);
  if (slot < 0 || static_cast<int>(lines_.size()) >= kMostLines) return;
  const int n = size();
  const int at = kLines + 2 * slot;
  Matrix grown = Matrix::Zero(n + 2, n + 2);
  grown.topLeftCorner(n, n) = P_;
  grown.bottomLeftCorner(2, n) = P_.middleRows(at, 2);
  grown.topRightCorner(n, 2) = P_.middleCols(at, 2);
  grown.bottomRightCorner(2, 2) = P_.block<2, 2>(at, at);
  P_ = grown;
  lines_.push_back(lines_[static_cast<std::size_t>(slot)]);
  lines_.back().id = line;
}

}  // namespace vismem
