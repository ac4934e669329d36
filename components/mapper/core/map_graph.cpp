#include "mapper/core/map_graph.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "common/geometry/angles.h"
#include "common/geometry/plane.h"
#include "mapper/core/graph_residuals.h"
#include "mapper/core/heading_alignment.h"
#include "mapper/core/landmark_ends.h"

namespace vismem {
namespace {

using KeyframeBlock = std::array<double, graph::kKeyframe>;

graph::Rays raysOf(const Keyframe& keyframe, const LineSighting& sighting, double lever_m) {
  const auto at = [&](const Eigen::Vector2d& px) -> Eigen::Vector2d {
    return idealPixelRay(keyframe.intrinsics, px).head<2>();
  };
  return {keyframe.T_robot_camera.linear(),
          keyframe.T_robot_camera.translation(),
          at(sighting.px.a),
          at(sighting.px.b),
          keyframe.intrinsics.fx,
          lever_m};
}

const LineSighting& sightingOf(const DriveRecord& record, const LineLandmark::Seen& seen) {
  return record.keyframes[static_cast<std::size_t>(seen.keyframe)]
      .sightings[static_cast<std::size_t>(seen.sighting)];
}

KeyframeBlock blockOf(const MapState& state, int keyframe) {
  const Pose2& pose = state.poses[static_cast<std::size_t>(keyframe)];
  const Eigen::Vector2d& tilt = state.frame_tilts[static_cast<std::size_t>(keyframe)];
  return {pose.x, pose.y, pose.theta, tilt.x(), tilt.y()};
}

/// One problem over a state; its parameter blocks are copies until they are written back.
class Problem {
 public:
  Problem(const DriveRecord& record, const GraphParams& params, const SolveStage& stage, MapState& state,
          const std::vector<Closing>& closings);

  SolveReport solve();
  std::string covariances();
  std::vector<Eigen::Matrix3d> relative(const std::vector<Closing>& pairs);

 private:
  ceres::LossFunction* kernel() const {
    return stage_.kernel > 0.0 ? new ceres::CauchyLoss(stage_.kernel) : nullptr;
  }
  /// Blocks: those of both keyframes, which are one where the anchor itself saw it, then the others.
  template <typename Residual, int kResiduals, int... kSizes, typename... Blocks>
  ceres::ResidualBlockId addSighting(Residual* residual, double* anchor, double* at, Blocks*... blocks) {
    using graph::kKeyframe;
    if (at == anchor) {
      return problem_.AddResidualBlock(
          new ceres::AutoDiffCostFunction<Residual, kResiduals, kKeyframe, kSizes...>(residual), kernel(), at,
          blocks...);
    }
    return problem_.AddResidualBlock(
        new ceres::AutoDiffCostFunction<Residual, kResiduals, kKeyframe, kKeyframe, kSizes...>(residual),
        kernel(), anchor, at, blocks...);
  }
  void addOdometry();
  void addPriors();
  void addLandmark(LineLandmark& landmark);
  void addEnd(LineLandmark& landmark, const LineLandmark::Seen& seen, const graph::Rays& rays, bool at_b,
              double sigma_px);
  void addCircle(CircleLandmark& circle);
  void addClosing(const Closing& closing);
  void addRightAngles();
  void addConstraint(const LineConstraint& constraint);
  double noiseOf(const std::vector<ceres::ResidualBlockId>& blocks);
  Eigen::Matrix2d chordCovariance(const LineLandmark& chord) const;
  void writeBack();

