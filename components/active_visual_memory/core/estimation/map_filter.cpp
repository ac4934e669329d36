#include "active_visual_memory/core/estimation/map_filter.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "active_visual_memory/core/estimation/covariance_kernels.h"
#include "active_visual_memory/core/estimation/dominant_direction.h"
#include "active_visual_memory/core/estimation/measurement_models.h"
#include "active_visual_memory/core/estimation/state_limits.h"
#include "common/geometry/plane.h"

namespace vismem {
namespace {

constexpr double kLeastVariance = 1e-12;   // [m^2], [rad^2]: of unknowns fixed by their prior
constexpr double kInitialDirection = 0.2;  // [rad] prior sigma of the dominant direction
constexpr double kCorrelatedSteps = 5.0;   // steps over which odometry errors are correlated
constexpr double kIgnored = 1e12;          // variance of a rejected residual

}  // namespace

MapFilter::State::State() : P(Matrix::Zero(kStride, kStride)) {
  lines.reserve(kMaxLines);
}

void MapFilter::State::copy(const State& other) {
  lines = other.lines;
  known() = other.P.topLeftCorner(size(), size());
  dominant_direction_rad = other.dominant_direction_rad;
  pivot = other.pivot;
  P_frame_tilt = other.P_frame_tilt;
}

int MapFilter::State::slotOf(std::uint64_t line) const {
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (lines[i].id == line) return static_cast<int>(i);
  }
  return -1;
}

MapFilter::Innovation::Innovation()
    : W(kStride, kMaxResiduals),
      panels(kStride, kMaxResiduals),
      spread(kMaxResiduals, kMaxResiduals),
      L(kMaxResiduals + kKernelRows, kMaxResiduals),
      R(kMaxResiduals),
      Hx(kMaxResiduals),
      y(kMaxResiduals),
      x(kMaxUnknowns) {
  rows.reserve(kMaxResiduals);
}

void MapFilter::Row::add(int unknown, double factor) {
  if (factor == 0.0) return;
  unknowns[count] = unknown;
  factors[count] = factor;
  ++count;
}

MapFilter::MapFilter(const TiltPrior& tilt_prior) : tilt_prior_(tilt_prior) {
  corrections_.reserve(kMaxLines);
  state_.P.block<4, 4>(kTilt, kTilt) = tilt_prior.prior();
}

void MapFilter::reset() {
  const CameraTiltCovariance camera_tilt = cameraTiltCovariance();
  const Eigen::Matrix3d rates = state_.P.block<3, 3>(kRates, kRates);
  state_.lines.clear();
  corrections_.clear();
  state_.dominant_direction_rad.reset();
  state_.known().setZero();
  state_.P.block<4, 4>(kTilt, kTilt) = camera_tilt;
  state_.P.block<3, 3>(kRates, kRates) = rates;
}

void MapFilter::remove(int slot) {
  // The last line takes its place.
  const int at = kLines + 2 * slot;
  const int n = state_.size();
  Matrix& P = state_.P;
  P.block(at, 0, 2, n) = P.block(n - 2, 0, 2, n);
  P.block(0, at, n, 2) = P.block(0, n - 2, n, 2);
  P.block<2, 2>(at, at) = P.block<2, 2>(n - 2, n - 2);
  state_.lines[static_cast<std::size_t>(slot)] = state_.lines.back();
  state_.lines.pop_back();
}

void MapFilter::replaceLine(std::uint64_t known, std::uint64_t line) {
  if (!contains(known)) return;
  removeLine(line);
  state_.lines[static_cast<std::size_t>(state_.slotOf(known))].id = line;
}

void MapFilter::removeLine(std::uint64_t line) {
  const int slot = state_.slotOf(line);
  if (slot >= 0) remove(slot);
}

