#include "localization/core/hypotheses/robust_races.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "common/geometry/angles.h"
#include "localization/core/likelihood/camera_calibration.h"
#include "localization/core/observation/novelty.h"

namespace vismem {
namespace {

constexpr double kExplorerBlur_m = 0.15;  // an explorer must come within about 0.3 m only
constexpr double kRefinementBlur_m = 0.08;
constexpr std::size_t kExplorerPoints = 64;
constexpr int kRefinementSteps = 3;      // Gauss-Newton, per race and iteration
constexpr double kSupportTime_s = 2.0;   // time constant of the support
constexpr double kEnoughPoints = 12.0;   // effective points from which an observation counts fully
constexpr double kExplainedLow = 0.35;   // explained share without support
constexpr double kExplainedHigh = 0.75;  // explained share with full support
/// Prior standard deviations that keep the covariance of an undetermined direction finite.
constexpr double kLargestStd_m = 5.0;
constexpr double kLargestStd_rad = 1.0;
/// Age constant [iterations] at which the required lead falls, to this share of it for an old race.
constexpr double kSettledAge = 20.0;
constexpr double kOldLead = 0.33;
constexpr double kUnambiguous = 0.8;  // share of belief
/// Unexplained share of the evidence of a robot at a place that no race holds. Winners in mirrored maps have
/// 0.35 to 0.55, right ones at most 0.25 in nearly all recordings and simulations, more where the map lacks
/// lines.
constexpr double kNoneUnexplained = 0.39;
/// Factor on the evidence against that hypothesis: what it predicts errs in all observations alike, so that
/// their mean counts as half an observation.
constexpr double kNoneScale = 0.5;
constexpr double kOdometryWalk = 0.02;   // of its lasting errors per root of a metre, relative to the prior
constexpr double kLeastTilt_rad = 1e-6;  // prior standard deviation of a tilt that is fixed at 0
/// Share of the heading's random walk in the reported variance. The rest keeps a race open to slips and
/// exceeds the growth of the error.
constexpr double kReportedTurnWalk = 0.1;
/// Points deviate by much less than their sigma where camera and map are good. Errors that all points share
/// do not show in them.
constexpr double kLeastVarianceFactor = 0.05;
constexpr double kVarianceGain = 0.1;  // of the running mean, per iteration
/// Camera direction that deviates by more from image to image, as on legs, hides lasting errors.
constexpr double kLegged_rad = degToRad(0.5);
constexpr StampUs kJustSeen_us = kSecondUs / 2;
/// Random walk of the tilt bias per square root of an iteration: a quarter of a degree in ten minutes.
constexpr double kTiltWalk_rad = 1e-4;
/// Prior standard deviation of x, y and theta of a pose that must not move [m, rad].
constexpr double kGivenStd = 1e-4;

/// Information matrix of a prior of the pose, without the tilt.
Matrix5d posePrior(double position_std_m, double heading_std_rad) {
  Vector5d information = Vector5d::Zero();
  information.head<2>().setConstant(1.0 / (position_std_m * position_std_m));
  information[2] = 1.0 / (heading_std_rad * heading_std_rad);
  return information.asDiagonal();
}

class RobustRaces : public RaceStrategy {
 public:
  RobustRaces(const SegmentMap& map_edges, const MapParams& map, const ExplorerParams& explorers,
              const RobustParams& params)
      : params_(params),
        explorers_(explorers),
        map_(map_edges, robustIndex(params.likelihood, map)),
        constructed_(map_),
        likelihood_(map_, params_.likelihood),
        history_(likelihood_, params.history),
        uniform_share_(uniformShare(map_, explorers.margin_m, params.explorers.uniform_area_m2)) {
    odometry_.P = params.filter.odometry_bias.cwiseAbs2().asDiagonal();
    updateTiltPrior();
  }

