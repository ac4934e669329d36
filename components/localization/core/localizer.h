/// @file From visual memory to a pose in the world: races compete until one explains what is seen. Pure.
/// SPEC L1-L9, L12; DESIGN 9, 14.
#pragma once

#include <cstdint>
#include <memory>

#include "common/segment_map/segment_map.h"
#include "common/visual_memory/memory_snapshot.h"
#include "localization/core/learnt_odometry.h"
#include "localization/core/params.h"
#include "localization/core/pose_estimate.h"
#include "localization/core/race_strategy.h"

namespace vismem {

/// One robot's localization. The same updates with the same seed give the same estimates.
/// *Single-threaded* (owner: the component's loop).
class Localizer {
 public:
  /// @param map_edges the map with its stripes expanded to edges.
  Localizer(const LocalizerParams& params, const SegmentMap& map_edges, std::uint64_t seed);
  ~Localizer();
  Localizer(Localizer&&) noexcept;
  Localizer& operator=(Localizer&&) noexcept;

  /// Moves the races by odometry to the update's stamp and, once per tick of stamps, iterates (L2). The
  /// pose belongs to the stamp of the update's image: a late image is rated where the robot was then.
  /// @param update both pointers set. An update that is not newer than the last one (but for a restart of
  /// the source's time) returns the last estimate again.
  PoseEstimate step(const MemoryUpdate& update);
  /// The same for one who knows the odometry at the moment the update arrives. It is used only to show what
  /// happens otherwise: with RobustParams::rate_at_image_stamp off a late image counts as taken now.
  PoseEstimate step(const MemoryUpdate& update, const Pose2& T_odom_robot_now);

  /// "The robot is here" (at the last update's stamp): this race alone, as reliable as
  /// what was seen last lets it be (default mode), at one's word where that is too little. This and
  /// relocalize() make a new estimate at the last stamp; before the first update latest() stays without a
  /// stamp.
  void setPose(const Pose2& T_world_robot);
  /// "Forget where you were": no race, explore everywhere.
  void relocalize();

  const PoseEstimate& latest() const { return estimate_; }
  const RaceTable& table() const { return table_; }

 private:
  void iterate(const MemoryUpdate& update, double elapsed_s);
  void noteSurprise(bool is_surprised);
  bool inDoubt() const;
  void move(const Pose2& T_before_now);
  void beginEpoch();
  void report();

  LocalizerParams params_;
  std::unique_ptr<RaceStrategy> strategy_;
  RaceTable table_;
  RandomEngine engine_;
  std::optional<LearntOdometry> odometry_;
  PoseEstimate estimate_;
  bool has_last_ = false;
  StampUs last_stamp_us_ = 0;
  std::uint64_t last_revision_ = 0;  ///< of the memory's snapshots
  std::optional<StampUs> last_tick_us_;
  Pose2 last_T_odom_robot_;
  std::uint32_t epoch_ = 0;
  std::uint64_t iteration_ = 0;
  double reliability_ = 0.0;
  int calm_ = 0;                       ///< iterations since the last surprise
  std::optional<StampUs> doubted_us_;  ///< when one came that began a doubt
  int undisputed_ = 0;                 ///< iterations for which nothing spoke against the winner
};

}  // namespace vismem