PlanarIncrement MapFilter::predict(const Pose2& before, const Pose2& now, const Params& params) {
  const Pose2 moved = inverse(before) * now;
  const double way = moved.position().norm();
  const double turn = std::abs(moved.theta);
  if (way == 0.0 && turn == 0.0) return {};
  const OdometryErrors& odometry = params.odometry;
  const Eigen::Vector3d most{odometry.turn_per_rad, odometry.turn_per_m, odometry.travel_scale};
  Eigen::Block<Matrix> P = state_.known();
  if (!moved_) {
    P.block<3, 3>(kRates, kRates) = most.cwiseAbs2().asDiagonal();
    moved_ = true;
  }
  const Eigen::Vector2d gone{moved.theta, std::copysign(way, moved.x)};
  const Eigen::Vector2d shifted = now.position() - before.position();
  const PlanarIncrement expected(before.position(), rates_[2] * shifted, gone.dot(rates_.head<2>()));
  // turn += gone * rates; then the drift is referred to the new place of the robot.
  const auto addRow = [&](int to, double factor, int from) {
    P.row(to) += factor * P.row(from);
    P.col(to) += factor * P.col(from);
  };
  addRow(kTurn, gone[0], kRates);
  addRow(kTurn, gone[1], kRates + 1);
  addRow(0, shifted.x(), kRates + 2);
  addRow(1, shifted.y(), kRates + 2);
  const Eigen::Vector2d lever = turned90(shifted);
  addRow(0, lever.x(), kTurn);
  addRow(1, lever.y(), kTurn);
  // Successive drift is correlated, so standard deviations add up, but only over some steps.
  const auto grow = [](double& variance, double sigma) {
    const double grown = std::sqrt(std::max(0.0, variance)) + sigma;
    variance = std::min(grown * grown, variance + kCorrelatedSteps * kCorrelatedSteps * sigma * sigma);
  };
  const double shift = odometry.shift_per_m * way + odometry.shift_per_rad * turn;
  grow(P(0, 0), shift);
  grow(P(1, 1), shift);
  P(kTurn, kTurn) += odometry.turn_noise * odometry.turn_noise * (way + odometry.feet_per_rad_m * turn);
  grow(P(kTurn, kTurn), kUnbiasedDriftShare * (odometry.turn_per_rad * turn + odometry.turn_per_m * way));
  if (state_.dominant_direction_rad) *state_.dominant_direction_rad += expected.turn_rad();
  for (Line& line : state_.lines) line.reference = expected.apply(line.reference);
  return expected;
}