  /// A tilt of the camera on the head turns with the head, one of the robot does not.
  void beginImage(const ImageAnalysis& analysis, RaceTable& table) override {
    camera_.begin(analysis);
    const auto& axes = analysis.T_robot_camera.linear();
    const double heading = std::atan2(axes(1, 0), axes(0, 0));
    const double turn = angleDifference(heading, std::exchange(camera_heading_, heading));
    const double variance = turn * turn / tilt_.wideInformation();
    for (Race& race : table.races()) {
      for (Matrix5d* P : {&race.P, &race.P_reported}) P->diagonal().tail<2>().array() += variance;
    }
  }

  bool observe(const MemoryUpdate& update) override {
    analysis_ = update.analysis;
    updateTiltPrior();
    const auto view = analysis_ ? camera_.corrected() : std::nullopt;
    observation_ =
        vismem::observe(update, map_, params_.observation, view ? &*view : nullptr, std::move(observation_));
    const auto isNew = [&](const MemorySegment& segment) {
      return segment.last_seen_us + kJustSeen_us >= update.snapshot->stamp_us;
    };
    const auto& remembered = update.snapshot->segments;
    is_memory_current_ = observation_.remembered == observation_.points.size() &&
                         std::any_of(remembered.begin(), remembered.end(), isNew);
    few_ = thinned(observation_, kMaximumPoints, std::move(few_));
    std::swap(observation_.points, few_.points);
    observation_.remembered = few_.remembered;
    few_ = thinned(observation_, kExplorerPoints, std::move(few_));
    if (observation_.points.empty()) return false;
    T_odom_robot_ = update.snapshot->T_odom_robot;
    stamp_us_ = update.snapshot->stamp_us;
    history_.begin(observation_, T_odom_robot_, novelty_.assess(observation_, T_odom_robot_, stamp_us_));
    return true;
  }

  void predict(Race& race, const Pose2& T_before_now) const override {
    const RaceFilterParams& filter = params_.filter;
    const auto& [errors, P_errors] = race.odometry;
    const double turn = errors[0] * T_before_now.x + errors[1] * T_before_now.theta;
    // The additional turn happens along the way: on average half of it rotates the translation.
    const Pose2 direction{0.0, 0.0, race.T_world_robot.theta + 0.5 * turn};
    const Eigen::Vector2d shift =
        transform(direction, Eigen::Vector2d((1.0 + errors[2]) * T_before_now.position()));
    const Eigen::Vector2d across(-shift.y(), shift.x());
    Matrix5d F = Matrix5d::Identity();
    F.block<2, 1>(0, 2) = across;
    Eigen::Matrix<double, 5, 3> G = Eigen::Matrix<double, 5, 3>::Zero();  // derivative by the lasting errors
    G.row(2) << T_before_now.x, T_before_now.theta, 0.0;
    G.topRows<2>() = 0.5 * across * G.row(2);
    G.block<2, 1>(0, 2) = shift;
    const double travelled = shift.norm();
    const Eigen::Matrix<double, 5, 3> C = F * race.P_odometry;
    const Matrix5d biased = G * P_errors * G.transpose() + C * G.transpose() + G * C.transpose();
    race.P_odometry = C + G * P_errors;
    const Eigen::Vector3d walk = kOdometryWalk * filter.odometry_bias;
    race.odometry.P.diagonal() += travelled * walk.cwiseProduct(walk);
    for (Matrix5d* P : {&race.P, &race.P_reported}) {
      *P = F * *P * F.transpose() + biased;
      P->diagonal().head<3>() += filter.odometry.variances(travelled, std::abs(T_before_now.theta));
    }
    const Eigen::Vector2d position = race.T_world_robot.position() + shift;
    race.T_world_robot = {position.x(), position.y(),
                          wrapAngle(race.T_world_robot.theta + T_before_now.theta + turn)};
  }

  void weight(Race& race) const override {
    const Rating rating = likelihood_.rate(observation_, race.placement());
    race.health = rating.explained;
    race.log_likelihood = rating.log_likelihood;
  }

