#include "mapper/core/keyframe_recorder.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <utility>

#include "common/geometry/angles.h"

namespace vismem {

KeyframeParams KeyframeParams::of(const AttentiveVisualMemoryParams& memory) {
  KeyframeParams params;
  params.projector = memory.projector;
  // The sighting keeps the pixel where the segment ended; the shift is our own.
  params.projector.end_short_px = 0.0;
  params.evidence = memory.memory.evidence;
  return params;
}

bool KeyframeRecorder::isDue(const RobotObservation& observation) const {
  if (record_.keyframes.empty()) return true;
  const Keyframe& last = record_.keyframes.back();
  if (way_m_ - last.way_m >= params_.distance_m) return true;
  const Pose3 before = toPose3(last.T_odom_robot) * last.T_robot_camera;
  const Pose3 now = toPose3(observation.T_odom_robot) * observation.T_robot_camera;
  const double turn = std::acos(std::clamp(before.linear().col(2).dot(now.linear().col(2)), -1.0, 1.0));
  return turn >= params_.angle_rad || std::abs(angleDifference(observation.T_odom_robot.theta,
                                                               last.T_odom_robot.theta)) >= params_.angle_rad;
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
  sighting.censored_a = !strong.cut_a && (floor.censored_a || evidence.isHiddenBeyond(strong.px, false));
  sighting.censored_b = !strong.cut_b && (floor.censored_b || evidence.isHiddenBeyond(strong.px, true));
  const Eigen::Vector2d along = (observed.px.b - observed.px.a).normalized();
  if (!sighting.censored_a && !strong.cut_a) sighting.px.a -= params_.end_short_px * along;
  if (!sighting.censored_b && !strong.cut_b) sighting.px.b += params_.end_short_px * along;
  if (along.dot(predicted.px.b - predicted.px.a) < 0.0) {
    std::swap(sighting.px.a, sighting.px.b);
    std::swap(sighting.censored_a, sighting.censored_b);
  }
  return sighting;
}

void KeyframeRecorder::noteDropped(StampUs stamp_us, std::uint32_t memory_epoch,
                                   const std::vector<MemoryElement>& elements) {
  std::map<std::uint64_t, StampUs> alive;
  for (const MemoryElement& element : elements) {
    if (record_.elements.count(element.value.id) > 0) alive[element.value.id] = element.value.last_seen_us;
  }
  // A memory that began anew dropped all, whatever it knew of them.
  if (memory_epoch == memory_epoch_) {
    for (const auto& [id, seen_us] : alive_) {
      if (alive.count(id) == 0) {
        record_.elements[id].dropped = toSeconds(stamp_us - seen_us) <= params_.dropped_s;
      }
    }
  }
  memory_epoch_ = memory_epoch;
  alive_ = std::move(alive);
}

void KeyframeRecorder::summarize(const RobotObservation& observation,
                                 const std::vector<MemoryElement>& elements) {
  const int index = static_cast<int>(record_.keyframes.size()) - 1;
  const Pose2 T_robot_odom = inverse(record_.keyframes.back().T_odom_robot);
  for (const MemoryElement& element : elements) {
    if (element.value.last_seen_us != observation.frame.stamp_us) continue;
    const auto known = record_.elements.find(element.value.id);
    if (known == record_.elements.end()) continue;
    ElementSummary& summary = known->second;
    summary.label = element.value.label;
    summary.confirmed = element.value.confirmed;
    summary.last_keyframe = index;
    summary.robot = transform(T_robot_odom, element.line.segment());
    summary.censored_a = element.line.endA().censored;
    summary.censored_b = element.line.endB().censored;
  }
}

bool KeyframeRecorder::add(const RobotObservation& observation, const MemoryUpdate& update,
                           const std::vector<MemoryElement>& elements) {
  if (epoch_ && *epoch_ != observation.epoch) broken_ = true;
  epoch_ = observation.epoch;
  const ImageAnalysis& analysis = *update.analysis;
  if (broken_ || analysis.stamp_us != observation.frame.stamp_us) return false;
  if (last_odom_) {
    way_m_ += (observation.T_odom_robot.position() - last_odom_->position()).norm();
    turned_rad_ += std::abs(angleDifference(observation.T_odom_robot.theta, last_odom_->theta));
  }
  last_odom_ = observation.T_odom_robot;
  const Pose3 T_odom_camera = toPose3(observation.T_odom_robot) * observation.T_robot_camera;
  double rate = 0.0;
  if (last_camera_ && observation.frame.stamp_us > last_stamp_us_) {
    const Eigen::AngleAxisd turn(
        Eigen::Matrix3d(last_camera_->linear().transpose() * T_odom_camera.linear()));
    rate = std::abs(turn.angle()) / toSeconds(observation.frame.stamp_us - last_stamp_us_);
  }
  last_camera_ = T_odom_camera;
  last_stamp_us_ = observation.frame.stamp_us;
  const bool due = rate <= params_.max_turn_radps && isDue(observation);
  if (due) {
    Keyframe keyframe{observation.frame.stamp_us,
                      observation.T_odom_robot,
                      observation.T_robot_camera,
                      observation.frame.intrinsics,
                      rate,
                      way_m_,
                      turned_rad_,
                      {}};
    const auto floor = GroundProjector(params_.projector)
                           .project(keyframe.intrinsics, observation.T_robot_camera, analysis.observed, rate);
    std::unordered_map<int, const FloorSegment*> floor_of;
    for (const FloorSegment& segment : floor) floor_of[segment.observed] = &segment;
    const FloorEvidence evidence(observation.frame.image, keyframe.intrinsics, params_.evidence);
    const int index = static_cast<int>(record_.keyframes.size());
    for (const ImageAnalysis::Match& match : analysis.matches) {
      const auto placed = floor_of.find(match.observed);
      if (placed == floor_of.end()) continue;
      keyframe.sightings.push_back(sightingOf(analysis, match,
                                              analysis.observed[static_cast<std::size_t>(match.observed)],
                                              evidence, *placed->second));
      ElementSummary& summary = record_.elements[keyframe.sightings.back().element];
      if (summary.sightings++ == 0) summary.first_keyframe = index;
      summary.last_keyframe = index;
    }
    record_.keyframes.push_back(std::move(keyframe));
  }
  if (!record_.keyframes.empty()) summarize(observation, elements);
  noteDropped(observation.frame.stamp_us, update.snapshot->epoch, elements);
  return due;
}

}  // namespace vismem
