/// @file What a run leaves behind, and what is made of it: figures of merit and pictures. Pure.
/// The live application fills a record from Ice, an evaluation in lock-step from its own loop.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/segment_map/segment_map.h"
#include "common/visual_memory/memory_snapshot.h"
#include "experiments/core/figures.h"
#include "experiments/core/map_projection.h"
#include "experiments/core/metrics.h"
#include "experiments/core/trajectory.h"
#include "localization/core/pose_estimate.h"

namespace vismem {

/// Counts what a source made, by its own sequence numbers and stamps: what the listener missed counts too.
class RateCounter {
 public:
  /// A number or stamp that goes back (a restart, a seek) begins a new stretch; stretches add up.
  void add(std::uint64_t seq, StampUs stamp_us);
  /// Mean over all stretches in the source's time; 0 before two samples.
  double hz() const { return seconds_ > 0.0 ? static_cast<double>(made_) / seconds_ : 0.0; }
  /// Over the last seconds of the newest stretch.
  double recentHz() const;

 private:
  struct Sample {
    std::uint64_t seq = 0;
    StampUs stamp_us = 0;
  };
  std::vector<Sample> recent_;
  std::uint64_t made_ = 0;
  double seconds_ = 0.0;
};

/// Images of a recording that are judged, counted from 1; the last one included.
struct ImageRange {
  int first = 1;
  int last = 1'000'000'000;

  /// @param frame_seq a recording's first image has the sequence number 0.
  bool contains(std::uint64_t frame_seq) const {
    return frame_seq + 1 >= static_cast<std::uint64_t>(first) && !isPast(frame_seq);
  }
  bool isPast(std::uint64_t frame_seq) const { return frame_seq + 1 > static_cast<std::uint64_t>(last); }
};

struct RunRecord {
  Trajectory truth;                     ///< world -> robot; empty for recordings
  std::vector<StampUs> kidnapped_us;    ///< of the truth
  Trajectory odometry;                  ///< odom -> robot
  std::vector<PoseEstimate> estimates;  ///< stamps strictly increase
  /// One per judged image that the memory used, in order; empty where the map's projection is not judged.
  std::vector<std::shared_ptr<const ImageAnalysis>> analyses;
  std::shared_ptr<const MemorySnapshot> memory;  ///< the last; null: none came
  /// What the pictures show: the last, but not past the last judged image of a recording.
  std::shared_ptr<const MemorySnapshot> shown_memory;
  std::shared_ptr<const ImageAnalysis> last_analysis;  ///< of last_image where there is one
  std::optional<Frame> last_image;
  RateCounter camera;
  RateCounter iterations;  ///< of the memory
};

struct RunSummary {
  LocalizationScore score;
  std::optional<MapProjectionScore> projection;
  int memory_segments = 0;
  double memory_hz = 0.0;  ///< in the robot's time
  double camera_hz = 0.0;
  double seconds = 0.0;     ///< of the robot's time
  double distance_m = 0.0;  ///< driven, by the truth or else by odometry
};

/// @param judge_projection measures the map's projection into record.analyses.
RunSummary summarize(const RunRecord& record, const SegmentMap& map_edges, bool judge_projection = false);

/// The trajectory of the published poses: world -> robot.
Trajectory publishedTrajectory(const RunRecord& record);
/// Where odom lies in world over time, by the estimates with a pose at or before a stamp. Where settling is
/// known, the time before it is left out: those poses are guesses; unless nothing else is there.
Trajectory odomInWorld(const RunRecord& record, std::optional<StampUs> settled_us, StampUs until_us);

/// Shows the run up to the shown memory. @param map with its stripes as they are.
TopView topViewOf(const RunRecord& record, const RunSummary& summary, const SegmentMap& map,
                  std::string title);
/// @return empty when the run has no analysed image.
std::optional<ImageFigure> imageFigureOf(const RunRecord& record, const SegmentMap& map_edges,
                                         std::string title);

}  // namespace vismem
