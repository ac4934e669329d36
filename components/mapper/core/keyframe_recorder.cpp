#include "mapper/core/keyframe_recorder.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <utility>

#include "common/geometry/angles.h"
#include "common/vision/reduced_image.h"

namespace vismem {

KeyframeParams KeyframeParams::of(const AttentiveVisualMemoryParams& memory) {
  KeyframeParams params;
  params.projector = memory.projector;
  params.evidence = memory.memory.evidence;
  return params;
}

namespace {

Pose3 cameraInOdom(const Pose2& T_odom_robot, const Pose3& T_robot_camera) {
  return toPose3(T_odom_robot) * T_robot_camera;
}

}  // namespace

bool KeyframeRecorder::isDue(const ImageAnalysis& analysis) const {
  if (record_.keyframes.empty()) return true;
  const Keyframe& last = record_.keyframes.back();
  if (way_m_ - last.way_m >= params_.distance_m) return true;
  const Pose3 before = cameraInOdom(last.T_odom_robot, last.T_robot_camera);
  const Pose3 now = cameraInOdom(analysis.T_odom_robot, analysis.T_robot_camera);
  const double turn = std::acos(std::clamp(before.linear().col(2).dot(now.linear().col(2)), -1.0, 1.0));
  return turn >= params_.angle_rad ||
         std::abs(angleDifference(analysis.T_odom_robot.theta, last.T_odom_robot.theta)) >= params_.angle_rad;
}

double KeyframeRecorder::turnRate(const ImageAnalysis& analysis) const {
  if (!last_ || analysis.stamp_us <= last_->stamp_us) return 0.0;
  const Pose3 before = cameraInOdom(last_->T_odom_robot, last_->T_robot_camera);
  const Pose3 now = cameraInOdom(analysis.T_odom_robot, analysis.T_robot_camera);
  const Eigen::AngleAxisd turn(Eigen::Matrix3d(before.linear().transpose() * now.linear()));
  return std::abs(turn.angle()) / toSeconds(analysis.stamp_us - last_->stamp_us);
}

bool KeyframeRecorder::jumpsTo(const ImageAnalysis& analysis) const {
  // As of ObservationAssembler, and what a fast robot drives between two updates that a reader saw.
  constexpr double kJump_m = 0.5;
  constexpr double kJump_rad = 1.0;
  constexpr double kFastest_mps = 1.5;
  constexpr double kFastest_radps = 3.0;
  if (!last_) return false;
  const double dt = toSeconds(analysis.stamp_us - last_->stamp_us);
  const double shift_m = (analysis.T_odom_robot.position() - last_->T_odom_robot.position()).norm();
  const double turn_rad = std::abs(angleDifference(analysis.T_odom_robot.theta, last_->T_odom_robot.theta));
  return dt < 0.0 || shift_m > kJump_m + kFastest_mps * dt || turn_rad > kJump_rad + kFastest_radps * dt;
}

namespace {

/// A segment without the faint parts at its ends.
struct Strong {
  Segment2 px;
  bool cut_a = false;
  bool cut_b = false;
};

Strong strongPart(const Segment2& px, const FloorEvidence& evidence, const KeyframeParams& params) {
  constexpr double kStep_px = 2.0;
  constexpr double kQuantile = 0.75;
  const int steps = static_cast<int>(px.length() / kStep_px);
  std::vector<double> contrasts;
  for (int i = 0; i < steps; ++i) {
    // The far end of a thin line has its colour only near the edge.
    const auto near = evidence.contrastAt(px, (i + 0.5) / steps, 1.0);
    const auto far = evidence.contrastAt(px, (i + 0.5) / steps, 2.0);
    if (near && far) contrasts.push_back(std::max(*near, *far));
  }
  Strong strong{px};
  // At the border of the image nothing can be said.
  if (static_cast<int>(contrasts.size()) < std::max(1, steps)) return strong;
  std::vector<double> sorted = contrasts;
  const auto high = sorted.begin() + static_cast<std::ptrdiff_t>(kQuantile * (steps - 1));
  std::nth_element(sorted.begin(), high, sorted.end());
  const double least = params.faint_share * *high;
  const auto is_strong = [&](double contrast) { return contrast >= least; };
  const auto first = std::find_if(contrasts.begin(), contrasts.end(), is_strong);
  const auto last = std::find_if(contrasts.rbegin(), contrasts.rend(), is_strong);
  const double before_px = kStep_px * static_cast<double>(first - contrasts.begin());
  const double behind_px = kStep_px * static_cast<double>(last - contrasts.rbegin());
  const Eigen::Vector2d along = (px.b - px.a).normalized();
  strong.cut_a = before_px >= params.faint_px;
  strong.cut_b = behind_px >= params.faint_px;
  if (strong.cut_a) strong.px.a += before_px * along;
  if (strong.cut_b) strong.px.b -= behind_px * along;
  return strong;
}

}  // namespace

LineSighting KeyframeRecorder::sightingOf(const ImageAnalysis& analysis, const ImageAnalysis::Match& match,
                                          const ImageSegment& observed, const FloorEvidence& evidence,
                                          const FloorSegment& floor) const {
  const PredictedSegment& predicted = analysis.predicted[static_cast<std::size_t>(match.predicted)];
  LineSighting sighting;
  sighting.element = predicted.id;
  const Strong strong = strongPart(observed.px, evidence, params_);
  sighting.px = strong.px;
  sighting.censored_a = !strong.cut_a && (floor.a.censored || evidence.isHiddenBeyond(strong.px, false));
  sighting.censored_b = !strong.cut_b && (floor.b.censored || evidence.isHiddenBeyond(strong.px, true));
  const Eigen::Vector2d along = (observed.px.b - observed.px.a).normalized();
  const Eigen::Vector2d short_px = params_.projector.end_short_px * along;
  if (!sighting.censored_a && !strong.cut_a) sighting.px.a -= short_px;
  if (!sighting.censored_b && !strong.cut_b) sighting.px.b += short_px;
  if (along.dot(predicted.px.b - predicted.px.a) < 0.0) {
    std::swap(sighting.px.a, sighting.px.b);
    std::swap(sighting.censored_a, sighting.censored_b);
  }
  return sighting;
}

void KeyframeRecorder::noteDropped(const MemoryUpdate& update, std::span<const MemorySegment> elements) {
  const StampUs now_us = update.snapshot->stamp_us;
  std::map<std::uint64_t, StampUs> alive;
  const auto keep = [&](std::uint64_t id, StampUs seen_us) {
    if (record_.elements.count(id) > 0) alive[id] = seen_us;
  };
  // An element that is published in parts (junctions, circles) is still predicted as one.
  for (const PredictedSegment& predicted : update.analysis->predicted) {
    const auto known = alive_.find(predicted.id);
    keep(predicted.id, known == alive_.end() ? now_us : known->second);
  }
  for (const ImageAnalysis::Match& match : update.analysis->matches)
    keep(update.analysis->predicted[static_cast<std::size_t>(match.predicted)].id, now_us);
  for (const MemorySegment& segment : elements) keep(segment.id, segment.last_seen_us);
  // A memory that began anew dropped all, whatever it knew of them.
  if (update.snapshot->epoch == memory_epoch_) {
    for (const auto& [id, seen_us] : alive_) {
      if (alive.count(id) == 0) {
        record_.elements[id].dropped = toSeconds(now_us - seen_us) <= params_.dropped_s;
      }
    }
  }
  for (const auto& [id, seen_us] : alive) record_.elements[id].dropped = false;
  memory_epoch_ = update.snapshot->epoch;
  alive_ = std::move(alive);
}

void KeyframeRecorder::summarize(StampUs stamp_us, std::span<const MemorySegment> elements) {
  const int index = static_cast<int>(record_.keyframes.size()) - 1;
  const Pose2 T_robot_odom = inverse(record_.keyframes.back().T_odom_robot);
  for (const MemorySegment& segment : elements) {
    if (segment.last_seen_us != stamp_us) continue;
    const auto known = record_.elements.find(segment.id);
    if (known == record_.elements.end()) continue;
    ElementSummary& summary = known->second;
    summary.label = segment.label;
    summary.confirmed = segment.confirmed;
    summary.last_keyframe = index;
    summary.robot = transform(T_robot_odom, segment.odom.floor());
  }
}

void KeyframeRecorder::addKeyframe(const Frame& frame, const ImageAnalysis& analysis,
                                   double turn_rate_radps) {
  Keyframe keyframe{analysis.stamp_us,
                    analysis.T_odom_robot,
                    analysis.T_robot_camera,
                    analysis.intrinsics,
                    turn_rate_radps,
                    way_m_,
                    turned_rad_,
                    {}};
  cv::Mat image = frame.image;
  if (const int block = blockSize(frame.intrinsics); block > 1) {
    reduceImage(frame.image, frame.intrinsics, block, reduced_);
    image = reduced_;
  }
  const auto floor =
      GroundProjector(params_.projector)
          .project(keyframe.intrinsics, analysis.T_robot_camera, analysis.observed, turn_rate_radps);
  std::unordered_map<int, const FloorSegment*> floor_of;
  for (const FloorSegment& segment : floor) floor_of[segment.observed] = &segment;
  const FloorEvidence evidence(image, keyframe.intrinsics, params_.evidence);
  const int index = static_cast<int>(record_.keyframes.size());
  for (const ImageAnalysis::Match& match : analysis.matches) {
    const auto placed = floor_of.find(match.observed);
    if (placed == floor_of.end()) continue;
    keyframe.sightings.push_back(sightingOf(analysis, match,
                                            analysis.observed[static_cast<std::size_t>(match.observed)],
                                            evidence, *placed->second));
    const LineSighting& sighting = keyframe.sightings.back();
    ElementSummary& summary = record_.elements[sighting.element];
    const bool is_first = summary.sightings++ == 0;
    if (is_first) summary.first_keyframe = index;
    summary.last_keyframe = index;
    summary.censored_a = sighting.censored_a && (is_first || summary.censored_a);
    summary.censored_b = sighting.censored_b && (is_first || summary.censored_b);
  }
  record_.keyframes.push_back(std::move(keyframe));
}

bool KeyframeRecorder::add(const Frame& frame, const MemoryUpdate& update,
                           std::span<const MemorySegment> elements) {
  const ImageAnalysis& analysis = *update.analysis;
  if (broken_ || analysis.stamp_us != frame.stamp_us) return false;
  if (last_ && last_->frame_seq == analysis.frame_seq && last_->stamp_us == analysis.stamp_us) return false;
  if (jumpsTo(analysis)) {
    broken_ = true;
    return false;
  }
  if (last_) {
    way_m_ += (analysis.T_odom_robot.position() - last_->T_odom_robot.position()).norm();
    turned_rad_ += std::abs(angleDifference(analysis.T_odom_robot.theta, last_->T_odom_robot.theta));
  }
  const double rate = turnRate(analysis);
  last_ = update.analysis;
  const bool due = !frame.image.empty() && rate <= params_.max_turn_radps && isDue(analysis);
  if (due) addKeyframe(frame, analysis, rate);
  if (!record_.keyframes.empty()) summarize(update.snapshot->stamp_us, elements);
  noteDropped(update, elements);
  return due;
}

}  // namespace vismem
