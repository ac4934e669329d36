// Our localization: bounded likelihood, Gauss-Newton and Kalman filter per race, evidence. DESIGN 9, L12, B2.
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "common/geometry/angles.h"
#include "localization/core/explorers.h"
#include "localization/core/landmarks.h"
#include "localization/core/negative_information.h"
#include "localization/core/observation_news.h"
#include "localization/core/past_observations.h"
#include "localization/core/race_strategy.h"
#include "localization/core/robust_likelihood.h"

namespace vismem {
namespace {

constexpr double kExplorerBlur_m = 0.15;  // an explorer must only come within about 0.3 m
constexpr double kRefinementBlur_m = 0.08;
constexpr std::size_t kExplorerPoints = 64;
/// Nobody knows a pose worse than this: keeps the covariance of an undetermined direction finite.
constexpr double kLargestStd_m = 5.0;
constexpr double kLargestStd_rad = 1.0;
/// A race of so many iterations is hardly a newcomer any more, and needs this share of the lead.
constexpr double kSettledAge = 20.0;
constexpr double kOldLead = 0.33;
constexpr double kUndisputed = 0.8;      // share of belief
constexpr double kLeastLean_rad = 1e-6;  // a lean that is taken as known
/// Of the heading's walk, as variance: more of it keeps a race open to slips than its error grows by.
constexpr double kStatedTurnWalk = 0.1;
constexpr StampUs kJustSeen_us = kSecondUs / 2;
/// Of a camera's lasting lean, per square root of an iteration: a quarter of a degree in ten minutes.
constexpr double kLeanWalk_rad = 1e-4;

/// What is known of any race beforehand.
Matrix5d broadPrior(const RobustParams& params) {
  const double bias = std::max(params.lean_bias_rad, kLeastLean_rad);
  Vector5d std;
  std << kLargestStd_m, kLargestStd_m, kLargestStd_rad, bias, bias;
  return std.cwiseProduct(std).cwiseInverse().asDiagonal();
}

class RobustStrategy : public RaceStrategy {
 public:
  RobustStrategy(const SegmentMap& map_edges, const LocalizerParams& params)
      : params_(params),
        map_(map_edges, robustIndex(params)),
        constructed_(map_),
        landmarks_(map_, {params.robust.corners, params.robust.doors, params.robust.parallelograms}),
        likelihood_(map_, params_.robust),
        past_(likelihood_, params_.robust),
        news_(params_.robust),
        negative_(map_, params_.robust, params_.opaque_labels),
        broad_prior_(broadPrior(params_.robust)),
        uniform_share_(uniformShare(map_, params_.explorers.margin_m, params_.robust.uniform_area_m2)) {}

  bool observe(const MemoryUpdate& update) override {
    observation_ = vismem::observe(update, map_, params_.robust);
    const auto isNew = [&](const MemorySegment& segment) {
      return segment.last_seen_us + kJustSeen_us >= update.snapshot->stamp_us;
    };
    const auto& remembered = update.snapshot->segments;
    is_memory_news_ = observation_.remembered == observation_.points.size() &&
                      std::any_of(remembered.begin(), remembered.end(), isNew);
    if (params_.robust.negative_information && params_.robust.source != HealthSource::kMemory &&
        update.analysis) {
      negative_.observe(*update.analysis, observation_);
    }
    RobustObservation all = thinned(observation_, static_cast<std::size_t>(params_.robust.maximum_points));
    observation_.points = std::move(all.points);
    observation_.remembered = all.remembered;
    few_ = thinned(observation_, kExplorerPoints);
    if (observation_.points.empty()) return false;
    T_odom_robot_ = update.snapshot->T_odom_robot;
    stamp_us_ = update.snapshot->stamp_us;
    news_.weigh(observation_, T_odom_robot_, stamp_us_);
    past_.begin(observation_, T_odom_robot_);
    return true;
  }

  void takeAsNew() override {
    news_.clear();
    news_.weigh(observation_, T_odom_robot_, stamp_us_);
    past_.weighAgain(observation_);
  }