  /// Races that the table would not admit have a pose and a health only.
  std::span<Race> propose(int explorers, const RaceTable& table, RandomEngine& engine) override {
    explore(explorers, engine);
    keepBestPlaces(places_, params_.explorers.refined_explorers, explorers_.list_health, table.params());
    for (Individual& one : places_) {
      const auto refined = likelihood_.refine(few_, {one.T_world_robot}, broad_prior_, 1.0, kRefinementSteps,
                                              kRefinementBlur_m, tilt_);
      one = {refined.placement.T_world_robot, refined.rating.explained};
    }
    keepBestPlaces(places_, explorers_.candidates, explorers_.list_health, table.params());
    candidates_.clear();
    for (const Individual& place : places_) {
      const Placement refined = likelihood_
                                    .refine(observation_, {place.T_world_robot}, broad_prior_, 1.0,
                                            kRefinementSteps, kRefinementBlur_m, tilt_)
                                    .placement;
      candidates_.push_back(ratedAt(refined));
    }
    double most_health = 0.0;
    for (const Race& race : candidates_) most_health = std::max(most_health, race.health);
    for (Race& race : candidates_) {
      // Most candidates lie at the place of a race and are not completed.
      if (!table.mayAdmit(race, most_health)) continue;
      complete(race);
      const InitialEvidence initial =
          history_.initialEvidence(race.T_world_robot, race.log_likelihood, table.races());
      race.evidence = initial.evidence;
      race.scores = initial.scores;
      race.scores_since_jump = initial.scores_since_jump;
    }
    return candidates_;
  }

  Race createAt(const Pose2& T_world_robot, RandomEngine&) const override {
    // The camera's tilt must not make a given pose look wrong.
    const Placement refined = likelihood_
                                  .refine(observation_, {T_world_robot}, posePrior(kGivenStd, kGivenStd), 1.0,
                                          kRefinementSteps, kRefinementBlur_m, tilt_)
                                  .placement;
    Race race = ratedAt({T_world_robot, refined.tilt_bias});
    complete(race);
    return race;
  }

  double sparedEvidence(const RaceTable& table) const override {
    return bestPosterior(table) - params_.evidence.lead;
  }

  void refine(Race& race, RandomEngine&) const override {
    const RaceFilterParams& filter = params_.filter;
    Vector5d walk;
    walk << filter.walk_m, filter.walk_m, filter.walk_rad, kTiltWalk_rad, kTiltWalk_rad;
    race.P.diagonal() += walk.cwiseProduct(walk);
    const Matrix5d prior = race.P.inverse() + broad_prior_;
    const Placement start = race.placement();
    // The memory repeats itself from image to image: only a share of it is new to the filter.
    const auto refined = maximizeLikelihood(start, prior, filter.information_share);
    race.T_world_robot = refined.placement.T_world_robot;
    race.camera_tilt = refined.placement.tilt_bias;
    Matrix5d information = prior + refined.information;
    information.diagonal().tail<2>().array() += tilt_.information(race.camera_tilt);
    updateOdometry(race, start, refined.placement, information.inverse());
    updateReported(race, refined, walk);
    race.health = refined.rating.explained;
    race.log_likelihood = refined.rating.log_likelihood;
    race.evidence += history_.newestWeight() * (race.log_likelihood - race.evidence);
    history_.record(race);
  }

  void select(RaceTable& table, double) override {
    const Race* best = nullptr;
    for (const Race& race : table.races()) {
      if (!best || posterior(race) > posterior(*best)) best = &race;
    }
    if (!best) return;
    const Race* winner = table.winner();
    // A new race needs the full lead, because it was selected for fitting the present image.
    const double youth = std::exp(-best->age / kSettledAge);
    const double lead = params_.evidence.lead * (kOldLead + (1.0 - kOldLead) * youth);
    if (!winner || posterior(*best) > posterior(*winner) + lead) table.setWinner(best->id);
    table.recordBest(best->id);
    table.award(table.winner()->id);
    odometry_ = table.winner()->odometry;
  }

