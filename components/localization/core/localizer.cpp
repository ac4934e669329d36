#include "localization/core/localizer.h"

#include <algorithm>
#include <cmath>

#include "common/geometry/angles.h"
#include "localization/core/explorers.h"

namespace vismem {
namespace {

/// What is left of reliability when the memory was set aside or the source jumped.
constexpr double kReliabilityAfterEpoch = 0.1;
/// A source's stamps that go back further than this began anew (DESIGN 14); less is a late update.
constexpr StampUs kRestart_us = kSecondUs;
/// Odometry that moves faster than this did not move the robot (DESIGN 14).
constexpr double kJump_m = 0.5;
constexpr double kJump_rad = 1.0;
constexpr StampUs kJumpWithin_us = kSecondUs / 2;
/// A winner that jumps this far is a different belief altogether.
constexpr double kFullJump_m = 2.0;
/// How well a person or a program that sets the pose knows it.
constexpr double kGivenStd_m = 0.1;
constexpr double kGivenStd_rad = 0.1;

/// An observation that lets the winner be believed less than this share of its reliability is a surprise.
constexpr double kSurprise = 0.7;
/// A surprise after so many iterations without one may be that the robot was put elsewhere.
constexpr int kCalm = 15;
/// Doubt ends when no image has contradicted the winner, and no other race it, for so many iterations: a wrong
/// winner keeps nearly all belief for a second.
constexpr int kDoubtEnds = 5;
/// Where nothing spoke against the winner for so many iterations the search rests, although much that is seen
/// is not in the map and reliability stays low.
constexpr int kRestAfter = 15;

std::unique_ptr<RaceStrategy> makeStrategy(const LocalizerParams& params, const SegmentMap& map_edges) {
  return params.mode == LocalizationMode::kChapter ? makeChapterStrategy(map_edges, params)
                                                   : makeRobustStrategy(map_edges, params);
}

}  // namespace

Localizer::Localizer(const LocalizerParams& params, const SegmentMap& map_edges, std::uint64_t seed)
    : params_(params), strategy_(makeStrategy(params, map_edges)), table_(params.races), engine_(seed) {
  if (params.mode == LocalizationMode::kDefault && params.odometry.enabled)
    odometry_.emplace(params.odometry);
}

Localizer::~Localizer() = default;
Localizer::Localizer(Localizer&&) noexcept = default;
Localizer& Localizer::operator=(Localizer&&) noexcept = default;

PoseEstimate Localizer::step(const MemoryUpdate& update) {
  const MemorySnapshot& snapshot = *update.snapshot;
  if (has_last_) {
    const bool restarted = snapshot.stamp_us + kRestart_us < last_stamp_us_;
    if (!restarted && snapshot.stamp_us <= last_stamp_us_) return estimate_;
    const Pose2 T_before_now = inverse(last_T_odom_robot_) * snapshot.T_odom_robot;
    const bool close_in_time = snapshot.stamp_us - last_stamp_us_ < kJumpWithin_us;
    const bool jumped = close_in_time && (T_before_now.position().norm() > kJump_m ||
                                          std::abs(T_before_now.theta) > kJump_rad);
    // A memory that was restarted counts its revisions from the beginning; the base may have gone on all the
    // while.
    const bool memory_restarted = snapshot.revision < last_revision_;
    // A new epoch after a pause: the base or its stream was away, and its odometry may have begun anew
    // elsewhere.
    const bool odometry_unsure = snapshot.epoch != epoch_ && !close_in_time && !memory_restarted;
    if (restarted || jumped || odometry_unsure) {
      beginEpoch();
    } else {
      // A memory that was set aside keeps its odometry: the races move on with the robot.
      move(T_before_now);
      if (snapshot.epoch != epoch_ || memory_restarted) beginEpoch();
    }
  }
  has_last_ = true;
  last_revision_ = snapshot.revision;
  epoch_ = snapshot.epoch;
  last_stamp_us_ = snapshot.stamp_us;
  last_T_odom_robot_ = snapshot.T_odom_robot;
  const double tick_s = inDoubt() ? std::min(params_.doubt_tick_s, params_.tick_s) : params_.tick_s;
  const auto tick_us = static_cast<StampUs>(tick_s * kSecondUs);
  if (!last_tick_us_ || snapshot.stamp_us >= *last_tick_us_ + tick_us) {
    // The grid of ticks is kept while images come often enough, so that 30 Hz still makes 5 ticks a second.
    const bool is_late = !last_tick_us_ || snapshot.stamp_us >= *last_tick_us_ + 2 * tick_us;
    last_tick_us_ = is_late ? snapshot.stamp_us : *last_tick_us_ + tick_us;
    iterate(update, is_late ? params_.tick_s : tick_s);
  }
  report();
  return estimate_;
}

bool Localizer::inDoubt() const {
  return doubted_us_ && std::min(undisputed_, calm_) < kDoubtEnds &&
         last_stamp_us_ < *doubted_us_ + static_cast<StampUs>(params_.doubt_s * kSecondUs);
}

void Localizer::noteSurprise(bool is_surprised) {
  if (is_surprised && calm_ >= kCalm) {
    doubted_us_ = last_stamp_us_;
    undisputed_ = 0;
    strategy_->takeAsNew();
    for (Race& race : table_.races()) strategy_->rate(race);
  }
  calm_ = is_surprised ? 0 : calm_ + 1;
}

PoseEstimate Localizer::step(const MemoryUpdate& update, const Pose2& T_odom_robot_now) {
  if (params_.robust.rate_at_image_stamp) return step(update);
  auto snapshot = std::make_shared<MemorySnapshot>(*update.snapshot);
  snapshot->T_odom_robot = T_odom_robot_now;
  return step(MemoryUpdate{std::move(snapshot), update.analysis});
}

void Localizer::move(const Pose2& T_before_now) {
  if (odometry_) odometry_->travel(T_before_now);
  const Pose2 T_moved = odometry_ ? odometry_->corrected(T_before_now) : T_before_now;
  for (Race& race : table_.races()) strategy_->move(race, T_moved);
}

void Localizer::iterate(const MemoryUpdate& update, double elapsed_s) {
  ++iteration_;
  if (!strategy_->observe(update)) return;
  const Race* before = table_.winner();
  const std::uint64_t winner_before = before ? before->id : 0;
  const Pose2 pose_before = before ? before->T_world_robot : Pose2{};
  table_.age();
  for (Race& race : table_.races()) strategy_->rate(race);
  // Reliability is slow on purpose; the search need not wait for it when the winner's place does not show
  // what it should.
  const auto agreement = strategy_->agreement(table_);
  const bool is_surprised = agreement && *agreement < kSurprise * reliability_;
  noteSurprise(is_surprised);
  int explorers = explorerCount(params_.explorers, is_surprised ? *agreement : reliability_, iteration_);
  const bool rests = undisputed_ >= kRestAfter && !is_surprised;
  const auto period = static_cast<std::uint64_t>(std::max(1, params_.explorers.period_reliable));
  if (rests && iteration_ % period != 0) explorers = 0;
  if (explorers > 0) {
    for (Race& candidate : strategy_->search(explorers, table_, engine_)) {
      table_.admit(std::move(candidate));
    }
  }
  // Decided before anything is deleted: hopelessness compares with the best.
  std::vector<std::uint64_t> hopeless;
  for (const Race& race : table_.races()) {
    if (strategy_->isHopeless(race, table_)) hopeless.push_back(race.id);
  }
  table_.removeWeak([&](const Race& race) {
    return std::find(hopeless.begin(), hopeless.end(), race.id) != hopeless.end();
  });
  table_.mergeSamePlaces();
  for (Race& race : table_.races()) strategy_->evolve(race, engine_);
  strategy_->choose(table_, reliability_);
  reliability_ = strategy_->nextReliability(reliability_, table_, elapsed_s);
  const Race* winner = table_.winner();
  const bool is_same = winner && winner->id == winner_before;
  undisputed_ = is_same && strategy_->isUndisputed(table_) ? undisputed_ + 1 : 0;
  if (winner && winner_before != 0 && winner->id != winner_before) {
    const double jump = (winner->T_world_robot.position() - pose_before.position()).norm();
    reliability_ *= std::max(0.0, 1.0 - jump / kFullJump_m);
  }
  if (!odometry_) return;
  if (is_same && reliability_ >= params_.odometry.trust && undisputed_ > 0) {
    odometry_->standsAt(winner->T_world_robot, winner->id);
  } else {
    odometry_->lost();
  }
}

void Localizer::beginEpoch() {
  if (odometry_) odometry_->lost();
  undisputed_ = 0;
  doubted_us_.reset();
  reliability_ = std::min(reliability_, kReliabilityAfterEpoch);
  strategy_->forgetEvidence(table_);
  last_tick_us_.reset();
}

void Localizer::setPose(const Pose2& T_world_robot) {
  Race race = strategy_->foundAt(T_world_robot, engine_);
  race.P.topRightCorner<3, 2>().setZero();
  race.P.bottomLeftCorner<2, 3>().setZero();
  race.P.topLeftCorner<3, 3>() =
      Eigen::Vector3d(kGivenStd_m * kGivenStd_m, kGivenStd_m * kGivenStd_m, kGivenStd_rad * kGivenStd_rad)
          .asDiagonal();
  race.P_stated = race.P;
  table_.replaceAll(std::move(race));
  if (odometry_) odometry_->lost();
  undisputed_ = 0;
  doubted_us_.reset();
  strategy_->forgetPast(table_);
  table_.award(table_.winner()->id);
  table_.noteBest(table_.winner()->id);
  // At the caller's word, unless what was seen last speaks against it.
  reliability_ = strategy_->agreement(table_).value_or(1.0);
  report();
}

void Localizer::relocalize() {
  if (odometry_) odometry_->lost();
  doubted_us_.reset();
  table_.clear();
  strategy_->forgetPast(table_);
  reliability_ = 0.0;
  undisputed_ = 0;
  report();
}

void Localizer::report() {
  estimate_.stamp_us = last_stamp_us_;
  ++estimate_.revision;
  estimate_.T_odom_robot = last_T_odom_robot_;
  estimate_.reliability = reliability_;
  estimate_.races.clear();
  const std::vector<double> weights = strategy_->weights(table_);
  const Race* winner = table_.winner();
  for (std::size_t i = 0; i < table_.races().size(); ++i) {
    const Race& race = table_.races()[i];
    estimate_.races.push_back({race.id, race.T_world_robot, race.health, weights[i], race.victories, race.age,
                               winner && race.id == winner->id});
  }
  estimate_.T_world_robot = winner ? std::optional<Pose2>(winner->T_world_robot) : std::nullopt;
  estimate_.P = Eigen::Matrix3d::Zero();
  if (odometry_) estimate_.odometry = odometry_->belief();
  if (winner) estimate_.P = winner->P_stated.topLeftCorner<3, 3>();
}

}  // namespace vismem
