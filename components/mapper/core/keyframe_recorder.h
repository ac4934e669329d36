/// @file Chooses keyframes of a drive through the visual memory. Pure. See B6.
#pragma once

#include <map>
#include <numbers>
#include <optional>
#include <span>
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
  /// A fainter edge may go on in the line of an edge, such as that of a shadow: the sighting ends where the
  /// contrast falls below this share of what three quarters of its length have at most, for this long.
  double faint_share = 0.25;
  double faint_px = 6.0;
  /// Of the memory: range, horizon, border and labels off the floor, and how short the detector ends.
  GroundProjector::Params projector;
  FloorEvidence::Params evidence;

  static KeyframeParams of(const AttentiveVisualMemoryParams& memory);
};

/// *Single-threaded* (owner: the loop of the drive). The same observations give the same record.
class KeyframeRecorder {
 public:
  explicit KeyframeRecorder(const KeyframeParams& params) : params_(params) {}

  /// To be called after each image, in the order of stamps; an update that is not of this image is left out.
  /// @param frame   the image of the update; without pixels the update becomes no keyframe. Images of more
  ///                pixels than the analysis are averaged (reduced_image.h).
  /// @param update    of the memory, as published.
  /// @param elements  of the memory after it. An element that is published in parts (junctions, shapes) has
  ///                  other ids there: PublishedElements (drive_collector.h) finds it where the memory is not
  ///                  at hand.
  /// @return whether it became a keyframe.
  /// @throws std::invalid_argument if the size of the image is not that of its intrinsics.
  bool add(const Frame& frame, const MemoryUpdate& update, std::span<const MemorySegment> elements);

  const DriveRecord& record() const { return record_; }
  /// The odometry jumped: a map needs one continuous drive. Later images are ignored.
  bool isBroken() const { return broken_; }

 private:
  bool isDue(const ImageAnalysis& analysis) const;
  /// Of the camera since the last update [rad/s].
  double turnRate(const ImageAnalysis& analysis) const;
  /// Whether time or odometry jumped since the last update.
  bool jumpsTo(const ImageAnalysis& analysis) const;
  void addKeyframe(const Frame& frame, const ImageAnalysis& analysis, double turn_rate_radps);
  LineSighting sightingOf(const ImageAnalysis& analysis, const ImageAnalysis::Match& match,
                          const ImageSegment& observed, const FloorEvidence& evidence,
                          const FloorSegment& floor) const;
  void noteDropped(const MemoryUpdate& update, std::span<const MemorySegment> elements);
  void summarize(StampUs stamp_us, std::span<const MemorySegment> elements);

  KeyframeParams params_;
  DriveRecord record_;
  bool broken_ = false;
  std::shared_ptr<const ImageAnalysis> last_;  ///< of the last update
  std::map<std::uint64_t, StampUs> alive_;     ///< recorded elements of the memory, when last seen
  std::uint32_t memory_epoch_ = 0;
  cv::Mat reduced_;
  double way_m_ = 0.0;
  double turned_rad_ = 0.0;
};

}  // namespace vismem
