/// @file From visual memory to a pose in the world: the loop of prediction, weighting, search and choice of
/// races. Pure. Implements L2. See L1-L9, L12.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "common/config/parameter_visitor.h"
#include "common/segment_map/segment_map.h"
#include "common/visual_memory/memory_snapshot.h"
#include "localization/core/hypotheses/evolution.h"
#include "localization/core/hypotheses/explorers.h"
#include "localization/core/hypotheses/race_strategy.h"
#include "localization/core/hypotheses/robust_races.h"
#include "localization/core/hypotheses/tracking.h"
#include "localization/core/likelihood/chapter_health.h"
#include "localization/core/likelihood/health_map.h"
#include "localization/core/pose_estimate.h"

namespace vismem {

enum class LocalizationMode { kDefault, kChapter };

struct LocalizerParams {
  LocalizationMode mode = LocalizationMode::kDefault;
  double tick_s = 0.2;  ///< of stamps between iterations; every update predicts the races by odometry
  MapParams map;
  RaceParams races;
  ExplorerParams explorers;
  EvolutionParams evolution;  ///< chapter mode
  HealthParams health;        ///< chapter mode
  RobustParams robust;        ///< default mode

  void visit(ParameterVisitor& v);
};

/// The presets: `chapter` as published, with the authors' program where the text is silent; `default` ours.
LocalizerParams localizerPreset(LocalizationMode mode);

/// The part of the parameters that health maps depend on.
HealthMapParams healthMapParams(const LocalizerParams& params);

/// A robot may stand this far beside all that its map shows, as beside the lines of a field [m].
constexpr double kBesideMap_m = 2.0;

/// One robot's localization. The same updates with the same seed give the same estimates.
/// *Single-threaded* (owner: the component's loop).
class Localizer {
 public:
  /// @param map_edges the map with its stripes expanded to edges.
  Localizer(const LocalizerParams& params, const SegmentMap& map_edges, std::uint64_t seed);

  /// Predicts the races by odometry to the update's stamp and, once per tick of stamps, runs an iteration
  /// (L2). The pose belongs to the stamp of the update's image: a late image is rated at the robot's pose of
  /// that time.
  /// @param update both pointers set. An update that is not newer than the last one (except after a restart
  /// of the source's time) returns the last estimate again.
  const PoseEstimate& update(const MemoryUpdate& update);
  /// Replaces all races by one at this pose at the last update's stamp. Its reliability is what the last
  /// observation supports, or 1 with too little evidence or in chapter mode. This and relocalize() make a new
  /// estimate at the last stamp; before the first update latest() has no stamp.
  void setPose(const Pose2& T_world_robot);
  /// Deletes all races and searches the whole map.
  void relocalize();

  /// @return why the robot cannot be at a pose: not finite, or more than kBesideMap_m (or the explorers'
  /// margin, if larger) outside the map's bounding box; empty if it can.
  std::string problemOf(const Pose2& T_world_robot) const;

  const PoseEstimate& latest() const { return estimate_; }
  const RaceTable& table() const { return table_; }

 private:
  /// Predicts to the snapshot's stamp, or begins an epoch where its odometry does not continue.
  void follow(const MemorySnapshot& snapshot);
  void iterate(const MemoryUpdate& update);
  void propose(const std::optional<double>& agreement, bool is_inconsistent);
  /// @param before the winner before this iteration; id 0: none.
  void select(const Race& before, bool is_inconsistent);
  void beginEpoch();
  void report();

  LocalizerParams params_;
  Eigen::AlignedBox2d places_;  ///< where the robot can be
  std::unique_ptr<RaceStrategy> strategy_;
  RaceTable table_;
  RandomEngine engine_;
  PoseEstimate estimate_;
  bool has_last_ = false;
  StampUs last_stamp_us_ = 0;
  std::uint64_t last_revision_ = 0;  ///< of the memory's snapshots
  std::optional<StampUs> last_tick_us_;
  Pose2 last_T_odom_robot_;
  std::uint32_t epoch_ = 0;
  std::uint64_t iteration_ = 0;
  double support_ = 0.0;  ///< RaceStrategy::updatedSupport
  TrackingState tracking_;
};

}  // namespace vismem