  double beliefShare(const Race& race, const RaceTable& table) const override {
    const double best = bestPosterior(table);
    const auto belief = [&](const Race& one) { return std::exp(worth() * (posterior(one) - best)); };
    double sum = 0.0;
    for (const Race& one : table.races()) sum += belief(one);
    return belief(race) / sum;
  }

  std::optional<double> agreement(const RaceTable& table) const override {
    const Race* winner = table.winner();
    if (!winner || observation_.amount < kEnoughPoints) return std::nullopt;
    return fitOf(*winner);
  }

  bool isUnambiguous(const RaceTable& table) const override {
    return table.winner() && winnersShare(table) > kUnambiguous;
  }

  double updatedSupport(double last, const RaceTable& table, double elapsed_s) const override {
    double target = 0.0;
    if (const Race* winner = table.winner()) {
      target = fitOf(*winner) * std::min(1.0, observation_.amount / kEnoughPoints) * winnersShare(table);
    }
    const double gain = 1.0 - std::exp(-elapsed_s / kSupportTime_s);
    return last + gain * (target - last);
  }

  double reliability(const RaceTable& table, double) const override {
    const Race* winner = table.winner();
    if (!winner) return 0.0;
    const double share = winnersShare(table);
    // One more hypothesis in the softmax: the robot is at none of the races' places.
    const double none = kNoneUnexplained * history_.meanWeight() * std::log(params_.likelihood.outlier_share);
    const double log_odds = kNoneScale * (none - winner->evidence) - tilt_.logDensity(winner->camera_tilt);
    return share / (1.0 + share * std::exp(log_odds));
  }

  void fitCamera(RaceTable& table, bool is_trusted) override {
    if (!analysis_ || isLegged()) return;
    const Eigen::Vector2d learnt = camera_.fit(*analysis_, table.winner()->placement(), is_trusted);
    for (Race& race : table.races()) race.camera_tilt -= learnt;
  }

  Eigen::Matrix3d covariance(const Race& race) const override {
    return RaceStrategy::covariance(race) + camera_.poseCovariance();
  }

  std::optional<CameraErrors> cameraErrors() const override {
    const CameraErrors& errors = camera_.errors();
    return errors.sigmas.isZero() ? std::nullopt : std::optional(errors);
  }

  void resetNovelty() override {
    novelty_.reset();
    novelty_.assess(observation_, T_odom_robot_, stamp_us_);
    history_.countAsNew();
  }

  void resetHistory(const RaceTable& table) override {
    history_.clear(!table.races().empty());
    novelty_.reset();
  }

  void discountEvidence(RaceTable& table) override {
    resetHistory(table);
    const double best = bestPosterior(table);
    for (Race& race : table.races()) {
      race.scores.resize(0);
      race.scores_since_jump = 0;
      race.evidence += std::max(0.0, best - 1.0 - posterior(race));
      race.victories = std::min(race.victories, 1);
    }
  }

 private:
  /// @param table with a winner.
  double winnersShare(const RaceTable& table) const { return beliefShare(*table.winner(), table); }

  bool isLegged() const {
    return std::max(params_.likelihood.frame_tilt_rad, params_.observation.camera_sigma_rad) > kLegged_rad;
  }

  static double fitOf(const Race& race) {
    return std::clamp((race.health - kExplainedLow) / (kExplainedHigh - kExplainedLow), 0.0, 1.0);
  }

  /// A race with health and likelihood only.
  Race ratedAt(const Placement& placement) const {
    Race race;
    race.T_world_robot = placement.T_world_robot;
    race.camera_tilt = placement.tilt_bias;
    weight(race);
    return race;
  }

