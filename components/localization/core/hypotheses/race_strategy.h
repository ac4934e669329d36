/// @file The steps of an iteration that differ between the two modes. Pure. See L2.
#pragma once

#include <optional>
#include <span>

#include "common/visual_memory/memory_snapshot.h"
#include "localization/core/hypotheses/race.h"
#include "localization/core/hypotheses/race_table.h"
#include "localization/core/pose_estimate.h"
#include "localization/core/random_engine.h"

namespace vismem {

/// Prediction, weighting, search, refinement and choice of races. *Single-threaded* (owner: Localizer).
/// Invariant: every race that it returns or leaves in the table is rated by the last observation.
class RaceStrategy {
 public:
  virtual ~RaceStrategy() = default;

  /// Takes the camera of each image, also between iterations; its turn makes the tilt of races uncertain.
  virtual void beginImage(const ImageAnalysis& /*analysis*/, RaceTable& /*table*/) {}
  /// Takes the observation of an update.
  /// @return false without evidence; the races stay unchanged then.
  virtual bool observe(const MemoryUpdate& update) = 0;
  /// Motion operator: the robot moved by T_before_now in its own frame.
  virtual void predict(Race& race, const Pose2& T_before_now) const = 0;
  /// Rates a race by the last observation.
  virtual void weight(Race& race) const = 0;
  /// L6: sends explorers out and creates races at the best places, best first.
  /// @return valid until the next call.
  virtual std::span<Race> propose(int explorers, const RaceTable& table, RandomEngine& engine) = 0;
  /// A rated race at a given place.
  virtual Race createAt(const Pose2& T_world_robot, RandomEngine& engine) const = 0;
  /// Evidence from which a race is not pruned, however little of one image it explains.
  virtual double sparedEvidence(const RaceTable& table) const = 0;
  /// L9, or maximization of the likelihood; the race is rated afterwards.
  virtual void refine(Race& race, RandomEngine& engine) const = 0;
  /// L8: victories and the winner.
  /// @param support 0..1 of the last iteration.
  virtual void select(RaceTable& table, double support) = 0;
  /// A race's share of belief; the sum over the table is 1.
  virtual double beliefShare(const Race& race, const RaceTable& table) const = 0;
  /// Support that this observation alone gives the winner, 0..1; empty with too little evidence.
  /// Requires that all races are rated.
  virtual std::optional<double> agreement(const RaceTable& table) const = 0;
  /// True if the winner has nearly all belief, however little it explains.
  virtual bool isUnambiguous(const RaceTable& table) const = 0;
  /// Support of the winner by the last seconds, 0..1, which controls the search; before the discount for a
  /// jump of the winner.
  /// @param elapsed_s since the last iteration.
  virtual double updatedSupport(double last, const RaceTable& table, double elapsed_s) const = 0;
  /// Reliability that is published, 0..1; 0 without a winner.
  virtual double reliability(const RaceTable& table, double support) const = 0;
  /// Fits the camera to the last observation at the winner's pose, and learns its errors where that is
  /// trusted.
  /// @param table with a winner.
  virtual void fitCamera(RaceTable& /*table*/, bool /*is_trusted*/) {}
  /// Covariance of a race's pose (x, y, theta).
  virtual Eigen::Matrix3d covariance(const Race& race) const { return race.P_reported.topLeftCorner<3, 3>(); }
  virtual std::optional<CameraErrors> cameraErrors() const { return std::nullopt; }
  /// The robot may have been moved: what it sees now is new, wherever odometry has it.
  virtual void resetNovelty() {}
  /// Reduces the races' evidence, after a new epoch of the memory or a jump of the source.
  virtual void discountEvidence(RaceTable& table) = 0;
  /// Drops past observations, after a pose given from outside (one race) or a relocalization (empty table).
  virtual void resetHistory(const RaceTable& table) = 0;
};

}  // namespace vismem