  const DriveRecord& record_;
  const GraphParams& params_;
  SolveStage stage_;
  MapState& state_;
  std::vector<KeyframeBlock> keyframes_;
  std::array<double, 1> dominant_{};
  std::vector<ceres::ResidualBlockId> lines_;
  std::vector<ceres::ResidualBlockId> ends_;
  ceres::Problem problem_;
};

Problem::Problem(const DriveRecord& record, const GraphParams& params, const SolveStage& stage,
                 MapState& state, const std::vector<Closing>& closings)
    : record_(record), params_(params), stage_(stage), state_(state) {
  for (int k = 0; k < static_cast<int>(state.poses.size()); ++k) keyframes_.push_back(blockOf(state, k));
  addOdometry();
  addPriors();
  for (LineLandmark& landmark : state.landmarks) addLandmark(landmark);
  for (CircleLandmark& circle : state.circles) addCircle(circle);
  for (const Closing& closing : closings) addClosing(closing);
  if (stage.right_angles) addRightAngles();
  for (const LineConstraint& constraint : stage.constraints) addConstraint(constraint);
  problem_.SetManifold(keyframes_.front().data(),
                       new ceres::SubsetManifold(graph::kKeyframe, std::vector<int>{0, 1, 2}));
}

void Problem::addOdometry() {
  const OdometryErrors& errors = params_.odometry;
  constexpr double kLeast_m = 0.002;
  constexpr double kLeast_rad = 0.001;
  for (std::size_t k = 1; k < keyframes_.size(); ++k) {
    const Keyframe& before = record_.keyframes[k - 1];
    const Keyframe& now = record_.keyframes[k];
    const double way = now.way_m - before.way_m;
    const double turned = now.turned_rad - before.turned_rad;
    auto* cost = new graph::OdometryResidual{
        inverse(before.T_odom_robot) * now.T_odom_robot,
        std::hypot(kLeast_m, errors.shift_per_m * way, errors.shift_per_rad * turned),
        std::hypot(kLeast_rad, errors.turn_noise * std::sqrt(way + errors.feet_per_rad_m * turned))};
    problem_.AddResidualBlock(new ceres::AutoDiffCostFunction<graph::OdometryResidual, 3, graph::kKeyframe,
                                                              graph::kKeyframe, graph::kOdometry>(cost),
                              nullptr, keyframes_[k - 1].data(), keyframes_[k].data(),
                              state_.odometry.data());
  }
}

void Problem::addPriors() {
  const OdometryErrors& errors = params_.odometry;
  const TiltPrior& tilt = params_.tilt;
  using Odometry = graph::PriorResidual<3>;
  problem_.AddResidualBlock(new ceres::AutoDiffCostFunction<Odometry, 3, graph::kOdometry>(new Odometry{
                                0, {errors.travel_scale, errors.turn_per_rad, errors.turn_per_m}}),
                            nullptr, state_.odometry.data());
  using Tilt = graph::PriorResidual<4>;
  problem_.AddResidualBlock(new ceres::AutoDiffCostFunction<Tilt, 4, graph::kTilt>(new Tilt{
                                0, {tilt.mount_rad, tilt.mount_rad, tilt.camera_rad, tilt.camera_rad}}),
                            nullptr, state_.camera_tilt.data());
  std::vector<int> fixed;
  for (int i = 0; i < graph::kTilt; ++i) {
    if ((i < 2 ? tilt.mount_rad : tilt.camera_rad) <= 0.0) fixed.push_back(i);
  }
  if (fixed.size() == graph::kTilt) {
    problem_.SetParameterBlockConstant(state_.camera_tilt.data());
  } else if (!fixed.empty()) {
    problem_.SetManifold(state_.camera_tilt.data(), new ceres::SubsetManifold(graph::kTilt, fixed));
  }
  const double per_frame = std::max(1e-5, tilt.per_frame_rad);
  using Frame = graph::PriorResidual<2>;
  for (KeyframeBlock& keyframe : keyframes_) {
    problem_.AddResidualBlock(
        new ceres::AutoDiffCostFunction<Frame, 2, graph::kKeyframe>(new Frame{3, {per_frame, per_frame}}),
        nullptr, keyframe.data());
  }
}

void Problem::addLandmark(LineLandmark& landmark) {
  using graph::LineResidual;
  if (landmark.isChord()) return;
  for (const LineLandmark::Seen& seen : landmark.seen) {
    const Keyframe& keyframe = record_.keyframes[static_cast<std::size_t>(seen.keyframe)];
    const graph::Rays rays = raysOf(keyframe, sightingOf(record_, seen), params_.lever_m);
    const double timing_px = params_.timing_s * keyframe.turn_rate_radps * rays.focal_px;
    const double across_px = std::hypot(params_.across_px, timing_px);
    auto* cost = new LineResidual{rays, landmark.reference, landmark.direction_rad, across_px};
    double* at = keyframes_[static_cast<std::size_t>(seen.keyframe)].data();
    double* anchor = keyframes_[static_cast<std::size_t>(landmark.anchor)].data();
    double* tilt = state_.camera_tilt.data();
    lines_.push_back(addSighting<LineResidual, 2, graph::kLine, graph::kTilt>(cost, anchor, at,
                                                                              landmark.line.data(), tilt));
    if (!stage_.ends) continue;
    const double along_px = std::hypot(params_.along_px, timing_px);
    addEnd(landmark, seen, rays, false, along_px);
    addEnd(landmark, seen, rays, true, along_px);
  }
}

void Problem::addEnd(LineLandmark& landmark, const LineLandmark::Seen& seen, const graph::Rays& rays,
                     bool at_b, double sigma_px) {
  using graph::EndResidual;
  LandmarkEnd& end = at_b ? landmark.b : landmark.a;
  const LineSighting& sighting = sightingOf(record_, seen);
  if (!end.closed || (at_b ? sighting.censored_b : sighting.censored_a)) return;
  const EndResidual residual{rays, at_b, landmark.reference, landmark.direction_rad, sigma_px};
  double* at = keyframes_[static_cast<std::size_t>(seen.keyframe)].data();
  double* anchor = keyframes_[static_cast<std::size_t>(landmark.anchor)].data();
  double* tilt = state_.camera_tilt.data();
  double off = 0.0;
  if (!residual.evaluate<double>(anchor, at, landmark.line.data(), &end.t_m, tilt, &off)) return;
  if (std::abs(off) * sigma_px > params_.end_gate_px) {
    // On the floor: under the camera a centimetre is hundreds of pixels.
    const auto placed = seenEnd(record_, state_, landmark, seen, at_b, sigma_px);
    if (!placed || std::abs(placed->t_m - end.t_m) > params_.end_gate_m) return;
  }
  ends_.push_back(addSighting<EndResidual, 1, graph::kLine, graph::kEnd, graph::kTilt>(
      new EndResidual(residual), anchor, at, landmark.line.data(), &end.t_m, tilt));
}

void Problem::addCircle(CircleLandmark& circle) {
  using graph::CircleResidual;
  constexpr double kWide_m = 1.0;
  double* shape = circle.shape.data();
  // An edge of which nothing was seen is held by nothing else.
  using Radii = graph::PriorResidual<graph::kCircle>;
  problem_.AddResidualBlock(new ceres::AutoDiffCostFunction<Radii, graph::kCircle, graph::kCircle>(
                                new Radii{0, {0.0, 0.0, kWide_m, kWide_m}}),
                            nullptr, shape);
  for (const CircleLandmark::Seen& seen : circle.seen) {
    const Keyframe& keyframe = record_.keyframes[static_cast<std::size_t>(seen.chord.keyframe)];
    graph::Rays rays = raysOf(keyframe, sightingOf(record_, seen.chord), params_.lever_m);
    rays.a = seen.cuts[0];
    rays.b = seen.cuts[1];
    const double timing_px = params_.timing_s * keyframe.turn_rate_radps * rays.focal_px;
    auto* cost = new CircleResidual{rays, circle.centre, circle.radius_m[seen.is_left], seen.is_left,
                                    seen.px_m * std::hypot(params_.across_px, timing_px)};
    double* at = keyframes_[static_cast<std::size_t>(seen.chord.keyframe)].data();
    double* anchor = keyframes_[static_cast<std::size_t>(circle.anchor)].data();
    double* tilt = state_.camera_tilt.data();
    addSighting<CircleResidual, 2, graph::kCircle, graph::kTilt>(cost, anchor, at, shape, tilt);
  }
}

void Problem::addClosing(const Closing& closing) {
  // The race saw the same edges: the landmarks count, the closing only holds what they leave open.
  constexpr double kWeaker = 9.0;
  problem_.AddResidualBlock(
      new ceres::AutoDiffCostFunction<graph::RelativePose, 3, graph::kKeyframe, graph::kKeyframe>(
          new graph::RelativePose{closing.T_from_to, graph::whiteningOf(kWeaker * closing.P)}),
      new ceres::CauchyLoss(1.0), keyframes_[static_cast<std::size_t>(closing.from)].data(),
      keyframes_[static_cast<std::size_t>(closing.to)].data());
}

void Problem::addRightAngles() {
  using graph::RightAngleResidual;
  const auto dominant = dominantDirectionOf(state_, params_.right_angle_gate_rad);
  if (!dominant) return;
  dominant_[0] = *dominant;
  for (LineLandmark& landmark : state_.landmarks) {
    if (landmark.isChord()) continue;
    const double direction = state_.worldSegment(landmark).direction();
    if (std::abs(std::sin(2.0 * (direction - *dominant))) > 2.0 * params_.right_angle_gate_rad) continue;
    problem_.AddResidualBlock(
        new ceres::AutoDiffCostFunction<RightAngleResidual, 1, graph::kKeyframe, graph::kLine, 1>(
            new RightAngleResidual{landmark.direction_rad, params_.right_angle_rad}),
        new ceres::CauchyLoss(1.0), keyframes_[static_cast<std::size_t>(landmark.anchor)].data(),
        landmark.line.data(), dominant_.data());
  }
}

void Problem::addConstraint(const LineConstraint& constraint) {
  constexpr double kSigma_m = 0.001;
  constexpr double kSigma_rad = 0.0005;
  LineLandmark& one = state_.landmarks[constraint.one];
  LineLandmark& other = state_.landmarks[constraint.other];
  if (constraint.kind == LineConstraint::Kind::kLength) {
    problem_.AddResidualBlock(
        new ceres::AutoDiffCostFunction<graph::LengthResidual, 1, graph::kEnd, graph::kEnd>(
            new graph::LengthResidual{constraint.length_m, kSigma_m}),
        nullptr, &one.a.t_m, &one.b.t_m);
    // Ends that no image saw are held by nothing else: one of them stays.
    for (LandmarkEnd* end : {&one.a, &one.b}) {
      problem_.AddResidualBlock(new ceres::AutoDiffCostFunction<graph::PlacedEndResidual, 1, graph::kEnd>(
                                    new graph::PlacedEndResidual{end->t_m, end->closed ? 0.05 : 0.5}),
                                nullptr, &end->t_m);
      end->closed = true;
    }
    return;
  }
  double* anchor = keyframes_[static_cast<std::size_t>(one.anchor)].data();
  double* anchor_other = keyframes_[static_cast<std::size_t>(other.anchor)].data();
  const auto add = [&]<typename Cost, int kResiduals>(Cost* cost) {
    using graph::kKeyframe;
    using graph::kLine;
    if (anchor == anchor_other) {
      problem_.AddResidualBlock(
          new ceres::AutoDiffCostFunction<Cost, kResiduals, kKeyframe, kLine, kLine>(cost), nullptr, anchor,
          one.line.data(), other.line.data());
    } else {
      problem_.AddResidualBlock(
          new ceres::AutoDiffCostFunction<Cost, kResiduals, kKeyframe, kLine, kKeyframe, kLine>(cost),
          nullptr, anchor, one.line.data(), anchor_other, other.line.data());
    }
  };
  if (constraint.kind == LineConstraint::Kind::kSquare) {
    add.template operator()<graph::SquareResidual, 1>(
        new graph::SquareResidual{one.direction_rad, other.direction_rad, kSigma_rad});
  } else {
    add.template operator()<graph::StraightResidual, 2>(
        new graph::StraightResidual{one.reference, other.reference, one.direction_rad, other.direction_rad,
                                    other.a.t_m, other.b.t_m, kSigma_m});
  }
}

void Problem::writeBack() {
  for (std::size_t k = 0; k < keyframes_.size(); ++k) {
    const KeyframeBlock& block = keyframes_[k];
    state_.poses[k] = {block[0], block[1], wrapAngle(block[2])};
    state_.frame_tilts[k] = {block[3], block[4]};
  }
}

/// Robust sigma of residuals; 1 for too few.
double Problem::noiseOf(const std::vector<ceres::ResidualBlockId>& blocks) {
  constexpr std::size_t kLeast = 30;
  constexpr double kMedianOfSigma = 0.6745;
  std::vector<double> sizes;
  for (const ceres::ResidualBlockId block : blocks) {
    const auto count =
        static_cast<std::size_t>(problem_.GetCostFunctionForResidualBlock(block)->num_residuals());
    std::array<double, 2> off{};
    double cost = 0.0;
    if (!problem_.EvaluateResidualBlock(block, false, &cost, off.data(), nullptr)) continue;
    for (std::size_t i = 0; i < count; ++i) sizes.push_back(std::abs(off[i]));
  }
  if (sizes.size() < kLeast) return 1.0;
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  return *middle / kMedianOfSigma;
}

SolveReport Problem::solve() {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.max_num_iterations = stage_.iterations;
  options.function_tolerance = stage_.tolerance;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem_, &summary);
  SolveReport report;
  report.cost = summary.final_cost;
  report.residuals = summary.num_residuals;
  report.iterations = static_cast<int>(summary.iterations.size());
  report.usable = summary.IsSolutionUsable();
  report.seconds = summary.total_time_in_seconds;
  report.line_noise = noiseOf(lines_);
  report.end_noise = noiseOf(ends_);
  if (!report.usable) report.problem = summary.message;
  if (report.usable) writeBack();
  return report;
}

Eigen::Matrix2d Problem::chordCovariance(const LineLandmark& chord) const {
  const CircleLandmark& circle = state_.circles[static_cast<std::size_t>(chord.circle)];
  const Eigen::Vector2d out = (chord.reference - circle.centre).normalized();
  const bool is_left = cross2(out, chord.along()) > 0.0;
  const Eigen::Vector4d J(out.x(), out.y(), is_left ? 0.0 : 1.0, is_left ? 1.0 : 0.0);
  const double variance = J.dot(circle.P * J);
  const double radius_m = circle.radius_m[is_left];
  return Eigen::Vector2d(variance, variance / (radius_m * radius_m)).asDiagonal();
}

std::string Problem::covariances() {
  ceres::Covariance::Options options;
  options.algorithm_type = ceres::SPARSE_QR;
  options.num_threads = 1;
  ceres::Covariance covariance(options);
  std::vector<std::pair<const double*, const double*>> blocks;
  const auto ask = [&](const double* block) {
    if (problem_.HasParameterBlock(block)) blocks.emplace_back(block, block);
  };
  for (const LineLandmark& landmark : state_.landmarks) {
    ask(landmark.line.data());
    ask(&landmark.a.t_m);
    ask(&landmark.b.t_m);
  }
  for (const CircleLandmark& circle : state_.circles) ask(circle.shape.data());
  if (!covariance.Compute(blocks, &problem_)) return "the graph does not determine all landmarks";
  for (CircleLandmark& circle : state_.circles) {
    Eigen::Matrix<double, graph::kCircle, graph::kCircle, Eigen::RowMajor> P;
    if (covariance.GetCovarianceBlock(circle.shape.data(), circle.shape.data(), P.data())) circle.P = P;
  }
  for (LineLandmark& landmark : state_.landmarks) {
    if (landmark.isChord()) landmark.P_line = chordCovariance(landmark);
    if (!problem_.HasParameterBlock(landmark.line.data())) continue;
    Eigen::Matrix<double, 2, 2, Eigen::RowMajor> P;
    if (!covariance.GetCovarianceBlock(landmark.line.data(), landmark.line.data(), P.data())) continue;
    landmark.P_line = P;
    const auto sigma = [&](const LandmarkEnd& end) {
      double variance = 0.0;
      if (!problem_.HasParameterBlock(&end.t_m)) return 0.0;
      covariance.GetCovarianceBlock(&end.t_m, &end.t_m, &variance);
      return std::sqrt(variance);
    };
    landmark.sigma_a_m = sigma(landmark.a);
    landmark.sigma_b_m = sigma(landmark.b);
  }
  return {};
}

std::vector<Eigen::Matrix3d> Problem::relative(const std::vector<Closing>& pairs) {
  ceres::Covariance::Options options;
  options.algorithm_type = ceres::SPARSE_QR;
  options.num_threads = 1;
  ceres::Covariance covariance(options);
  const auto block = [&](int k) { return keyframes_[static_cast<std::size_t>(k)].data(); };
  std::set<std::pair<const double*, const double*>> asked;
  for (const Closing& pair : pairs) {
    const double* from = block(pair.from);
    const double* to = block(pair.to);
    asked.insert({from, from});
    asked.insert({to, to});
    asked.insert(std::minmax(from, to));
  }
  std::vector<Eigen::Matrix3d> result;
  const std::vector<std::pair<const double*, const double*>> blocks(asked.begin(), asked.end());
  if (!covariance.Compute(blocks, &problem_)) return result;
  using Block = Eigen::Matrix<double, graph::kKeyframe, graph::kKeyframe, Eigen::RowMajor>;
  for (const Closing& pair : pairs) {
    const KeyframeBlock& from = keyframes_[static_cast<std::size_t>(pair.from)];
    const KeyframeBlock& to = keyframes_[static_cast<std::size_t>(pair.to)];
    Block from_from;
    Block from_to;
    Block to_to;
    covariance.GetCovarianceBlock(from.data(), from.data(), from_from.data());
    covariance.GetCovarianceBlock(from.data(), to.data(), from_to.data());
    covariance.GetCovarianceBlock(to.data(), to.data(), to_to.data());
    Eigen::Matrix<double, 6, 6> P;
    P << from_from.topLeftCorner<3, 3>(), from_to.topLeftCorner<3, 3>(),
        from_to.topLeftCorner<3, 3>().transpose(), to_to.topLeftCorner<3, 3>();
    const double c = std::cos(from[2]);
    const double s = std::sin(from[2]);
    const double dx = to[0] - from[0];
    const double dy = to[1] - from[1];
    Eigen::Matrix<double, 3, 6> J;
    J << -c, -s, -s * dx + c * dy, c, s, 0.0,  //
        s, -c, -c * dx - s * dy, -s, c, 0.0,   //
        0.0, 0.0, -1.0, 0.0, 0.0, 1.0;
    result.emplace_back(J * P * J.transpose());
  }
  return result;
}

}  // namespace