  void complete(Race& race) const {
    race.evidence = race.log_likelihood;
    race.odometry = odometry_;
    const auto refined = likelihood_.refine(observation_, race.placement(), broad_prior_, 1.0, 0, 0.0);
    const Matrix5d prior = priorAt(race.camera_tilt);
    race.P = (refined.information + prior).inverse();
    race.variance_factor = refined.rating.variance_factor;
    race.P_reported = (refined.information / varianceFactor(race) + prior).inverse();
  }

  RobustLikelihood::Refined maximizeLikelihood(const Placement& start, const Matrix5d& prior,
                                               double share) const {
    auto refined = likelihood_.refine(observation_, start, prior, share, kRefinementSteps, 0.0, tilt_);
    if (refined.rating.explained >= kExplainedLow) return refined;
    // Odometry after a period without observations, or a late image while the head turns, may err by more
    // than the innovation variance.
    const auto wide =
        likelihood_.refine(observation_, start, prior, share, kRefinementSteps, kExplorerBlur_m, tilt_);
    const auto again =
        likelihood_.refine(observation_, wide.placement, prior, share, kRefinementSteps, 0.0, tilt_);
    if (again.rating.log_likelihood > refined.rating.log_likelihood) return again;
    return refined;
  }

  /// Replaces P by the one after the measurement update. The lasting errors of odometry are not measured
  /// themselves: they follow by their covariance with what was, the last rows of the augmented filter.
  void updateOdometry(Race& race, const Placement& before, const Placement& after,
                      const Matrix5d& P_after) const {
    Vector5d moved;
    moved << after.T_world_robot.position() - before.T_world_robot.position(),
        angleDifference(after.T_world_robot.theta, before.T_world_robot.theta),
        after.tilt_bias - before.tilt_bias;
    const Eigen::Matrix<double, 3, 5> gain = race.P.ldlt().solve(race.P_odometry).transpose();
    race.odometry.errors += gain * moved;
    race.odometry.P -= gain * (race.P - P_after) * gain.transpose();
    race.P_odometry = P_after * gain.transpose();
    race.P = P_after;
  }

  /// Information matrix of the prior that all races share.
  Matrix5d priorAt(const Eigen::Vector2d& camera_tilt) const {
    Matrix5d information = broad_prior_;
    information.diagonal().tail<2>().array() += tilt_.information(camera_tilt);
    return information;
  }

  static double varianceFactor(const Race& race) {
    return std::max(kLeastVarianceFactor, race.variance_factor);
  }

  /// Kalman update of the reported covariance, beside the one that moves the race.
  void updateReported(Race& race, const RobustLikelihood::Refined& refined, const Vector5d& walk) const {
    race.variance_factor += kVarianceGain * (refined.rating.variance_factor - race.variance_factor);
    Vector5d growth = walk.cwiseProduct(walk);
    growth[2] *= kReportedTurnWalk;
    race.P_reported.diagonal() += growth;
    // Where the image has no points, the repeated memory must not hide the drift of odometry.
    const Matrix5d& observed = is_memory_current_ ? refined.information : refined.image_information;
    const Matrix5d information = priorAt(race.camera_tilt) + observed / varianceFactor(race);
    const Matrix5d P =
        (Matrix5d::Identity() + race.P_reported * information).partialPivLu().solve(race.P_reported);
    race.P_reported = 0.5 * (P + P.transpose());
  }

  /// Sets places_ to `most` rated explorers, fewer in a large map.
  void explore(int most, RandomEngine& engine) {
    const RobustExplorerParams& search = params_.explorers;
    // In a large map a uniform explorer rarely comes near the robot.
    double constructed = search.constructed_share;
    if (uniform_share_ < 1.0 && constructed > 0.0 && !observation_.segments.empty()) {
      const double kept = constructed + (1.0 - constructed) * uniform_share_;
      most = static_cast<int>(std::ceil(kept * most));
      constructed /= kept;
    }
    places_.clear();
    while (static_cast<int>(places_.size()) < most) places_.push_back({propose(constructed, engine), 0.0});
    likelihood_.explain(few_, places_, kExplorerBlur_m, explorers_.list_health);
  }

