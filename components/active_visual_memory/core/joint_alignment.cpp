#include "active_visual_memory/core/joint_alignment.h"

#include <Eigen/Cholesky>
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

JointAlignment::State::State() : P(kMostUnknowns, kMostUnknowns) {
  lines.reserve(kMostLines);
  known().setZero();
}

void JointAlignment::State::copy(const State& other) {
  lines = other.lines;
  known() = other.P.topLeftCorner(size(), size());
  course_rad = other.course_rad;
  pivot = other.pivot;
  P_sway = other.P_sway;
}

int JointAlignment::State::slotOf(std::uint64_t line) const {
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (lines[i].id == line) return static_cast<int>(i);
  }
  return -1;
}

JointAlignment::Told::Told()
    : PHt(kMostUnknowns, kMostResiduals),
      spread(kMostResiduals, kMostResiduals),
      L(kMostResiduals, kMostResiduals),
      LiHP(kMostResiduals, kMostUnknowns),
      y(kMostResiduals),
      x(kMostUnknowns) {
  rows.reserve(kMostResiduals);
}

void JointAlignment::Row::add(int unknown, double factor) {
  if (factor == 0.0) return;
  unknowns[count] = unknown;
  factors[count] = factor;
  ++count;
}

JointAlignment::JointAlignment(const LeanParams& lean) : lean_params_(lean) {
  corrections_.reserve(kMostLines);
  state_.P.block<4, 4>(kLean, kLean) = lean.prior();
}

void JointAlignment::reset() {
  const LeanCovariance lean = leanCovariance();
  const Eigen::Matrix2d rates = state_.P.block<2, 2>(kRates, kRates);
  state_.lines.clear();
  corrections_.clear();
  state_.course_rad.reset();
  state_.known().setZero();
  state_.P.block<4, 4>(kLean, kLean) = lean;
  state_.P.block<2, 2>(kRates, kRates) = rates;
}

void JointAlignment::remove(int slot) {
  const int at = kLines + 2 * slot;
  const int n = state_.size();
  Matrix& P = state_.P;
  for (int j = at; j + 2 < n; ++j) P.col(j).head(n) = P.col(j + 2).head(n);
  for (int j = 0; j + 2 < n; ++j) {
    double* column = P.col(j).data();
    std::copy(column + at + 2, column + n, column + at);
  }
  state_.lines.erase(state_.lines.begin() + slot);
}

void JointAlignment::rename(std::uint64_t known, std::uint64_t line) {
  if (!knows(known)) return;
  forget(line);
  state_.lines[static_cast<std::size_t>(state_.slotOf(known))].id = line;
}

void JointAlignment::forget(std::uint64_t line) {
  const int slot = state_.slotOf(line);
  if (slot >= 0) remove(slot);
}

