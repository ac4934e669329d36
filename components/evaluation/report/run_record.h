/// @file The record of a run, and the figures of merit and pictures made of it. Pure.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/segment_map/segment_map.h"
#include "common/visual_memory/memory_snapshot.h"
#include "evaluation/core/map_projection.h"
#include "evaluation/core/metrics.h"
#include "evaluation/core/thinning.h"
#include "evaluation/core/trajectory.h"
#include "evaluation/figures/image_figure.h"
#include "evaluation/figures/top_view.h"
#include "localization/core/pose_estimate.h"

namespace vismem {

/// Rate of a source from its own sequence numbers and stamps; samples that the listener missed count, too.
class SourceRate {
 public:
  /// A number or stamp that decreases (a restart, a seek) begins a new stretch; stretches add up.
  void add(std::uint64_t seq, StampUs stamp_us);
  /// Mean over all stretches in the source's time; 0 before two samples.
  double hz() const { return seconds_ > 0.0 ? static_cast<double>(made_) / seconds_ : 0.0; }
  /// Over the last seconds of the newest stretch; 0 when it has nothing so new.
  /// @param now_us present time on the clock of the stamps.
  double recentHz(StampUs now_us) const;

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
  Trajectory truth;                      ///< world -> robot; empty: not known
  std::vector<StampUs> kidnapped_us;     ///< of the truth
  Trajectory odometry;                   ///< odom -> robot
  std::vector<PublishedPose> published;  ///< the pose that a user had, by stamp
  std::vector<PoseEstimate> estimates;   ///< stamps strictly increase
  /// Of judged images that the memory used, in order; empty when the map's projection is not measured.
  std::vector<std::shared_ptr<const ImageAnalysis>> analyses;
  std::shared_ptr<const MemorySnapshot> memory;  ///< the last; null: none received
  /// The memory that the pictures show: the last one, but none after the last judged image of a recording.
  std::shared_ptr<const MemorySnapshot> shown_memory;
  std::shared_ptr<const ImageAnalysis> last_analysis;  ///< of last_image where there is one
  std::optional<Frame> last_image;
  SourceRate camera;
  SourceRate iterations;  ///< of the memory
};

/// Fills the long rows of a record in bounded memory: at most about 200 MB, however long the run. All samples
/// of an hour at 20 Hz are kept; of a longer run they lie further apart. *Value.*
class RunRecorder {
 public:
  // A sample that is not newer than the last one is left out.
  void addTruth(const StampedPose& T_world_robot);
  void addOdometry(const StampedPose& T_odom_robot);
  void addPublished(const PublishedPose& pose);
  void addEstimate(const PoseEstimate& estimate);
  /// @param analysis of a judged image.
  void addJudged(std::shared_ptr<const ImageAnalysis> analysis);

  RunRecord& record() { return record_; }
  const RunRecord& record() const { return record_; }

 private:
  // Of six days at 100 Hz true poses lie within the second that poseAt interpolates over.
  static constexpr std::size_t kTruth = 1 << 20;      // 40 bytes each
  static constexpr std::size_t kPoses = 1 << 18;      // 40 to 60 bytes each
  static constexpr std::size_t kEstimates = 1 << 16;  // about 1 kB each, with ten races
  static constexpr std::size_t kJudged = 1 << 11;     // about 20 kB each
  RunRecord record_;
  Thinning truth_{kTruth};
  Thinning odometry_{kPoses};
  Thinning published_{kPoses};
  Thinning estimates_{kEstimates};
  Thinning judged_{kJudged};
};

struct RunSummary {
  LocalizationScore score;
  std::optional<MapProjectionScore> projection;
  int memory_segments = 0;
  double memory_hz = 0.0;  ///< in the robot's time
  double camera_hz = 0.0;
  double seconds = 0.0;     ///< of the robot's time
  int map_symmetries = 0;   ///< twin places of each place: the errors count against the nearest
  double distance_m = 0.0;  ///< driven, by the truth, else by odometry
};

/// @param judge_projection measures the map's projection into record.analyses.
RunSummary summarize(const RunRecord& record, const SegmentMap& map_edges, bool judge_projection = false);

/// T_world_odom of the newest estimate with a pose at or before a stamp; empty: there is none.
std::optional<Pose2> odomInWorld(const RunRecord& record, StampUs until_us);

/// The top view of the run up to the shown memory.
/// @param map with its stripes not expanded.
TopView topViewOf(const RunRecord& record, const RunSummary& summary, const SegmentMap& map,
                  std::string title);
/// @return empty when the run has no analysed image.
std::optional<ImageFigure> imageFigureOf(const RunRecord& record, const SegmentMap& map_edges,
                                         std::string title);

}  // namespace vismem
