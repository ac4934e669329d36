#include "localization/core/localizer.h"

#include <algorithm>
#include <cmath>

#include "common/config/text_format.h"
#include "common/geometry/angles.h"
#include "localization/core/hypotheses/chapter_races.h"

namespace vismem {
namespace {

/// Upper bound of support and reliability after a new epoch of the memory or a jump of the source.
constexpr double kReliabilityAfterEpoch = 0.1;
/// Stamps that go back by more than this belong to a restarted source; by less, to a late update.
constexpr StampUs kRestart_us = kSecondUs;
/// A larger motion between two updates is a jump of odometry, not a motion of the robot.
constexpr double kJump_m = 0.5;
constexpr double kJump_rad = 1.0;
constexpr StampUs kJumpWithin_us = kSecondUs / 2;
/// A change of the winner over this distance reduces support to 0; a shorter one in proportion.
constexpr double kFullJump_m = 2.0;
/// Standard deviations of a pose given from outside.
constexpr double kGivenStd_m = 0.1;
constexpr double kGivenStd_rad = 0.1;

/// Support from which on the pose of an unambiguous winner is trusted.
constexpr double kTrust = 0.7;
/// An observation is inconsistent if it supports less than this share of the winner's support.
constexpr double kInconsistent = 0.7;

std::unique_ptr<RaceStrategy> makeStrategy(const LocalizerParams& params, const SegmentMap& map_edges) {
  if (params.mode == LocalizationMode::kChapter) {
    return makeChapterRaces(map_edges, {params.map, params.explorers, params.evolution, params.health});
  }
  return makeRobustRaces(map_edges, params.map, params.explorers, params.robust);
}

Eigen::AlignedBox2d placesOf(const SegmentMap& map_edges) {
  Eigen::AlignedBox2d box;
  for (const MapSegment& segment : map_edges.segments) {
    box.extend(segment.world.a.head<2>().eval());
    box.extend(segment.world.b.head<2>().eval());
  }
  if (box.isEmpty()) return box;
  const Eigen::Vector2d margin = Eigen::Vector2d::Constant(kBesideMap_m);
  return {box.min() - margin, box.max() + margin};
}

}  // namespace

LocalizerParams localizerPreset(LocalizationMode mode) {
  LocalizerParams params;
  params.mode = mode;
  if (mode == LocalizationMode::kDefault) {
    // Health is the explained share here: about 0.5 at the true pose if half of the segments are false.
    params.races.create_health = 0.3;
    params.races.delete_health = 0.3;
    params.explorers.list_health = 0.15;
    params.explorers.count_lost = 500;
    params.explorers.count_reliable = 60;
  }
  return params;
}

void LocalizerParams::visit(ParameterVisitor& v) {
  v.real(expert("Tick_s", "stamps between iterations"), tick_s, 0.001, 60.0);
  map.visit(v);
  v.group("Races", races);
  v.group("Health", health);
  v.group("Robust", robust);
}

HealthMapParams healthMapParams(const LocalizerParams& params) {
  return {params.map, params.health, params.robust.observation, params.robust.likelihood};
}

Localizer::Localizer(const LocalizerParams& params, const SegmentMap& map_edges, std::uint64_t seed)
    : params_(params),
      places_(placesOf(map_edges)),
      strategy_(makeStrategy(params, map_edges)),
      table_(params.races),
      engine_(seed) {}

const PoseEstimate& Localizer::update(const MemoryUpdate& update) {
  const MemorySnapshot& snapshot = *update.snapshot;
  if (has_last_) {
    const bool restarted = snapshot.stamp_us + kRestart_us < last_stamp_us_;
    if (!restarted && snapshot.stamp_us <= last_stamp_us_) return estimate_;
    follow(snapshot);
  }
  has_last_ = true;
  last_revision_ = snapshot.revision;
  epoch_ = snapshot.epoch;
  last_stamp_us_ = snapshot.stamp_us;
  last_T_odom_robot_ = snapshot.T_odom_robot;
  if (update.analysis) strategy_->beginImage(*update.analysis, table_);
  const auto tick_us = static_cast<StampUs>(params_.tick_s * kSecondUs);
  if (!last_tick_us_ || snapshot.stamp_us >= *last_tick_us_ + tick_us) {
    // Ticks stay on their grid while images come often enough: 30 Hz gives 5 ticks per second.
    const bool is_late = !last_tick_us_ || snapshot.stamp_us >= *last_tick_us_ + 2 * tick_us;
    last_tick_us_ = is_late ? snapshot.stamp_us : *last_tick_us_ + tick_us;
    iterate(update);
  }
  report();
  return estimate_;
}

void Localizer::follow(const MemorySnapshot& snapshot) {
  const Pose2 T_before_now = inverse(last_T_odom_robot_) * snapshot.T_odom_robot;
  const bool restarted = snapshot.stamp_us + kRestart_us < last_stamp_us_;
  const bool close_in_time = snapshot.stamp_us - last_stamp_us_ < kJumpWithin_us;
  const bool jumped =
      close_in_time && (T_before_now.position().norm() > kJump_m || std::abs(T_before_now.theta) > kJump_rad);
  // A restarted memory counts its revisions from the beginning; the base may have kept running.
  const bool memory_restarted = snapshot.revision < last_revision_;
  // A new epoch after a pause: odometry of the base may have restarted, too.
  const bool odometry_unsure = snapshot.epoch != epoch_ && !close_in_time && !memory_restarted;
  if (restarted || jumped || odometry_unsure) {
    beginEpoch();
    return;
  }
  // In a new epoch of the memory alone, odometry continues: the races move with the robot.
  for (Race& race : table_.races()) strategy_->predict(race, T_before_now);
  if (snapshot.epoch != epoch_ || memory_restarted) beginEpoch();
}

void Localizer::iterate(const MemoryUpdate& update) {
  ++iteration_;
  if (!strategy_->observe(update)) return;
  Race before;
  if (const Race* winner = table_.winner()) {
    before.id = winner->id;
    before.T_world_robot = winner->T_world_robot;
  }
  table_.age();
  for (Race& race : table_.races()) strategy_->weight(race);
  const auto agreement = strategy_->agreement(table_);
  const bool is_inconsistent = agreement && *agreement < kInconsistent * support_;
  if (is_inconsistent) strategy_->resetNovelty();
  propose(agreement, is_inconsistent);
  table_.prune(strategy_->sparedEvidence(table_));
  table_.mergeSamePlaces();
  for (Race& race : table_.races()) strategy_->refine(race, engine_);
  select(before, is_inconsistent);
}

void Localizer::propose(const std::optional<double>& agreement, bool is_inconsistent) {
  // Support is low-pass filtered; an inconsistent observation starts the full search at once.
  const bool is_idle = tracking_.mode == Tracking::kTracking && !is_inconsistent;
  const int explorers =
      explorerCount(params_.explorers, is_inconsistent ? *agreement : support_, is_idle, iteration_);
  if (explorers <= 0) return;
  for (Race& candidate : strategy_->propose(explorers, table_, engine_)) table_.admit(std::move(candidate));
}

void Localizer::select(const Race& before, bool is_inconsistent) {
  strategy_->select(table_, support_);
  support_ = strategy_->updatedSupport(support_, table_, params_.tick_s);
  const Race* winner = table_.winner();
  const bool is_same = winner && winner->id == before.id;
  const bool is_unambiguous = is_same && strategy_->isUnambiguous(table_);
  tracking_ = nextTracking(tracking_, {winner != nullptr, is_inconsistent, is_unambiguous});
  if (winner && before.id != 0 && !is_same) {
    const double jump = (winner->T_world_robot.position() - before.T_world_robot.position()).norm();
    support_ *= std::max(0.0, 1.0 - jump / kFullJump_m);
  }
  estimate_.reliability = strategy_->reliability(table_, support_);
  if (winner) strategy_->fitCamera(table_, is_same && support_ >= kTrust && is_unambiguous);
}

void Localizer::beginEpoch() {
  tracking_ = restartedTracking(tracking_, table_.winner() != nullptr);
  support_ = std::min(support_, kReliabilityAfterEpoch);
  estimate_.reliability = std::min(estimate_.reliability, kReliabilityAfterEpoch);
  strategy_->discountEvidence(table_);
  last_tick_us_.reset();
}

std::string Localizer::problemOf(const Pose2& T_world_robot) const {
  if (!isFinite(T_world_robot)) return "the pose is not finite";
  if (places_.isEmpty() || places_.contains(T_world_robot.position())) return {};
  return formatted(
      "%.6g %.6g m lies outside the map (must be within %.6g..%.6g, %.6g..%.6g m: its box and what lies "
      "beside it)",
      T_world_robot.x, T_world_robot.y, places_.min().x(), places_.max().x(), places_.min().y(),
      places_.max().y());
}

void Localizer::setPose(const Pose2& T_world_robot) {
  Race race = strategy_->createAt(T_world_robot, engine_);
  race.P.topRightCorner<3, 2>().setZero();
  race.P.bottomLeftCorner<2, 3>().setZero();
  race.P.topLeftCorner<3, 3>() =
      Eigen::Vector3d(kGivenStd_m * kGivenStd_m, kGivenStd_m * kGivenStd_m, kGivenStd_rad * kGivenStd_rad)
          .asDiagonal();
  race.P_reported = race.P;
  table_.replaceAll(std::move(race));
  tracking_ = restartedTracking(tracking_, true);
  strategy_->resetHistory(table_);
  table_.award(table_.winner()->id);
  table_.recordBest(table_.winner()->id);
  // The caller is trusted, unless the last observation contradicts.
  const auto agreement = strategy_->agreement(table_);
  support_ = agreement.value_or(1.0);
  estimate_.reliability = agreement ? strategy_->reliability(table_, support_) : 1.0;
  report();
}

void Localizer::relocalize() {
  table_.clear();
  strategy_->resetHistory(table_);
  support_ = estimate_.reliability = 0.0;
  tracking_ = restartedTracking(tracking_, false);
  report();
}

void Localizer::report() {
  estimate_.stamp_us = last_stamp_us_;
  ++estimate_.revision;
  estimate_.T_odom_robot = last_T_odom_robot_;
  estimate_.support = support_;
  estimate_.races.clear();
  const Race* winner = table_.winner();
  for (const Race& race : table_.races()) {
    const double share = strategy_->beliefShare(race, table_);
    estimate_.races.push_back({race.id, race.T_world_robot, race.health, share, race.victories, race.age,
                               winner && race.id == winner->id});
  }
  estimate_.T_world_robot = winner ? std::optional<Pose2>(winner->T_world_robot) : std::nullopt;
  estimate_.P = Eigen::Matrix3d::Zero();
  estimate_.odometry.reset();
  if (winner && params_.mode == LocalizationMode::kDefault) estimate_.odometry = winner->odometry;
  estimate_.camera = strategy_->cameraErrors();
  if (winner) estimate_.P = strategy_->covariance(*winner);
}

}  // namespace vismem