SmallMotion JointAlignment::travel(const Pose2& before, const Pose2& now, const Params& params) {
  const Pose2 moved = inverse(before) * now;
  const double way = moved.position().norm();
  const double turn = std::abs(moved.theta);
  SmallMotion expected{before.position(), Eigen::Vector2d::Zero(), 0.0};
  if (way == 0.0 && turn == 0.0) return expected;
  const Eigen::Vector2d most{params.drift.turn_per_rad, params.drift.turn_per_m};
  Eigen::Block<Matrix> P = state_.known();
  if (!moved_) {
    P.block<2, 2>(kRates, kRates) = most.cwiseAbs2().asDiagonal();
    moved_ = true;
  }
  const Eigen::Vector2d gone{moved.theta, std::copysign(way, moved.x)};
  expected.turn_rad = gone.dot(rates_);
  // turn += gone * rates; and all is told about where the robot is now.
  const auto addRow = [&](int to, double factor, int from) {
    P.row(to) += factor * P.row(from);
    P.col(to) += factor * P.col(from);
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
  grow(P(0, 0), shift);
  grow(P(1, 1), shift);
  P(kTurn, kTurn) += params.turn_noise * params.turn_noise * (way + params.feet_per_rad_m * turn);
  grow(P(kTurn, kTurn), kChangingDrift * (params.drift.turn_per_rad * turn + params.drift.turn_per_m * way));
  if (state_.course_rad) *state_.course_rad += expected.turn_rad;
  for (Line& line : state_.lines) line.reference = expected.apply(line.reference);
  return expected;
}

double JointAlignment::placeVariance(std::uint64_t line, const Eigen::Vector2d& n,
                                     const Eigen::Vector2d& p) const {
  const int slot = state_.slotOf(line);
  if (slot < 0) return 0.0;
  const int at = kLines + 2 * slot;
  const Matrix& P = state_.P;
  const Eigen::Vector2d along{n.y(), -n.x()};
  const Eigen::Vector3d drift{n.x(), n.y(), n.dot(turned90(p - state_.pivot))};
  const Eigen::Vector2d own{1.0, along.dot(p - state_.lines[static_cast<std::size_t>(slot)].reference)};
  return drift.dot(P.topLeftCorner<3, 3>() * drift) + own.dot(P.block<2, 2>(at, at) * own) +
         2.0 * drift.dot(P.block<3, 2>(0, at) * own);
}

SmallMotion JointAlignment::slip(const Eigen::Vector2d& robot, double turn_rad, double sigma_rad) {
  const SmallMotion motion{robot, Eigen::Vector2d::Zero(), turn_rad};
  state_.P(kTurn, kTurn) += sigma_rad * sigma_rad;
  if (state_.course_rad) *state_.course_rad += turn_rad;
  for (Line& line : state_.lines) line.reference = motion.apply(line.reference);
  return motion;
}

void JointAlignment::beginImage(State& state, const Eigen::Vector2d& robot,
                                const std::optional<double>& course_rad, const Params& params) const {
  state.pivot = robot;
  state.P_sway.setZero();
  Eigen::Block<Matrix> P = state.known();
  P.middleRows<4>(kSway).setZero();
  P.middleCols<4>(kSway).setZero();
  P.block<2, 2>(kSway, kSway).diagonal().setConstant(lean_params_.sway_rad * lean_params_.sway_rad);
  P.block<2, 2>(kSway + 2, kSway + 2).diagonal().setConstant(params.sway_shift_m * params.sway_shift_m);
  for (Line& line : state.lines) ++line.unseen;
  if (!course_rad || state.course_rad) return;
  state.course_rad = course_rad;
  P.row(kCourse).setZero();
  P.col(kCourse).setZero();
  P(kCourse, kCourse) = kFirstCourse * kFirstCourse;
}

void JointAlignment::list(State& state, const Eigen::Vector2d& robot,
                          std::span<const JointResidual> residuals, std::span<const LineDirection> directions,
                          const Params& params) const {
  std::vector<Row>& rows = told_.rows;
  rows.clear();
  for (const LineDirection& named : directions) {
    const int slot = state.slotOf(named.line);
    if (!state.course_rad || slot < 0 || rows.size() == kMostResiduals) continue;
    Line& line = state.lines[static_cast<std::size_t>(slot)];
    if (line.in_course) continue;
    const double off = offCourse(named.direction_rad, *state.course_rad);
    if (std::abs(off) > params.together_rad) continue;
    line.in_course = true;
    Row& row = rows.emplace_back();
    row.add(kCourse, -1.0);
    row.add(kLines + 2 * slot + 1, 1.0);
    row.residual = -off;
    row.variance = params.course_rad * params.course_rad;
  }
  for (const JointResidual& residual : residuals) {
    if (rows.size() == kMostResiduals) return;
    const DriftResidual& c = residual.common;
    Row& row = rows.emplace_back();
    row.residual = c.residual_m;
    row.variance = c.variance_m2;
    for (int k = 0; k < 2; ++k) row.add(k, c.direction[k]);
    row.add(kTurn, c.direction.dot(turned90(c.p - robot)));
    for (int k = 0; k < 4; ++k) row.add(kLean + k, -c.d_lean[k]);
    for (int k = 0; k < 2; ++k) row.add(kSway + k, -c.d_sway[k]);
    for (int k = 0; k < 2; ++k) row.add(kSway + 2 + k, c.direction[k]);
    const int slot = residual.line ? state.slotOf(residual.line) : -1;
    if (slot < 0) continue;
    Line& line = state.lines[static_cast<std::size_t>(slot)];
    const int at = kLines + 2 * slot;
    if (line.unseen > 0) {
      state.P(at, at) += params.offset_noise_m * params.offset_noise_m;
      state.P(at + 1, at + 1) += params.turn_noise_rad * params.turn_noise_rad;
      line.unseen = 0;
    }
    // The direction across the line looks to its left.
    const Eigen::Vector2d along{c.direction.y(), -c.direction.x()};
    row.add(at, 1.0);
    row.add(at + 1, along.dot(c.p - line.reference));
  }
}

bool JointAlignment::hear(State& state, const Eigen::Vector2d& robot,
                          std::span<const JointResidual> residuals, std::span<const LineDirection> directions,
                          const Params& params) const {
  list(state, robot, residuals, directions, params);
  const std::vector<Row>& rows = told_.rows;
  if (rows.empty()) return false;
  const int n = state.size();
  const int m = static_cast<int>(rows.size());
  const Eigen::Block<Matrix> P = state.known();
  auto PHt = told_.PHt.topLeftCorner(n, m);
  auto spread = told_.spread.topLeftCorner(m, m);
  auto x = told_.x.head(n);
  auto y = told_.y.head(m);
  Eigen::Ref<Matrix> L = told_.L.topLeftCorner(m, m);
  // Each row names few of the unknowns.
  PHt.setZero();
  for (int j = 0; j < m; ++j) {
    const Row& row = rows[static_cast<std::size_t>(j)];
    for (int k = 0; k < row.count; ++k) PHt.col(j) += row.factors[k] * P.col(row.unknowns[k]);
    for (int i = j; i < m; ++i) spread(i, j) = rows[static_cast<std::size_t>(i)].dot(PHt.col(j));
  }
  x.setZero();
  for (int iteration = 0; iteration < params.drift.iterations; ++iteration) {
    L.triangularView<Eigen::Lower>() = spread;
    for (int i = 0; i < m; ++i) {
      const Row& row = rows[static_cast<std::size_t>(i)];
      // The gate opens by what the drift may be; at the end only what agrees with the rest counts.
      const double known = row.variance + (iteration == 0 ? spread(i, i) : 0.0);
      const double off = std::abs(row.residual - row.dot(x)) / std::sqrt(known);
      L(i, i) += off > params.drift.gate    ? kNothing
                 : off > params.drift.huber ? row.variance * off / params.drift.huber
                                            : row.variance;
      y[i] = row.residual;
    }
    const Eigen::LLT<Eigen::Ref<Matrix>> inPlace(L);
    if (inPlace.info() != Eigen::Success) return false;  // not with variances above 0
    inPlace.solveInPlace(y);
    x.noalias() = PHt * y;
  }
  auto sways = told_.LiHP.block(0, kSway, m, 2);
  sways = PHt.middleRows<2>(kSway).transpose();
  L.triangularView<Eigen::Lower>().solveInPlace(sways);
  state.P_sway = P.block<2, 2>(kSway, kSway) - sways.transpose().lazyProduct(sways);
  return true;
}

// P - P H^T (H P H^T + R)^-1 H P.
void JointAlignment::learn() {
  const int n = state_.size();
  const int m = static_cast<int>(told_.rows.size());
  auto LiHP = told_.LiHP.topLeftCorner(m, n);
  LiHP = told_.PHt.topLeftCorner(n, m).transpose();
  // So few columns at a time that Eigen's buffers for them stay on the stack.
  constexpr int kAtOnce = 32;
  for (int j = 0; j < n; j += kAtOnce) {
    auto some = LiHP.middleCols(j, std::min(kAtOnce, n - j));
    told_.L.topLeftCorner(m, m).triangularView<Eigen::Lower>().solveInPlace(some);
  }
  // One triangle is computed, column by column: products of whole matrices would pack them on the heap.
  Eigen::Block<Matrix> P = state_.known();
  for (int j = 0; j < n; ++j) {
    P.col(j).tail(n - j).noalias() -= LiHP.rightCols(n - j).transpose() * LiHP.col(j);
    P(j, j) = std::max(P(j, j), kLeastVariance);
    P.row(j).tail(n - j - 1) = P.col(j).tail(n - j - 1).transpose();
  }
}

std::optional<Correction> JointAlignment::look(const Eigen::Vector2d& robot,
                                               std::span<const JointResidual> residuals,
                                               const std::optional<double>& course_rad,
                                               std::span<const LineDirection> directions,
                                               const Params& params) const {
  trial_.copy(state_);
  beginImage(trial_, robot, course_rad, params);
  if (!hear(trial_, robot, residuals, directions, params)) return std::nullopt;
  const Eigen::VectorXd& x = told_.x;
  return Correction{{robot, x.head<2>(), x[kTurn]}, x.segment<4>(kLean), x.segment<2>(kSway), trial_.P_sway};
}

std::optional<Correction> JointAlignment::solve(const Eigen::Vector2d& robot,
                                                std::span<const JointResidual> residuals,
                                                const std::optional<double>& course_rad,
                                                std::span<const LineDirection> directions,
                                                const Params& params) {
  corrections_.clear();
  beginImage(state_, robot, course_rad, params);
  if (!hear(state_, robot, residuals, directions, params)) return std::nullopt;
  learn();

  const Eigen::VectorXd& x = told_.x;
  Matrix& P = state_.P;
  Correction correction{{robot, x.head<2>(), x[kTurn]}, Lean::Zero(), x.segment<2>(kSway), state_.P_sway};
  const Lean before = lean_;
  lean_ += x.segment<4>(kLean);
  rates_ += x.segment<2>(kRates);
  const Eigen::Vector2d most_rates{params.drift.turn_per_rad, params.drift.turn_per_m};
  keepRatesWithin(most_rates, rates_, P.block<2, 2>(kRates, kRates));
  keepWithin(lean_params_, lean_, P.block<4, 4>(kLean, kLean));
  correction.lean = lean_ - before;
  if (state_.course_rad) *state_.course_rad += x[kTurn] + x[kCourse];
  const Eigen::Matrix4d lean_information = leanCovariance().inverse();
  int at = kLines;
  for (Line& known : state_.lines) {
    known.reference = correction.motion.apply(known.reference);
    LineCorrection line{known.id, known.reference, x[at], x[at + 1], P.block<2, 2>(at, at), {}};
    line.J = P.block<2, 4>(at, kLean) * lean_information;
    line.P -= line.J * P.block<4, 2>(kLean, at);
    corrections_.push_back(line);
    at += 2;
  }
  return correction;
}

void JointAlignment::begin(std::uint64_t line, const FloorSegment& observed, const LeaningView& view,
                           double noise, double slack_m) {
  std::vector<Line>& lines = state_.lines;
  if (static_cast<int>(lines.size()) >= kMostLines) {
    const auto longest = std::max_element(lines.begin(), lines.end(),
                                          [](const Line& a, const Line& b) { return a.unseen < b.unseen; });
    remove(static_cast<int>(longest - lines.begin()));
  }
  const Eigen::Vector2d middle = observed.odom.middle();
  const double length = observed.odom.length();
  const Eigen::Vector2d along = (observed.odom.b - observed.odom.a) / length;
  const Eigen::Vector2d normal = turned90(along);
  // How its place follows the unknowns that there are without lines.
  using CommonRow = Eigen::Matrix<double, 1, kLines>;
  const auto row = [&](const Eigen::Vector2d& p) {
    CommonRow g = CommonRow::Zero();
    const LeanRow d = normal.transpose() * view.derivativeAt(p);
    g.head<2>() = -normal;
    g[kTurn] = -normal.dot(turned90(p - state_.pivot));
    g.segment<4>(kLean) = d;
    g.segment<2>(kSway) = d.head<2>();
    g.segment<2>(kSway + 2) = -normal;
    return g;
  };
  const CommonRow a = row(observed.odom.a);
  const CommonRow b = row(observed.odom.b);
  Eigen::Matrix<double, 2, kLines> G;
  G.row(0) = 0.5 * (a + b);
  G.row(1) = (b - a) / length;
  const auto own = [&](const Eigen::Matrix2d& P, const FloorLean& D) {
    const Eigen::Matrix2d without = P - D.leftCols<2>() * state_.P_sway * D.leftCols<2>().transpose();
    return noise * (ownVariance(normal, without, D, observed.pitch_sigma_rad) + slack_m * slack_m);
  };
  const double va = own(observed.P_a, observed.D_a);
  const double vb = own(observed.P_b, observed.D_b);
  Eigen::Matrix2d R;
  R << 0.25 * (va + vb), 0.5 * (vb - va) / length, 0.5 * (vb - va) / length, (va + vb) / (length * length);
  Matrix& P = state_.P;
  const int n = state_.size();
  P.block(n, 0, 2, n).noalias() = G.lazyProduct(P.topLeftCorner(kLines, n));
  P.block(0, n, n, 2) = P.block(n, 0, 2, n).transpose();
  P.block<2, 2>(n, n) = P.block<2, kLines>(n, 0).lazyProduct(G.transpose()) + R;
  lines.push_back({line, middle, false, 0});
}

void JointAlignment::beginAs(std::uint64_t line, std::uint64_t known) {
  const int slot = state_.slotOf(known);
  if (slot < 0 || static_cast<int>(state_.lines.size()) >= kMostLines) return;
  const int n = state_.size();
  const int at = kLines + 2 * slot;
  Matrix& P = state_.P;
  P.block(n, 0, 2, n) = P.block(at, 0, 2, n);
  P.block(0, n, n, 2) = P.block(0, at, n, 2);
  P.block<2, 2>(n, n) = P.block<2, 2>(at, at);
  Line same = state_.lines[static_cast<std::size_t>(slot)];
  same.id = line;
  state_.lines.push_back(same);
}

}  // namespace vismem
