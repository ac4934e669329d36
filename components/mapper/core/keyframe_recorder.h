/// @file Chooses keyframes of a drive through the visual memory. Pure. See B6.
#pragma once

#include <map>
#include <numbers>
#include <optional>
#include <vector>

#include "active_visual_memory/core/attentive_visual_memory.h"
#include "mapper/core/keyframe.h"

namespace vismem {

struct KeyframeParams {
  double distance_m = 0.05;                           ///< a keyframe after this way ..
  double angle_rad = 4.0 * std::numbers::pi / 180.0;  ///< .. or when robot or camera axis turned this far
  /// An element that leaves the memory within this time after it was seen was not forgotten but refuted.
  double dropped_s = 4.0;
  double max_turn_radps = 1.5;  ///< images of a faster camera are left out
  /// The detector ends this short on average; censored ends stay [px].
  double end_short_px = 0.95;
  /// A fainter edge may go on in the line of an edge, such as that of a shadow: the sighting ends where the
  /// contrast falls below this share of what three quarters of its length have at most, for this long.
  double faint_share = 0.25;
  double faint_px = 6.0;
  GroundProjector::Params projector;  ///< of the memory: range, horizon, border and labels off the floor
  FloorEvidence::Params evidence;

  static KeyframeParams of(const AttentiveVisualMemoryParams& memory);
};

/// *Single-threaded* (owner: the loop of the drive). The same observations give the same record.
class KeyframeRecorder {
 public:
  explicit KeyframeRecorder(const KeyframeParams& params) : params_(params) {}

  /// To be called after each image.
  /// @param update    of that image, from the memory.
  /// @param elements  of the memory after it.
  /// @return whether it became a keyframe.
  bool add(const RobotObservation& observation, const MemoryUpdate& update,
           const std::vector<MemoryElement>& elements);

  const DriveRecord& record() const { return record_; }
  DriveRecord take() { return std::move(record_); }
  /// The odometry jumped: a map needs one continuous drive. Later images are ignored.
  bool isBroken() const { return broken_; }

 private:
  bool isDue(const RobotObservation& observation) const;
  LineSighting sightingOf(const ImageAnalysis& analysis, const ImageAnalysis::Match& match,
                          const ImageSegment& observed, const FloorEvidence& evidence,
                          const FloorSegment& floor) const;
  void noteDropped(StampUs stamp_us, std::uint32_t memory_epoch, const std::vector<MemoryElement>& elements);
  void summarize(const RobotObservation& observation, const std::vector<MemoryElement>& elements);

  KeyframeParams params_;
  DriveRecord record_;
  bool broken_ = false;
  std::optional<std::uint32_t> epoch_;
  std::optional<Pose2> last_odom_;
  std::optional<Pose3> last_camera_;  ///< in odom, of the last image
  StampUs last_stamp_us_ = 0;
  std::map<std::uint64_t, StampUs> alive_;  ///< recorded elements of the memory, when last seen
  std::uint32_t memory_epoch_ = 0;
  double way_m_ = 0.0;
  double turned_rad_ = 0.0;
};

}  // namespace vismem