  Pose2 propose(double constructed_share, RandomEngine& engine) const {
    std::optional<Pose2> pose;
    if (uniform(engine, 0.0, 1.0) < constructed_share) pose = constructed_.propose(observation_, engine);
    return pose ? *pose : uniformExplorer(map_, explorers_.margin_m, engine);
  }

  /// Number of independent observations that evidence is the mean of.
  double worth() const {
    return std::max(1.0, params_.evidence.independent_share / (1.0 - params_.history.forgetting));
  }

  /// Evidence with the prior of the camera's tilt.
  double posterior(const Race& race) const {
    return race.evidence + tilt_.logDensity(race.camera_tilt) / worth();
  }

  double bestPosterior(const RaceTable& table) const {
    double best = -1e300;
    for (const Race& race : table.races()) best = std::max(best, posterior(race));
    return best;
  }

  /// Calibration says how wrong the tilt of the corrected camera may be. On legs it does not learn.
  void updateTiltPrior() {
    const bool is_free = params_.likelihood.tilt_bias_rad > 0.0 && !isLegged();
    const double calibrated = std::max(params_.likelihood.tilt_bias_rad, kLeastTilt_rad);
    tilt_ = {calibrated, is_free ? std::hypot(calibrated, camera_.tiltSigma()) : calibrated};
  }

  RobustParams params_;
  ExplorerParams explorers_;
  MapIndex map_;
  ConstructedExplorers constructed_;
  RobustLikelihood likelihood_;
  ScoreHistory history_;
  ObservationNovelty novelty_;
  double camera_heading_ = 0.0;  ///< of its x axis, in the robot's frame [rad]
  TiltMixture tilt_;             ///< prior of the races' tilt
  const Matrix5d broad_prior_ = posePrior(kLargestStd_m, kLargestStd_rad);
  double uniform_share_;   ///< share of the uniform explorers that are sent out
  OdometryBias odometry_;  ///< of the winner, the prior of new races: the same wheels
  /// The last update's image has no points, and its memory was updated just now.
  bool is_memory_current_ = false;
  CameraCalibration camera_{likelihood_, map_, params_.observation, params_.filter.odometry};
  std::shared_ptr<const ImageAnalysis> analysis_;  ///< of the last update; null: without an image
  Pose2 T_odom_robot_;
  StampUs stamp_us_ = 0;
  FloorObservation observation_;
  FloorObservation few_;  ///< a part of observation_, for the coarse search
  std::vector<Individual> places_;
  std::vector<Race> candidates_;
};

}  // namespace

void RaceFilterParams::visit(ParameterVisitor& v) {
  odometry.visit(v);
  v.real(expert("Walk_m", "random walk of the position per root of an iteration (sigma)"), walk_m, 0.0, 1.0);
  v.angle(expert("Walk_deg", "the same of the heading"), walk_rad, 0.0, 90.0);
  v.real(expert("InformationShare", "share of an observation that is new since the last iteration"),
         information_share, 1e-4, 1.0);
}

void RobustParams::visit(ParameterVisitor& v) {
  observation.visit(v);
  likelihood.visit(v);
  filter.visit(v);
  v.real(expert("Lead", "lead in evidence of a new race to win [nats]; an old one needs a third"),
         evidence.lead, 0.0, 1e6);
  history.visit(v);
}

std::unique_ptr<RaceStrategy> makeRobustRaces(const SegmentMap& map_edges, const MapParams& map,
                                              const ExplorerParams& explorers, const RobustParams& params) {
  return std::make_unique<RobustRaces>(map_edges, map, explorers, params);
}

}  // namespace vismem