  void move(Race& race, const Pose2& T_before_now) const override {
    const RobustParams& robust = params_.robust;
    const double theta = race.T_world_robot.theta;
    const Eigen::Vector2d shift = transform(Pose2{0.0, 0.0, theta}, T_before_now.position());
    Matrix5d F = Matrix5d::Identity();
    F(0, 2) = -shift.y();
    F(1, 2) = shift.x();
    const double travelled = shift.norm();
    const double std_m = robust.odometry_share * travelled;
    const double std_rad =
        robust.odometry_turn_share * std::abs(T_before_now.theta) + robust.odometry_turn_per_m * travelled;
    for (Matrix5d* P : {&race.P, &race.P_stated}) {
      *P = F * *P * F.transpose();
      P->diagonal().head<3>() += Eigen::Vector3d(std_m * std_m, std_m * std_m, std_rad * std_rad);
    }
    race.T_world_robot = race.T_world_robot * T_before_now;
  }

  void rate(Race& race) const override { rate(race, {race.T_world_robot, race.camera_lean}); }

  /// Those that the table would not admit have a place and a health only.
  std::vector<Race> search(int explorers, const RaceTable& table, RandomEngine& engine) const override {
    std::vector<Individual> population = explore(explorers, engine);
    std::vector<Individual> best = bestPlaces(population, params_.robust.refined_explorers,
                                              params_.explorers.list_health, table.params());
    for (Individual& one : best) {
      const auto refined = likelihood_.refine(few_, {one.T_world_robot}, broad_prior_, 1.0,
                                              params_.robust.refinement_steps, kRefinementBlur_m);
      one = {refined.placement.T_world_robot, refined.rating.explained};
    }
    std::vector<Race> races;
    for (const Individual& place :
         bestPlaces(best, params_.explorers.candidates, params_.explorers.list_health, table.params())) {
      const Placement refined = likelihood_
                                    .refine(observation_, {place.T_world_robot}, broad_prior_, 1.0,
                                            params_.robust.refinement_steps, kRefinementBlur_m)
                                    .placement;
      races.push_back(ratedAt(refined.T_world_robot));
    }
    double most_health = 0.0;
    for (const Race& race : races) most_health = std::max(most_health, race.health);
    for (Race& race : races) {
      // Most are at places that are known: nobody will ask for the rest.
      if (!table.mayAdmit(race, most_health)) continue;
      complete(race);
      past_.earn(race, table.races());
    }
    return races;
  }

  Race foundAt(const Pose2& T_world_robot, RandomEngine&) const override {
    Race race = ratedAt(T_world_robot);
    complete(race);
    return race;
  }

  bool isHopeless(const Race& race, const RaceTable& table) const override {
    return race.evidence < bestEvidence(table) - params_.robust.delete_behind;
  }

  void evolve(Race& race, RandomEngine&) const override {
    const RobustParams& robust = params_.robust;
    Vector5d walk;
    walk << robust.walk_m, robust.walk_m, robust.walk_rad, kLeanWalk_rad, kLeanWalk_rad;
    race.P.diagonal() += walk.cwiseProduct(walk);
    const Matrix5d prior = robust.kalman ? Matrix5d(race.P.inverse() + broad_prior_) : broad_prior_;
    // The memory repeats itself from image to image: only a share of it is new to the filter.
    const double share = robust.kalman ? robust.information_share : 1.0;
    Placement placement{race.T_world_robot, race.camera_lean};
    if (robust.refinement_steps > 0) {
      auto refined = likelihood_.refine(observation_, placement, prior, share, robust.refinement_steps, 0.0);
      if (refined.rating.explained < robust.explained_low) {
        // Perhaps odometry erred by more than the points reach, with nothing to see for a while.
        const auto wide = likelihood_.refine(observation_, placement, prior, share, robust.refinement_steps,
                                             kExplorerBlur_m);
        const auto again =
            likelihood_.refine(observation_, wide.placement, prior, share, robust.refinement_steps, 0.0);
        if (again.rating.news > refined.rating.news) refined = again;
      }
      placement = refined.placement;
      race.T_world_robot = placement.T_world_robot;
      race.camera_lean = placement.lean_bias;
      race.P = (prior + refined.information).inverse();
      state(race, refined, walk);
      race.health = refined.rating.explained;
      race.log_likelihood = refined.rating.news;
    } else {
      rate(race, placement);
    }
    missWhatShouldBeSeen(race);
    race.evidence += past_.newest() * (race.log_likelihood - race.evidence);
    past_.note(race);
  }