double MapFilter::placeVariance(std::uint64_t line, const Eigen::Vector2d& n,
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

void MapFilter::beginImage(State& state, const ImageMeasurements& image, const Params& params) const {
  state.pivot = image.robot;
  state.P_frame_tilt.setZero();
  Eigen::Block<Matrix> P = state.known();
  P.middleRows<4>(kFrameTilt).setZero();
  P.middleCols<4>(kFrameTilt).setZero();
  P.block<2, 2>(kFrameTilt, kFrameTilt)
      .diagonal()
      .setConstant(tilt_prior_.per_frame_rad * tilt_prior_.per_frame_rad);
  const double frame_shift = params.gait_height_m * tilt_prior_.per_frame_rad;
  P.block<2, 2>(kFrameTilt + 2, kFrameTilt + 2).diagonal().setConstant(frame_shift * frame_shift);
  for (Line& line : state.lines) ++line.unseen;
  if (!image.dominant_direction_rad || state.dominant_direction_rad) return;
  state.dominant_direction_rad = image.dominant_direction_rad;
  P.row(kDirection).setZero();
  P.col(kDirection).setZero();
  P(kDirection, kDirection) = kInitialDirection * kInitialDirection;
}

void MapFilter::linearize(State& state, const ImageMeasurements& image, const Params& params) const {
  std::vector<Row>& rows = innovation_.rows;
  rows.clear();
  for (const LineDirection& named : image.directions) {
    const int slot = state.slotOf(named.line);
    if (!state.dominant_direction_rad || slot < 0 || rows.size() == kMaxResiduals) continue;
    Line& line = state.lines[static_cast<std::size_t>(slot)];
    if (line.has_direction) continue;
    const double off = offDominantDirection(named.direction_rad, *state.dominant_direction_rad);
    if (std::abs(off) > params.together_rad) continue;
    line.has_direction = true;
    Row& row = rows.emplace_back();
    row.add(kDirection, -1.0);
    row.add(kLines + 2 * slot + 1, 1.0);
    row.residual = -off;
    row.variance = params.direction_rad * params.direction_rad;
  }
  for (const LineResidual& c : image.residuals) {
    if (rows.size() == kMaxResiduals) return;
    Row& row = rows.emplace_back();
    row.residual = c.residual_m;
    row.variance = c.variance_m2;
    for (int k = 0; k < 2; ++k) row.add(k, c.direction[k]);
    row.add(kTurn, c.direction.dot(turned90(c.p - image.robot)));
    for (int k = 0; k < 4; ++k) row.add(kTilt + k, -c.d_tilt[k]);
    for (int k = 0; k < 2; ++k) row.add(kFrameTilt + k, -c.d_frame_tilt[k]);
    for (int k = 0; k < 2; ++k) row.add(kFrameTilt + 2 + k, c.direction[k]);
    const int slot = c.line ? state.slotOf(c.line) : -1;
    if (slot < 0) continue;
    Line& line = state.lines[static_cast<std::size_t>(slot)];
    const int at = kLines + 2 * slot;
    if (line.unseen > 0) {
      state.P(at, at) += params.offset_noise_m * params.offset_noise_m;
      state.P(at + 1, at + 1) += params.turn_noise_rad * params.turn_noise_rad;
      line.unseen = 0;
    }
    // The residual direction is the left normal of the line.
    const Eigen::Vector2d along{c.direction.y(), -c.direction.x()};
    row.add(at, 1.0);
    row.add(at + 1, along.dot(c.p - line.reference));
  }
}

void MapFilter::projectCovariance(const State& state) const {
  const std::vector<Row>& rows = innovation_.rows;
  const int n = state.size();
  const int m = static_cast<int>(rows.size());
  Matrix& PHt = innovation_.W;
  PHt.leftCols(m).setZero();
  std::array<ScaledColumn, Row::kMost> columns;
  for (int j = 0; j < m; ++j) {
    // Rows of H are sparse.
    const Row& row = rows[static_cast<std::size_t>(j)];
    for (int k = 0; k < row.count; ++k) columns[k] = {row.factors[k], state.P.col(row.unknowns[k]).data()};
    addColumns(PHt.col(j).data(), n, columns.data(), row.count);
    PHt.col(j).segment<kKernelRows>(n).setZero();
    for (int i = j; i < m; ++i) innovation_.spread(i, j) = rows[static_cast<std::size_t>(i)].dot(PHt.col(j));
  }
}

bool MapFilter::factorize() const {
  const int m = static_cast<int>(innovation_.rows.size());
  Matrix& L = innovation_.L;
  std::array<ScaledColumn, kMaxResiduals> columns;
  L.middleRows<kKernelRows>(m).leftCols(m).setZero();
  L.topLeftCorner(m, m).triangularView<Eigen::Lower>() = innovation_.spread.topLeftCorner(m, m);
  L.diagonal().head(m) += innovation_.R.head(m);
  for (int j = 0; j < m; ++j) {
    for (int k = 0; k < j; ++k) columns[k] = {-L(j, k), &L(j, k)};
    addColumns(&L(j, j), m - j, columns.data(), j);
    if (!(L(j, j) > 0.0)) return false;  // does not happen with variances above 0
    L.col(j).segment(j, m - j) /= std::sqrt(L(j, j));
  }
  return true;
}

void MapFilter::divideByFactor(int first, int end) const {
  const Matrix& L = innovation_.L;
  std::array<ScaledColumn, kMaxResiduals> columns;
  for (int j = 0; j < static_cast<int>(innovation_.rows.size()); ++j) {
    for (int k = 0; k < j; ++k) columns[k] = {-L(j, k), &innovation_.W(first, k)};
    addColumns(&innovation_.W(first, j), end - first, columns.data(), j);
    innovation_.W.col(j).segment(first, end - first) /= L(j, j);
  }
}

std::optional<Correction> MapFilter::solve(State& state, const ImageMeasurements& image,
                                           const Params& params) const {
  beginImage(state, image, params);
  linearize(state, image, params);
  const std::vector<Row>& rows = innovation_.rows;
  if (rows.empty()) return std::nullopt;
  const int n = state.size();
  const int m = static_cast<int>(rows.size());
  projectCovariance(state);
  auto R = innovation_.R.head(m);
  auto y = innovation_.y.head(m);
  auto Hx = innovation_.Hx.head(m);
  const auto spread = innovation_.spread.topLeftCorner(m, m);
  const auto L = innovation_.L.topLeftCorner(m, m).triangularView<Eigen::Lower>();
  Hx.setZero();
  for (int iteration = 0; iteration < params.iterations; ++iteration) {
    bool changed = iteration == 0;
    for (int i = 0; i < m; ++i) {
      const Row& row = rows[static_cast<std::size_t>(i)];
      // The first gate includes the prior variance of the residual; later ones compare with the estimate.
      const double known = row.variance + (iteration == 0 ? spread(i, i) : 0.0);
      const double off = std::abs(row.residual - Hx[i]) / std::sqrt(known);
      const double variance = off > params.gate    ? kIgnored
                              : off > params.huber ? row.variance * off / params.huber
                                                   : row.variance;
      changed = changed || variance != R[i];
      R[i] = variance;
    }
    if (!changed) break;
    if (!factorize()) return std::nullopt;
    for (int i = 0; i < m; ++i) y[i] = rows[static_cast<std::size_t>(i)].residual;
    L.solveInPlace(y);
    L.transpose().solveInPlace(y);
    Hx.noalias() = spread.selfadjointView<Eigen::Lower>() * y;
  }
  Eigen::VectorXd& x = innovation_.x;
  x.head(n).noalias() = innovation_.W.topLeftCorner(n, m) * y;
  divideByFactor(0, kCommon);
  const auto frame_tilts = innovation_.W.block(kFrameTilt, 0, 2, m);
  state.P_frame_tilt =
      state.P.block<2, 2>(kFrameTilt, kFrameTilt) - frame_tilts.lazyProduct(frame_tilts.transpose());
  return Correction{{image.robot, x.head<2>(), x[kTurn]},
                    x.segment<4>(kTilt),
                    x.segment<2>(kFrameTilt),
                    state.P_frame_tilt};
}

void MapFilter::updateCovariance() {
  const int n = state_.size();
  if (n > kCommon) divideByFactor(kCommon, n);
  subtractSquare(state_.P.data(), innovation_.W.data(), innovation_.panels.data(), kStride, n,
                 static_cast<int>(innovation_.rows.size()));
  for (int k = 0; k < n; ++k) state_.P(k, k) = std::max(state_.P(k, k), kLeastVariance);
}

std::optional<Correction> MapFilter::preview(const ImageMeasurements& image, const Params& params) const {
  preview_state_.copy(state_);
  return solve(preview_state_, image, params);
}

std::optional<Correction> MapFilter::update(const ImageMeasurements& image, const Params& params) {
  corrections_.clear();
  auto correction = solve(state_, image, params);
  if (!correction) return std::nullopt;
  updateCovariance();

  const Eigen::VectorXd& x = innovation_.x;
  Matrix& P = state_.P;
  const CameraTilt before = camera_tilt_;
  camera_tilt_ += x.segment<4>(kTilt);
  rates_ += x.segment<3>(kRates);
  const Eigen::Vector3d most_rates{params.odometry.turn_per_rad, params.odometry.turn_per_m,
                                   params.odometry.travel_scale};
  limitRates(most_rates, rates_, P.block<3, 3>(kRates, kRates));
  limitCameraTilt(tilt_prior_, camera_tilt_, P.block<4, 4>(kTilt, kTilt));
  correction->camera_tilt = camera_tilt_ - before;
  if (state_.dominant_direction_rad) *state_.dominant_direction_rad += x[kTurn] + x[kDirection];
  const Eigen::Matrix4d tilt_information = cameraTiltCovariance().inverse();
  int at = kLines;
  for (Line& known : state_.lines) {
    known.reference = correction->motion.apply(known.reference);
    LineCorrection line{known.id, known.reference, x[at], x[at + 1], P.block<2, 2>(at, at), {}};
    line.J = P.block<2, 4>(at, kTilt) * tilt_information;
    line.P -= line.J * P.block<4, 2>(kTilt, at);
    corrections_.push_back(line);
    at += 2;
  }
  return correction;
}

void MapFilter::addLine(std::uint64_t line, const FloorSegment& observed, const TiltView& view, double noise,
                        double slack_m) {
  std::vector<Line>& lines = state_.lines;
  if (static_cast<int>(lines.size()) >= kMaxLines) {
    const auto longest = std::max_element(lines.begin(), lines.end(),
                                          [](const Line& a, const Line& b) { return a.unseen < b.unseen; });
    remove(static_cast<int>(longest - lines.begin()));
  }
  const Eigen::Vector2d middle = observed.odom().middle();
  const double length = observed.odom().length();
  const Eigen::Vector2d along = (observed.b.p - observed.a.p) / length;
  const Eigen::Vector2d normal = turned90(along);
  // Jacobian of the offset at p by the common unknowns.
  using CommonRow = Eigen::Matrix<double, 1, kLines>;
  const auto row = [&](const Eigen::Vector2d& p) {
    CommonRow g = CommonRow::Zero();
    const TiltJacobianRow d = normal.transpose() * view.derivativeAt(p);
    g.head<2>() = -normal;
    g[kTurn] = -normal.dot(turned90(p - state_.pivot));
    g.segment<4>(kTilt) = d;
    g.segment<2>(kFrameTilt) = d.head<2>();
    g.segment<2>(kFrameTilt + 2) = -normal;
    return g;
  };
  const CommonRow a = row(observed.a.p);
  const CommonRow b = row(observed.b.p);
  Eigen::Matrix<double, 2, kLines> G;
  G.row(0) = 0.5 * (a + b);
  G.row(1) = (b - a) / length;
  const auto own = [&](FloorEnd end) {
    end.P -= end.D.leftCols<2>() * state_.P_frame_tilt * end.D.leftCols<2>().transpose();
    return noise * (ownVariance(normal, end, observed.pitch_sigma_rad) + slack_m * slack_m);
  };
  const double va = own(observed.a);
  const double vb = own(observed.b);
  Eigen::Matrix2d R;
  R << 0.25 * (va + vb), 0.5 * (vb - va) / length, 0.5 * (vb - va) / length, (va + vb) / (length * length);
  Matrix& P = state_.P;
  const int n = state_.size();
  P.block(n, 0, 2, n).noalias() = G.lazyProduct(P.topLeftCorner(kLines, n));
  P.block(0, n, n, 2) = P.block(n, 0, 2, n).transpose();
  P.block<2, 2>(n, n) = P.block<2, kLines>(n, 0).lazyProduct(G.transpose()) + R;
  lines.push_back({line, middle, false, 0});
}

void MapFilter::copyLine(std::uint64_t line, std::uint64_t known) {
  const int slot = state_.slotOf(known);
  if (slot < 0 || static_cast<int>(state_.lines.size()) >= kMaxLines) return;
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
