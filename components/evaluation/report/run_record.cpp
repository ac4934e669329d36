#include "evaluation/report/run_record.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "common/config/text_format.h"
#include "common/geometry/angles.h"
#include "common/segment_map/symmetry.h"

namespace vismem {
namespace {

constexpr StampUs kRecent_us = 2 * kSecondUs;

std::string subtitleOf(const RunSummary& summary) {
  const LocalizationScore& score = summary.score;
  if (score.settled_after_s && score.position_error_m) {
    return formatted("%.1f s, %.1f m driven; settled after %.1f s; mean error %.3f m and %.2f deg",
                     summary.seconds, summary.distance_m, *score.settled_after_s, *score.position_error_m,
                     radToDeg(*score.heading_error_rad));
  }
  if (summary.projection && summary.projection->detected_to_map_px) {
    return formatted("%.1f s, %.1f m; the map lies %.1f px (median) from the detected lines", summary.seconds,
                     summary.distance_m, *summary.projection->detected_to_map_px);
  }
  return formatted("%.1f s, %.1f m driven%s", summary.seconds, summary.distance_m,
                   score.errors.empty() ? "" : "; not settled");
}

template <typename Row>
bool isNewer(StampUs stamp_us, const Row& row) {
  return row.empty() || stamp_us > row.back().stamp_us;
}

/// Mean time between poses: of sparse recordings and very long runs it is more than a second.
StampUs meanStep(const std::vector<PublishedPose>& poses) {
  if (poses.size() < 2) return 0;
  return (poses.back().stamp_us - poses.front().stamp_us) / static_cast<StampUs>(poses.size() - 1);
}

/// The published poses: world -> robot.
Trajectory publishedTrajectory(const RunRecord& record) {
  Trajectory trajectory;
  for (const PublishedPose& p : record.published) {
    if (p.T_world_robot) append(trajectory, {p.stamp_us, *p.T_world_robot});
  }
  return trajectory;
}

Trajectory upTo(const Trajectory& trajectory, StampUs until_us) {
  Trajectory part;
  for (const StampedPose& p : trajectory) {
    if (p.stamp_us <= until_us) part.push_back(p);
  }
  return part;
}

}  // namespace

void SourceRate::add(std::uint64_t seq, StampUs stamp_us) {
  if (!recent_.empty()) {
    const Sample& last = recent_.back();
    if (seq == last.seq && stamp_us == last.stamp_us) return;
    if (seq > last.seq && stamp_us > last.stamp_us) {
      made_ += seq - last.seq;
      seconds_ += toSeconds(stamp_us - last.stamp_us);
    } else {
      recent_.clear();
    }
  }
  recent_.push_back({seq, stamp_us});
  const auto old = std::find_if(recent_.begin(), recent_.end(),
                                [&](const Sample& s) { return s.stamp_us + kRecent_us >= stamp_us; });
  recent_.erase(recent_.begin(), old);
}

double SourceRate::recentHz(StampUs now_us) const {
  if (recent_.size() < 2 || recent_.back().stamp_us + kRecent_us < now_us) return 0.0;
  return static_cast<double>(recent_.back().seq - recent_.front().seq) /
         toSeconds(recent_.back().stamp_us - recent_.front().stamp_us);
}

void RunRecorder::addTruth(const StampedPose& T_world_robot) {
  if (isNewer(T_world_robot.stamp_us, record_.truth)) truth_.add(record_.truth, T_world_robot);
}

void RunRecorder::addOdometry(const StampedPose& T_odom_robot) {
  if (isNewer(T_odom_robot.stamp_us, record_.odometry)) odometry_.add(record_.odometry, T_odom_robot);
}

void RunRecorder::addPublished(const PublishedPose& pose) {
  if (isNewer(pose.stamp_us, record_.published)) published_.add(record_.published, pose);
}

void RunRecorder::addEstimate(const PoseEstimate& estimate) {
  if (isNewer(estimate.stamp_us, record_.estimates)) estimates_.add(record_.estimates, estimate);
}

void RunRecorder::addJudged(std::shared_ptr<const ImageAnalysis> analysis) {
  judged_.add(record_.analyses, std::move(analysis));
}

std::optional<Pose2> odomInWorld(const RunRecord& record, StampUs until_us) {
  const auto newest =
      std::find_if(record.estimates.rbegin(), record.estimates.rend(),
                   [&](const PoseEstimate& e) { return e.stamp_us <= until_us && e.T_world_robot; });
  if (newest == record.estimates.rend()) return std::nullopt;
  return *newest->T_world_robot * inverse(newest->T_odom_robot);
}

RunSummary summarize(const RunRecord& record, const SegmentMap& map_edges, bool judge_projection) {
  RunSummary summary;
  ScoreParams judge;
  judge.symmetries = symmetriesOf(map_edges);
  judge.max_silence_us = std::max(judge.max_silence_us, 3 * meanStep(record.published));
  summary.map_symmetries = static_cast<int>(judge.symmetries.size());
  summary.score = scoreLocalization(record.published, record.truth, record.kidnapped_us, judge);
  if (judge_projection) {
    std::vector<JudgedImage> images;
    for (const auto& analysis : record.analyses) {
      images.push_back({analysis->observed, analysis->intrinsics, analysis->T_robot_camera,
                        carriedPose(record.estimates, analysis->stamp_us, analysis->T_odom_robot)});
    }
    summary.projection = scoreMapProjection(images, map_edges);
  }
  if (record.memory) summary.memory_segments = static_cast<int>(record.memory->segments.size());
  summary.memory_hz = record.iterations.hz();
  summary.camera_hz = record.camera.hz();
  const Trajectory& way = record.truth.empty() ? record.odometry : record.truth;
  summary.distance_m = pathLength(way);
  if (!way.empty()) summary.seconds = toSeconds(way.back().stamp_us - way.front().stamp_us);
  return summary;
}

TopView topViewOf(const RunRecord& record, const RunSummary& summary, const SegmentMap& map,
                  std::string title) {
  // A live run ends with poses newer than its last memory; the picture shows them.
  const bool whole = record.shown_memory == record.memory;
  const StampUs until_us =
      whole || !record.shown_memory ? std::numeric_limits<StampUs>::max() : record.shown_memory->stamp_us;
  TopView view;
  view.title = std::move(title);
  view.subtitle = subtitleOf(summary);
  view.map = map;
  view.truth = upTo(record.truth, until_us);
  view.estimate = upTo(publishedTrajectory(record), until_us);
  const LocalizationScore& score = summary.score;
  if (score.settled_after_s) view.settled_us = score.start_us + toStampUs(*score.settled_after_s);

  // With a known truth odometry starts at the true start, as its user would have it without localization;
  // else the last estimate places it.
  std::optional<Pose2> T_world_odometry = odomInWorld(record, until_us);
  for (const StampedPose& p : record.odometry) {
    if (const auto truth = poseAt(record.truth, p.stamp_us)) {
      T_world_odometry = *truth * inverse(p.pose);
      break;
    }
  }
  if (T_world_odometry) view.odometry = transform(*T_world_odometry, upTo(record.odometry, until_us));
  if (record.shown_memory) {
    const auto T_world_odom = odomInWorld(record, record.shown_memory->stamp_us);
    if (T_world_odom) view.memory = memoryInWorld(*record.shown_memory, *T_world_odom);
  }
  if (!view.truth.empty()) view.true_robot = view.truth.back().pose;
  const auto last = std::find_if(record.estimates.rbegin(), record.estimates.rend(),
                                 [&](const PoseEstimate& e) { return e.stamp_us <= until_us; });
  if (last != record.estimates.rend()) {
    view.races = last->races;
    view.robot = last->T_world_robot;
    if (last->T_world_robot && record.last_analysis)
      view.view = viewOf(*last->T_world_robot, *record.last_analysis, 2.0);
  }
  return view;
}

std::optional<ImageFigure> imageFigureOf(const RunRecord& record, const SegmentMap& map_edges,
                                         std::string title) {
  if (!record.last_analysis || !record.last_image) return std::nullopt;
  ImageFigure figure;
  figure.title = std::move(title);
  figure.image = record.last_image->image;
  figure.analysis = *record.last_analysis;
  figure.T_world_robot =
      carriedPose(record.estimates, record.last_analysis->stamp_us, record.last_analysis->T_odom_robot);
  figure.map_edges = map_edges.segments;
  return figure;
}

}  // namespace vismem