  void choose(RaceTable& table, double) const override {
    const Race* best = nullptr;
    for (const Race& race : table.races()) {
      if (!best || race.evidence > best->evidence) best = &race;
    }
    if (!best) return;
    const Race* winner = table.winner();
    // Between races that have lived alike for long, less decides: a newcomer was chosen because it fits.
    const double youth = std::exp(-best->age / kSettledAge);
    const double lead = params_.robust.lead * (kOldLead + (1.0 - kOldLead) * youth);
    if (!winner || best->evidence > winner->evidence + lead) table.setWinner(best->id);
    table.noteBest(best->id);
    table.award(table.winner()->id);
  }

  std::vector<double> weights(const RaceTable& table) const override {
    const double best = bestEvidence(table);
    const double worth = std::max(1.0, params_.robust.news_share / (1.0 - params_.robust.forgetting));
    std::vector<double> shares;
    double sum = 0.0;
    for (const Race& race : table.races()) {
      shares.push_back(std::exp(worth * (race.evidence - best)));
      sum += shares.back();
    }
    for (double& share : shares) share /= sum;
    return shares;
  }

  std::optional<double> agreement(const RaceTable& table) const override {
    const Race* winner = table.winner();
    if (!winner || !params_.robust.validity || observation_.amount < params_.robust.enough_points) {
      return std::nullopt;
    }
    return fitOf(*winner);
  }

  bool isUndisputed(const RaceTable& table) const override {
    const Race* winner = table.winner();
    if (!winner) return false;
    return weights(table)[static_cast<std::size_t>(winner - table.races().data())] > kUndisputed;
  }

  double nextReliability(double last, const RaceTable& table, double elapsed_s) const override {
    const RobustParams& robust = params_.robust;
    double target = 0.0;
    if (const Race* winner = table.winner()) {
      const double amount = std::min(1.0, observation_.amount / robust.enough_points);
      const std::vector<double> shares = weights(table);
      const auto index = static_cast<std::size_t>(winner - table.races().data());
      if (!robust.validity) return shares[index];
      target = fitOf(*winner) * amount * shares[index];
    }
    if (!robust.validity) return 0.0;
    const double gain = 1.0 - std::exp(-elapsed_s / robust.reliability_time_s);
    return last + gain * (target - last);
  }

  void forgetPast(const RaceTable& table) override {
    past_.clear(!table.races().empty());
    news_.clear();
  }

  void forgetEvidence(RaceTable& table) override {
    forgetPast(table);
    for (Race& race : table.races()) race.past.clear();
    const double best = table.races().empty() ? 0.0 : bestEvidence(table);
    for (Race& race : table.races()) {
      race.evidence = best - std::min(1.0, best - race.evidence);
      race.victories = std::min(race.victories, 1);
    }
  }

 private:
  double fitOf(const Race& race) const {
    const RobustParams& robust = params_.robust;
    return std::clamp((race.health - robust.explained_low) / (robust.explained_high - robust.explained_low),
                      0.0, 1.0);
  }

  /// With health and likelihood.
  Race ratedAt(const Pose2& T_world_robot) const {
    Race race;
    race.T_world_robot = T_world_robot;
    rate(race);
    return race;
  }

  void complete(Race& race) const {
    missWhatShouldBeSeen(race);
    race.evidence = race.log_likelihood;
    const auto refined = likelihood_.refine(observation_, {race.T_world_robot}, broad_prior_, 1.0, 0, 0.0);
    race.P = (refined.information + broad_prior_).inverse();
    race.P_stated = race.P;
  }

  /// A filter of its own, beside the one that moves the race.
  void state(Race& race, const RobustLikelihood::Refined& refined, const Vector5d& walk) const {
    if (!params_.robust.kalman) {
      race.P_stated = race.P;
      return;
    }
    Vector5d growth = walk.cwiseProduct(walk);
    growth[2] *= kStatedTurnWalk;
    race.P_stated.diagonal() += growth;
    // Where the camera shows nothing, what the memory repeats must not hide how far odometry may have gone.
    const Matrix5d told = broad_prior_ + (is_memory_news_ ? refined.information : refined.image_information);
    const Matrix5d P = (Matrix5d::Identity() + race.P_stated * told).partialPivLu().solve(race.P_stated);
    race.P_stated = 0.5 * (P + P.transpose());
  }

