#include "active_visual_memory/core/memory/segment_memory.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "active_visual_memory/core/memory/duplicates.h"
#include "active_visual_memory/core/memory/segment_memory_view.h"
#include "common/geometry/angles.h"
#include "common/geometry/plane.h"
#include "common/geometry/projection.h"
#include "common/visual_memory/labels.h"

namespace vismem {

namespace {

/// Floor distance of one pixel across a segment [m].
double pixelAcross(const FloorSegment& segment, const Eigen::Vector2d& camera, double height_m,
                   double focal_px) {
  const Eigen::Vector2d ray = segment.odom().middle() - camera;
  const Eigen::Vector2d along = (segment.b.p - segment.a.p).normalized();
  const double squared = ray.squaredNorm() + height_m * height_m;
  const double across_ray = std::sqrt(squared) / focal_px;
  const double along_ray = squared / (height_m * focal_px);
  const Eigen::Vector2d u = ray.normalized();
  return std::hypot(along_ray * cross2(u, along), across_ray * u.dot(along));
}

/// An end at an occluder is censored.
void censorHiddenEnds(std::vector<FloorSegment>& floor, const std::vector<ImageSegment>& observed,
                      const FloorEvidence& evidence) {
  for (FloorSegment& segment : floor) {
    const Segment2& px = observed[static_cast<std::size_t>(segment.observed)].px;
    segment.a.censored = segment.a.censored || evidence.isHiddenBeyond(px, false);
    segment.b.censored = segment.b.censored || evidence.isHiddenBeyond(px, true);
  }
}

void analyse(const RobotObservation& observation, const std::vector<ImageSegment>& observed,
             std::span<const Expectation> expected, std::span<const ImageAnalysis::Match> matches,
             ImageAnalysis& analysis) {
  analysis.stamp_us = observation.frame.stamp_us;
  analysis.frame_seq = observation.frame.seq;
  analysis.intrinsics = observation.frame.intrinsics;
  analysis.T_odom_robot = observation.T_odom_robot;
  analysis.T_robot_camera = observation.T_robot_camera;
  // An assignment reserves no more than it needs: it would allocate again in each image with one more.
  analysis.observed.reserve(std::bit_ceil(observed.size()));
  analysis.predicted.reserve(std::bit_ceil(expected.size()));
  analysis.matches.reserve(std::bit_ceil(matches.size()));
  analysis.observed = observed;
  analysis.predicted.clear();
  for (const Expectation& e : expected) analysis.predicted.push_back(e.predicted);
  analysis.matches.assign(matches.begin(), matches.end());
}

}  // namespace

SegmentMemory::SegmentMemory(const Params& params)
    : params_(params),
      clock_(params.retention.life.tick_us),
      map_filter_(params.estimation.enabled ? params.estimation.tilt_prior : TiltPrior{0.0, 0.0, 0.0}) {
  params_.estimation.map_filter.together_rad = params.estimation.dominant_direction.together_rad;
  residuals_.reserve(MapFilter::kMaxResiduals + kResidualsPerPiece);
}

void SegmentMemory::clear() {
  elements_.clear();
  clock_.reset();
  last_pose_.reset();
  map_filter_.reset();
  dominant_direction_rad_.reset();
}

void SegmentMemory::predict(const Pose2& T_odom_robot) {
  if (last_pose_) {
    travel_m_ += (T_odom_robot.position() - last_pose_->position()).norm();
    turn_rad_ += std::abs(angleDifference(T_odom_robot.theta, last_pose_->theta));
    if (params_.estimation.enabled)
      transformAll(map_filter_.predict(*last_pose_, T_odom_robot, params_.estimation.map_filter));
  }
  last_pose_ = T_odom_robot;
}

bool SegmentMemory::isCached(const MemoryElement& element, const Pose2& T_odom_robot) const {
  return distanceToSegment(T_odom_robot.position(), element.line.segment()) <= params_.gates.cache_radius_m;
}

std::pmr::vector<int> SegmentMemory::cache(const Pose2& T_odom_robot) const {
  std::pmr::vector<int> near(scratch_.resource());
  near.reserve(elements_.size());
  for (int i = 0; i < static_cast<int>(elements_.size()); ++i) {
    if (isCached(elements_[i], T_odom_robot)) near.push_back(i);
  }
  return near;
}

void SegmentMemory::expect(const View& view, Associations& associations) const {
  for (const int i : cache(view.observation.T_odom_robot)) {
    const MemoryElement& element = elements_[i];
    const auto px = projectSegment(view.observation.frame.intrinsics, view.T_odom_camera, element.value.odom);
    if (!px || px->length() < kMinVisible_px) continue;
    associations.expected.push_back(
        {{element.value.id, *px, element.value.label, element.plane.stands}, element.strength});
    associations.index_of.push_back(i);
  }
}

bool SegmentMemory::fitsOnFloor(const MemoryElement& element, const FloorSegment& observed,
                                double distance_m) const {
  if (params_.fusion == Fusion::kChapter) return true;  // the chapter fuses without a gate
  const double unseen_m = params_.gates.drift_per_m * (travel_m_ - element.seen_travel_m);
  const double unseen_rad = params_.gates.drift_per_rad * (turn_rad_ - element.seen_turn_rad);
  const double slack = params_.gates.slack_m + kSlackShare * distance_m + unseen_m + unseen_rad * distance_m;
  const double gate = kGateSigmas;
  if (inFilter(element)) {
    // The filter knows the variance of the line relative to the robot.
    const auto more = [&](const Eigen::Vector2d& p) {
      return map_filter_.placeVariance(element.value.id, element.line.normal(), p) -
             element.line.offsetVariance(element.line.tOf(p));
    };
    const double drift = std::max({0.0, more(observed.a.p), more(observed.b.p)});
    const double least = params_.gates.slack_m + kSlackShare * distance_m;
    return element.line.disagreement(observed, std::hypot(least, std::sqrt(drift)), cameraTiltCovariance()) <=
           gate * gate;
  }
  return element.line.disagreement(observed, slack, cameraTiltCovariance()) <= gate * gate;
}

PlaneView SegmentMemory::planeView(const View& view) const {
  return {view.camera, view.height, cameraTiltCovariance(), view.P_frame_tilt};
}

void SegmentMemory::observePlane(MemoryElement& element, const FloorSegment& observed,
                                 const View& view) const {
  if (!params_.confirmation.by_parallax) return;
  element.plane.observe(element.line, observed, planeView(view), params_.confirmation.parallax, params_.line);
}

void SegmentMemory::fuse(MemoryElement& element, const FloorSegment& seen, const View& view) {
  const FloorSegment observed = runningAlong(element.line.along(), seen);
  const double travelled = travel_m_ - element.seen_travel_m;
  const double turned = turn_rad_ - element.seen_turn_rad;
  const bool in_filter = inFilter(element);
  if (!in_filter && (travelled > 0.0 || turned > 0.0)) {
    const double range = view.distanceTo(observed);
    const double heading = params_.gates.drift_per_rad * turned;
    element.line.drift(std::hypot(params_.gates.drift_per_m * travelled, heading * range), heading);
  }
  element.seen_travel_m = travel_m_;
  element.seen_turn_rad = turn_rad_;
  element.pixel_m = std::min(
      element.pixel_m, pixelAcross(observed, view.camera, view.height, view.observation.frame.intrinsics.fx));
  observePlane(element, observed, view);
  if (params_.fusion == Fusion::kChapter) {
    element.line.replaceKeepingExtent(observed, params_.line);
  } else {
    if (!in_filter) element.line.fuseLine(observed, params_.line);
    // A piece in line may belong to another edge, such as a joint of tiles behind paint: only the landmark's
    // own label shows how far it extends.
    const bool same_edge = element.value.label == kUnknownLabel || observed.label == element.value.label;
    if (same_edge) element.line.fuseExtent(observed, params_.line);
  }
  // A short piece is weak evidence for the whole: it may be another edge in its line.
  const double part = std::min(1.0, observed.odom().length() / std::max(1e-6, element.line.length()));
  element.strength += 0.2 * part * (observed.strength - element.strength);
  vote(element, observed.label, view.distanceTo(observed));
  // Several pieces in one image are one sighting.
  if (element.value.last_seen_us != view.observation.frame.stamp_us) ++element.sightings;
  element.value.last_seen_us = view.observation.frame.stamp_us;
  element.sighting = Sighting::kObserved;
}

void SegmentMemory::vote(MemoryElement& element, const Label& label, double distance_m) const {
  if (params_.fusion == Fusion::kChapter) {
    if (element.value.label == kUnknownLabel) element.value.label = label;
    return;
  }
  const double weight = 1.0 / std::max(0.25, distance_m * distance_m);
  element.votes.add(label, weight);
  element.value.label = element.votes.winner(kLabelShare);
}

void SegmentMemory::addElement(const FloorSegment& observed, const View& view) {
  MemoryElement element;
  element.value.id = next_id_++;
  element.value.label = observed.label;
  element.value.life = params_.retention.life.initial;
  element.value.first_seen_us = element.value.last_seen_us = view.observation.frame.stamp_us;
  element.plane.on_floor = !params_.confirmation.by_parallax;
  vote(element, observed.label, view.distanceTo(observed));
  element.line = FloorLine(observed, params_.line);
  element.strength = observed.strength;
  element.pixel_m = pixelAcross(observed, view.camera, view.height, view.observation.frame.intrinsics.fx);
  element.sightings = 1;
  element.plane.begin(element.line, planeView(view));
  element.seen_travel_m = travel_m_;
  element.seen_turn_rad = turn_rad_;
  observePlane(element, observed, view);
  publish(element);
  updateColours(element, view);
  if (params_.estimation.enabled) {
    const double distance = view.distanceTo(observed);
    map_filter_.addLine(element.value.id, observed, {view.T_odom_camera, view.observation.T_odom_robot.theta},
                        kCorrelationInflation * kCorrelationInflation,
                        params_.gates.slack_m + kSlackShare * distance);
  }
  elements_.push_back(std::move(element));
}

void SegmentMemory::updateColours(MemoryElement& element, const View& view) const {
  const auto px = projectSegment(view.observation.frame.intrinsics, view.T_odom_camera, element.value.odom);
  const auto sides = px ? view.evidence.sides(*px) : std::nullopt;
  if (!sides) return;
  if (!element.colours) {
    element.colours = *sides;
    return;
  }
  element.colours->left += 0.2 * (sides->left - element.colours->left);
  element.colours->right += 0.2 * (sides->right - element.colours->right);
}

bool SegmentMemory::isNewHere(const MemoryElement& element, StampUs stamp_us) const {
  return toSeconds(stamp_us - element.value.first_seen_us) < kNew_s ||
         (suspect_since_us_ && element.value.first_seen_us > *suspect_since_us_);
}

bool SegmentMemory::isWellKnown(const MemoryElement& element, StampUs stamp_us) const {
  return !isTentative(element) && element.value.confirmed && !isNewHere(element, stamp_us) &&
         toSeconds(stamp_us - element.value.last_seen_us) <= kWellKnown_s &&
         travel_m_ - element.seen_travel_m <= kWellKnownTravel_m;
}

Sighting SegmentMemory::judgeUnobserved(MemoryElement& element, const Segment2& px,
                                        const std::vector<FloorSegment>& floor, const View& view) {
  Sighting sighting = Sighting::kOutOfView;
  const auto& k = view.observation.frame.intrinsics;
  const double m = kViewMargin_px;
  const auto inside = clipToBox(px, {m, m}, {k.width - 1 - m, k.height - 1 - m});
  const bool clear = inside && inside->length() >= kMinVisible_px;
  if (clear && (!element.plane.on_floor || isOfAnotherKind(element.line.segment(), element, floor))) {
    // What is not known to rest needs no evidence of absence: it may have moved away. An edge of another
    // label in its place is evidence enough.
    sighting = Sighting::kAbsent;
  } else if (clear && element.colours && view.turn_rate <= params_.gates.max_absence_turn_radps) {
    switch (view.evidence.classify(*inside, *element.colours)) {
      case PlaceShows::kFree:
        sighting = Sighting::kAbsent;
        break;
      case PlaceShows::kOccluded:
        sighting = Sighting::kOccluded;
        break;
      case PlaceShows::kUnknown:
        break;
    }
  }
  if (sighting == Sighting::kAbsent && params_.confirmation.by_parallax &&
      element.value.life < kContradictedShare * params_.retention.life.maximum)
    element.plane.contradict();
  // Several images may fall into one tick of life; the best of them counts.
  element.sighting = std::max(element.sighting, sighting);
  return sighting;
}

const ImageAnalysis& SegmentMemory::update(const RobotObservation& observation,
                                           const std::vector<ImageSegment>& observed,
                                           std::span<const FloorSegment> observed_floor,
                                           double turn_rate_radps) {
  scratch_.release();
  std::vector<FloorSegment>& floor = floor_;
  floor.assign(observed_floor.begin(), observed_floor.end());
  predict(observation.T_odom_robot);
  View view = viewOf(observation, turn_rate_radps);
  censorHiddenEnds(floor, observed, view.evidence);
  if (params_.estimation.enabled) removeStaleLines();
  const Associations associations = associate(view, observed, floor);
  analyse(observation, observed, associations.expected, associations.matches, analysis_);
  correct(associations, floor, view);
  updateExpected(associations, floor, view);
  insert(associations, floor, view);
  split(associations, observed, view);
  merge(view);
  age(observation.frame.stamp_us);
  publishAll();
  return analysis_;
}

SegmentMemory::View SegmentMemory::viewOf(const RobotObservation& observation, double turn_rate_radps) {
  const Pose3 T_odom_camera = toPose3(observation.T_odom_robot) * observation.T_robot_camera;
  camera_height_m_ = T_odom_camera.translation().z();
  return {observation,
          T_odom_camera,
          T_odom_camera.translation().head<2>(),
          camera_height_m_,
          turn_rate_radps,
          {observation.frame.image, observation.frame.intrinsics, params_.evidence}};
}

void SegmentMemory::updateExpected(const Associations& associations, const std::vector<FloorSegment>& floor,
                                   const View& view) {
  const StampUs stamp_us = view.observation.frame.stamp_us;
  agreement_ = {};
  for (std::size_t p = 0; p < associations.expected.size(); ++p) {
    MemoryElement& element = elements_[associations.index_of[p]];
    const auto& pieces = associations.seen[p];
    // Absence is not judged while the camera turns, so matches are no evidence either.
    const bool informative =
        view.turn_rate <= params_.gates.max_absence_turn_radps && isWellKnown(element, stamp_us);
    if (pieces.empty()) {
      const Sighting sighting = judgeUnobserved(element, associations.expected[p].predicted.px, floor, view);
      if (informative && sighting == Sighting::kAbsent) ++agreement_.absent;
      if (informative && sighting == Sighting::kOccluded) ++agreement_.occluded;
      continue;
    }
    if (informative) ++agreement_.matched;
    if (isNewHere(element, stamp_us)) ++agreement_.fresh;
    for (const FloorSegment* piece : pieces) fuse(element, *piece, view);
    if (params_.fusion == Fusion::kCovariance) updateEndpoints(element, pieces, floor, view);
    publish(element);
    updateColours(element, view);
  }
  std::pmr::vector<bool> expected_now(elements_.size(), false, scratch_.resource());
  for (const int i : associations.index_of) expected_now[i] = true;
  for (std::size_t i = 0; i < elements_.size(); ++i) {
    if (!expected_now[i]) elements_[i].sighting = std::max(elements_[i].sighting, Sighting::kOutOfView);
  }
}

MemoryElement* SegmentMemory::nearest(const FloorSegment& segment, std::span<const int> cached,
                                      const View& view) {
  const double distance = view.distanceTo(segment);
  MemoryElement* best = nullptr;
  double best_distance = params_.gates.near_distance_m + kFarDistanceShare * distance;
  const Eigen::AlignedBox2d around = boxAround(segment.odom(), kMaxGap_m + best_distance);
  for (const int i : cached) {
    MemoryElement& element = elements_[i];
    const Segment2 stored = element.line.segment();
    if (!around.intersects(boxAround(stored)) || !labelsCompatible(element.value.label, segment.label))
      continue;
    if (!samePolarity(stored, element.strength, segment.odom(), segment.strength)) continue;
    const Neighbourhood near = neighbourhood(stored, segment.odom());
    if (near.gap_m > kMaxGap_m || near.distance_m > best_distance) continue;
    if (lineAngle(stored, segment.odom()) > kNearAngle_rad) continue;
    if (!fitsOnFloor(element, segment, distance)) continue;
    if (areSplit(element.line, FloorLine(segment, params_.line))) continue;
    best_distance = near.distance_m;
    best = &element;
  }
  return best;
}

void SegmentMemory::insert(const Associations& associations, const std::vector<FloorSegment>& floor,
                           const View& view) {
  if (view.turn_rate > kMaxMappingTurn_radps) return;
  std::pmr::vector<FloorSegment> fresh(scratch_.resource());
  for (const FloorSegment& segment : floor) {
    if (!associations.used[segment.observed]) fresh.push_back(segment);
  }
  fresh = cleanDuplicates(fresh, kDuplicateGateShare * kNearAngle_rad,
                          kDuplicateGateShare * params_.gates.near_distance_m,
                          kDuplicateGateShare * kMaxGap_m, scratch_.resource());
  std::pmr::vector<int> cached(scratch_.resource());
  if (!fresh.empty()) cached = cache(view.observation.T_odom_robot);
  for (const FloorSegment& segment : fresh) {
    if (MemoryElement* element = nearest(segment, cached, view)) {
      fuse(*element, segment, view);
    } else {
      addElement(segment, view);
      if (isCached(elements_.back(), view.observation.T_odom_robot))
        cached.push_back(static_cast<int>(elements_.size()) - 1);
      ++agreement_.fresh;
    }
  }
}

}  // namespace vismem