std::vector<Eigen::Matrix3d> relativeCovariances(const DriveRecord& record, const GraphParams& params,
                                                 const SolveStage& stage, MapState& state,
                                                 const std::vector<Closing>& pairs) {
  return Problem(record, params, stage, state, {}).relative(pairs);
}

GraphParams measured(const GraphParams& params, const SolveReport& report) {
  constexpr double kLeast_px = 0.05;  // no detector is better
  GraphParams result = params;
  result.across_px = std::max(kLeast_px, params.across_px * report.line_noise);
  result.along_px = std::max(kLeast_px, params.along_px * report.end_noise);
  // The measured noise holds what late joint stamps add, so both parts scale alike.
  result.timing_s *= result.across_px / params.across_px;
  return result;
}

SolveReport solveGraph(const DriveRecord& record, const GraphParams& params, const SolveStage& stage,
                       MapState& state, const std::vector<Closing>& closings) {
  return Problem(record, params, stage, state, closings).solve();
}

std::string addCovariances(const DriveRecord& record, const GraphParams& params, const SolveStage& stage,
                           MapState& state, const std::vector<Closing>& closings) {
  return Problem(record, params, stage, state, closings).covariances();
}

std::vector<double> lineErrors(const DriveRecord& record, const GraphParams& params, const MapState& state,
                               const LineLandmark& landmark) {
  std::vector<double> errors;
  const KeyframeBlock anchor = blockOf(state, landmark.anchor);
  for (const LineLandmark::Seen& seen : landmark.seen) {
    const Keyframe& keyframe = record.keyframes[static_cast<std::size_t>(seen.keyframe)];
    const graph::LineResidual residual{raysOf(keyframe, sightingOf(record, seen), params.lever_m),
                                       landmark.reference, landmark.direction_rad, 1.0};
    const KeyframeBlock at = blockOf(state, seen.keyframe);
    std::array<double, 2> off{};
    residual.evaluate<double>(anchor.data(), at.data(), landmark.line.data(), state.camera_tilt.data(),
                              off.data());
    errors.push_back(std::abs(off[0]));
    errors.push_back(std::abs(off[1]));
  }
  return errors;
}

}  // namespace vismem
