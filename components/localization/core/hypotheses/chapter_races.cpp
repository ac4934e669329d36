#include "localization/core/hypotheses/chapter_races.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "common/geometry/angles.h"

namespace vismem {
namespace {

/// The reliability rule of the authors' program: health over 0.8 raises it, under 0.7 lowers it, by at most
/// 0.15 per iteration, or by 0.03 with few points.
constexpr double kRaisingHealth = 0.8;
constexpr double kLoweringHealth = 0.7;
constexpr double kRate = 0.15;
constexpr double kWeakRate = 0.03;
constexpr double kFullObservation = 12.0;  // segments or points of a complete observation
constexpr double kGoodObservation = 0.6;
constexpr double kUsableObservation = 0.3;
/// The lead in health that a rival needs to gain the winner's victory (L8: "its lead is large enough"). The
/// authors' program takes 0.01 + 0.09 * reliability, and 0.1 above a reliability of 0.8.
constexpr double kLeastLead = 0.01;
constexpr double kLeadPerReliability = 0.09;
constexpr double kVeryReliable = 0.8;
constexpr double kLargestLead = 0.1;

class ChapterRaces : public RaceStrategy {
 public:
  ChapterRaces(const SegmentMap& map_edges, const ChapterParams& params)
      : params_(params), map_(map_edges, chapterIndex(params.map)), observation_(map_, params.health) {}

  bool observe(const MemoryUpdate& update) override {
    observation_.set(update);
    return !observation_.isEmpty();
  }

  void predict(Race& race, const Pose2& T_before_now) const override {
    race.T_world_robot = race.T_world_robot * T_before_now;
    for (Individual& one : race.individuals) one.T_world_robot = one.T_world_robot * T_before_now;
  }

  void weight(Race& race) const override {
    for (Individual& one : race.individuals) one.is_rated = false;
    rateNew(race);
  }

  std::span<Race> propose(int explorers, const RaceTable& table, RandomEngine& engine) override {
    population_.clear();
    for (int i = 0; i < explorers; ++i) {
      const Pose2 pose = uniformExplorer(map_, params_.explorers.margin_m, engine);
      population_.push_back({pose, observation_.health(pose)});
    }
    keepBestPlaces(population_, params_.explorers.candidates, params_.explorers.list_health, table.params());
    candidates_.clear();
    for (const Individual& place : population_) {
      candidates_.push_back(createRace(place, params_.evolution, engine));
    }
    return candidates_;
  }

  Race createAt(const Pose2& T_world_robot, RandomEngine& engine) const override {
    Race race = createRace({T_world_robot, 0.0}, params_.evolution, engine);
    if (!observation_.isEmpty()) weight(race);
    race.T_world_robot = T_world_robot;
    return race;
  }

  double sparedEvidence(const RaceTable&) const override { return std::numeric_limits<double>::infinity(); }

  void refine(Race& race, RandomEngine& engine) const override {
    evolveRace(race, params_.evolution, engine);
    rateNew(race);
  }

  void select(RaceTable& table, double support) override {
    selectByVictories(table,
                      support > kVeryReliable ? kLargestLead : kLeastLead + kLeadPerReliability * support);
  }

  double beliefShare(const Race& race, const RaceTable& table) const override {
    // Victories are the chapter's belief; shares follow health while no race has a victory.
    double victories = 0.0;
    double healths = 0.0;
    for (const Race& one : table.races()) {
      victories += one.victories;
      healths += one.health;
    }
    if (victories > 0.0) return race.victories / victories;
    return healths > 0.0 ? race.health / healths : 1.0 / static_cast<double>(table.races().size());
  }

  /// The chapter's search depends on its reliability alone.
  std::optional<double> agreement(const RaceTable&) const override { return std::nullopt; }
  bool isUnambiguous(const RaceTable&) const override { return false; }

  double updatedSupport(double last, const RaceTable& table, double) const override {
    const Race* winner = table.winner();
    if (!winner) return 0.0;
    const double quality = std::min(1.0, static_cast<double>(observation_.size()) / kFullObservation);
    const double weak_rate = quality > kUsableObservation ? kWeakRate : 0.0;
    double change = 0.0;
    if (winner->health > kRaisingHealth) {
      change = (quality > kGoodObservation ? kRate : weak_rate) * (winner->health - kRaisingHealth) /
               (1.0 - kRaisingHealth);
    } else if (winner->health < kLoweringHealth) {
      change = -(quality > kUsableObservation ? kRate : kWeakRate) * (kLoweringHealth - winner->health) /
               kLoweringHealth;
    }
    return std::clamp(last + change, 0.0, 1.0);
  }

  /// The chapter publishes what controls its search.
  double reliability(const RaceTable&, double support) const override { return support; }

  /// The chapter's races depend on the last observation alone.
  void resetHistory(const RaceTable&) override {}

  void discountEvidence(RaceTable& table) override {
    for (Race& race : table.races()) race.victories = std::min(race.victories, 1);
  }

 private:
  void rateNew(Race& race) const {
    rateRace(race, params_.evolution, [this](const Pose2& pose) { return observation_.health(pose); });
    race.P_reported.topLeftCorner<3, 3>() = eliteCovariance(race);
  }

  Eigen::Matrix3d eliteCovariance(const Race& race) const {
    Eigen::Matrix3d P = Eigen::Matrix3d::Zero();
    const int elite = std::min(eliteCount(params_.evolution), static_cast<int>(race.individuals.size()));
    for (int i = 0; i < elite; ++i) {
      const Pose2& one = race.individuals[static_cast<std::size_t>(i)].T_world_robot;
      const Eigen::Vector3d off(one.x - race.T_world_robot.x, one.y - race.T_world_robot.y,
                                angleDifference(one.theta, race.T_world_robot.theta));
      P += off * off.transpose() / elite;
    }
    return P;
  }

  ChapterParams params_;
  MapIndex map_;
  HealthObservation observation_;
  std::vector<Individual> population_;
  std::vector<Race> candidates_;
};

}  // namespace

std::unique_ptr<RaceStrategy> makeChapterRaces(const SegmentMap& map_edges, const ChapterParams& params) {
  return std::make_unique<ChapterRaces>(map_edges, params);
}

}  // namespace vismem