  void missWhatShouldBeSeen(Race& race) const {
    if (params_.robust.negative_information) race.log_likelihood += negative_.logPenalty(race.T_world_robot);
  }

  /// Rates places until the KLD bound for those that are plausible is met, at most `most`.
  std::vector<Individual> explore(int most, RandomEngine& engine) const {
    const RobustParams& robust = params_.robust;
    // What lies in a large map is hit by construction, hardly ever by chance.
    double constructed = robust.constructed_share;
    if (uniform_share_ < 1.0 && constructed > 0.0 && !observation_.segments.empty()) {
      const double kept = constructed + (1.0 - constructed) * uniform_share_;
      most = static_cast<int>(std::ceil(kept * most));
      constructed /= kept;
    }
    const auto proposals = constructed > 0.0 && robust.landmark_share > 0.0
                               ? landmarks_.match(observation_, most, engine)
                               : LandmarkExplorers::Proposals{};
    std::vector<Individual> population;
    population.reserve(static_cast<std::size_t>(most));
    std::set<std::array<int, 3>> places;
    int wanted = robust.kld_error > 0.0 ? std::min(most, robust.kld_least) : most;
    while (static_cast<int>(population.size()) < wanted) {
      const std::size_t rated = population.size();
      while (static_cast<int>(population.size()) < wanted) {
        population.push_back({propose(proposals, constructed, engine), 0.0});
      }
      const auto newest = std::span(population).subspan(rated);
      likelihood_.explain(few_, newest, kExplorerBlur_m, params_.explorers.list_health);
      if (robust.kld_error <= 0.0) continue;
      for (const Individual& one : newest) {
        if (one.health < params_.explorers.list_health) continue;
        const Pose2& pose = one.T_world_robot;
        places.insert({static_cast<int>(std::floor(pose.x / robust.kld_place_m)),
                       static_cast<int>(std::floor(pose.y / robust.kld_place_m)),
                       static_cast<int>(std::floor(pose.theta / robust.kld_place_rad))});
      }
      wanted = std::min(most, kldBound(static_cast<int>(places.size()), robust.kld_error));
    }
    return population;
  }

  Pose2 propose(const LandmarkExplorers::Proposals& proposals, double constructed_share,
                RandomEngine& engine) const {
    std::optional<Pose2> pose;
    if (uniform(engine, 0.0, 1.0) < constructed_share) {
      const bool by_landmark = uniform(engine, 0.0, 1.0) < params_.robust.landmark_share;
      pose = by_landmark && !proposals.isEmpty() ? proposals.pick(engine)
                                                 : constructed_.propose(observation_, engine);
    }
    return pose ? *pose : uniformExplorer(map_, params_.explorers.margin_m, engine);
  }

  void rate(Race& race, const Placement& placement) const {
    const Rating rating = likelihood_.rate(observation_, placement);
    race.health = rating.explained;
    race.log_likelihood = rating.news;
  }

  double bestEvidence(const RaceTable& table) const {
    double best = -1e300;
    for (const Race& race : table.races()) best = std::max(best, race.evidence);
    return best;
  }

  LocalizerParams params_;
  MapIndex map_;
  ConstructedExplorers constructed_;
  LandmarkExplorers landmarks_;
  RobustLikelihood likelihood_;
  PastObservations past_;
  ObservationNews news_;
  NegativeInformation negative_;
  Matrix5d broad_prior_;
  double uniform_share_;  ///< of the uniform explorers that are sent out
  /// Of the last update: no image tells, and the memory has what was seen just now.
  bool is_memory_news_ = false;
  RobustObservation observation_;
  Pose2 T_odom_robot_;  ///< of it
  StampUs stamp_us_ = 0;
  RobustObservation few_;  ///< a part of it, for the coarse search
};

}  // namespace

std::unique_ptr<RaceStrategy> makeRobustStrategy(const SegmentMap& map_edges, const LocalizerParams& params) {
  return std::make_unique<RobustStrategy>(map_edges, params);
}

}  // namespace vismem
