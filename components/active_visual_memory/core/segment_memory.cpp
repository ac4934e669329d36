#include "active_visual_memory/core/segment_memory.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "active_visual_memory/core/floor_matching.h"
#include "active_visual_memory/core/segment_memory_view.h"
#include "common/geometry/angles.h"
#include "common/geometry/projection.h"

namespace vismem {

namespace {

/// What one pixel covers of the floor across a segment [m].
double pixelAcross(const FloorSegment& segment, const Eigen::Vector2d& camera, double height_m,
                   double focal_px) {
  const Eigen::Vector2d ray = segment.odom.middle() - camera;
  const Eigen::Vector2d along = (segment.odom.b - segment.odom.a).normalized();
  const double squared = ray.squaredNorm() + height_m * height_m;
  const double across_ray = std::sqrt(squared) / focal_px;
  const double along_ray = squared / (height_m * focal_px);
  const Eigen::Vector2d u = ray.normalized();
  return std::hypot(along_ray * (u.x() * along.y() - u.y() * along.x()), across_ray * u.dot(along));
}

}  // namespace

SegmentMemory::SegmentMemory(const Params& params)
    : params_(params),
      clock_(params.life.tick_us),
      drift_(params.align ? DriftAlignment(params.lean) : DriftAlignment()),
      joint_(params.lean) {}

void SegmentMemory::clear() {
  elements_.clear();
  clock_.reset();
  last_pose_.reset();
  drift_.reset();
  joint_.reset();
  slips_.reset();
  course_rad_.reset();
}

void SegmentMemory::travel(const Pose2& T_odom_robot) {
  if (last_pose_) {
    travel_m_ += (T_odom_robot.position() - last_pose_->position()).norm();
    turn_rad_ += std::abs(angleDifference(T_odom_robot.theta, last_pose_->theta));
    if (joint()) {
      moveAll(joint_.travel(*last_pose_, T_odom_robot, jointParams()));
    } else if (params_.align) {
      moveAll(drift_.travel(*last_pose_, T_odom_robot, params_.alignment));
    }
  }
  last_pose_ = T_odom_robot;
}

std::vector<int> SegmentMemory::cache(const Pose2& T_odom_robot) const {
  std::vector<int> near;
  for (int i = 0; i < static_cast<int>(elements_.size()); ++i) {
    if (distanceToSegment(T_odom_robot.position(), elements_[i].line.segment()) <= params_.cache_radius_m) {
      near.push_back(i);
    }
  }
  return near;
}

std::vector<Expectation> SegmentMemory::expect(const View& view, std::vector<int>& index_of) const {
  std::vector<Expectation> expected;
  for (const int i : cache(view.observation.T_odom_robot)) {
    const MemoryElement& element = elements_[i];
    const auto px = projectSegment(view.observation.frame.intrinsics, view.T_odom_camera, element.value.odom);
    if (!px || px->length() < params_.min_visible_px) continue;
    expected.push_back({{element.value.id, *px, element.value.label}, element.strength});
    index_of.push_back(i);
  }
  return expected;
}

bool SegmentMemory::fitsOnFloor(const MemoryElement& element, const FloorSegment& observed,
                                double distance_m) const {
  if (params_.fusion == Fusion::kChapter) return true;  // the newer one is believed, wherever it is
  const double unseen_m = params_.drift_per_m * (travel_m_ - element.seen_travel_m);
  const double unseen_rad = params_.drift_per_rad * (turn_rad_ - element.seen_turn_rad);
  const double slack =
      params_.slack_m + params_.slack_share * distance_m + unseen_m + unseen_rad * distance_m;
  const double gate = params_.gate_sigmas;
  if (joint() && joint_.knows(element.value.id)) {
    // What the line may be off against the robot is known with the line.
    const auto more = [&](const Eigen::Vector2d& p) {
      return joint_.placeVariance(element.value.id, element.line.normal(), p) -
             element.line.offsetVariance(element.line.tOf(p));
    };
    const double drift = std::max({0.0, more(observed.odom.a), more(observed.odom.b)});
    const double least = params_.slack_m + params_.slack_share * distance_m;
    return element.line.disagreement(observed, std::hypot(least, std::sqrt(drift)), leanCovariance()) <=
           gate * gate;
  }
  return element.line.disagreement(observed, slack, leanCovariance()) <= gate * gate;
}

void SegmentMemory::confirm(MemoryElement& element, const FloorSegment& observed, const View& view) {
  // What was only ever seen along the viewing ray may still turn out to stand.
  if (!params_.confirm_by_parallax || (element.on_floor && element.not_vertical)) return;
  const bool stale = turn_rad_ - element.anchor_turn_rad > params_.max_anchor_turn_rad ||
                     (view.camera - element.anchor_camera).norm() > params_.max_anchor_travel_m;
  if (stale) {
    // Odometry has drifted too far for a comparison with the old place.
    element.parallax = ParallaxEstimate{};
    element.anchor_line = FloorLine(observed, params_.line);
    element.anchor_camera = view.camera;
    element.anchor_turn_rad = turn_rad_;
  }
  if ((view.camera - element.anchor_camera).norm() < params_.parallax.min_step_m) {
    // From one place the anchor gets better with every view, and there is no parallax yet.
    element.anchor_line = element.line;
    element.parallax = ParallaxEstimate{};
  }
  const FloorLine& anchor = element.anchor_line;
  const Eigen::Vector2d baseline = view.camera - element.anchor_camera;
  const double along = anchor.along().dot(baseline);
  const double across = anchor.normal().dot(baseline);
  const double distance = (observed.odom.middle() - view.camera).norm();
  // An aligned memory has only the errors of the alignment, which do not grow with the way.
  const double drift = params_.align
                           ? params_.aligned_m + params_.aligned_rad * distance
                           : params_.drift_per_rad * (turn_rad_ - element.anchor_turn_rad) * distance;
  const auto add = [&](ParallaxEstimate::Channel channel, double b, double shift, const LeanRow& d_lean,
                       double variance) {
    element.parallax.add(channel, b, shift, d_lean, variance + drift * drift, params_.parallax);
  };
  // A constant error of the anchor's place does not matter, one of its direction does.
  const Eigen::Vector2d middle = observed.odom.middle();
  const Eigen::Vector2d n = anchor.normal();
  // A standing edge turns about its foot: how much shows at its far end.
  const bool b_is_far = (observed.odom.b - view.camera).norm() > (observed.odom.a - view.camera).norm();
  const Eigen::Vector2d at = element.not_vertical ? middle : (b_is_far ? observed.odom.b : observed.odom.a);
  const double t = anchor.tOf(at);
  const double share = params_.parallax_noise_share;
  const double f = (at - observed.odom.a).norm() / std::max(1e-6, observed.odom.length());
  const LeanRow d_at = n.transpose() * ((1.0 - f) * observed.D_a + f * observed.D_b);
  add(ParallaxEstimate::kOffset, across, anchor.offsetOf(at), d_at - anchor.offsetLean(t),
      0.25 * share * n.dot((observed.P_a + observed.P_b) * n) + anchor.turnVariance(t));
  // The places of the ends, as long as they are the ends that were seen before.
  const Eigen::Vector2d u = anchor.along();
  const auto addEnd = [&](ParallaxEstimate::Channel channel, const Eigen::Vector2d& p,
                          const Eigen::Matrix2d& P, const FloorLean& D, bool open, const ExtentEnd& known) {
    if (open || known.open) return;
    const double variance = u.dot(P * u);
    const double gate = std::max(params_.line.end_gate_m,
                                 params_.line.end_gate_sigmas * std::sqrt(variance + known.variance_m2));
    const double off = element.line.tOf(p) - known.t_m;
    if (std::abs(off) > gate) {
      const bool outside = channel == ParallaxEstimate::kEndA ? off < 0.0 : off > 0.0;
      if (outside) element.parallax.forget(channel);  // the old end was none
      return;
    }
    add(channel, along, anchor.tOf(p), u.transpose() * D, share * variance);
  };
  addEnd(ParallaxEstimate::kEndA, observed.odom.a, observed.P_a, observed.D_a, observed.open_a,
         element.line.endA());
  addEnd(ParallaxEstimate::kEndB, observed.odom.b, observed.P_b, observed.D_b, observed.open_b,
         element.line.endB());
  // The image of a vertical edge lies on a ray from the point below the camera, wherever the camera is.
  const Eigen::Vector2d ray = (middle - view.camera).normalized();
  const Eigen::Vector2d seen_along = (observed.odom.b - observed.odom.a).normalized();
  if (std::abs(ray.x() * seen_along.y() - ray.y() * seen_along.x()) > params_.not_radial) {
    element.not_vertical = true;
  }
  const auto verdict =
      element.parallax.verdict(view.height, element.not_vertical, leanCovariance(), params_.parallax);
  element.stands = verdict == ParallaxEstimate::Verdict::kOffFloor;
  if (verdict == ParallaxEstimate::Verdict::kOnFloor) element.on_floor = true;
  if (verdict == ParallaxEstimate::Verdict::kOffFloor) element.on_floor = false;
}

void SegmentMemory::take(MemoryElement& element, const FloorSegment& seen, const View& view) {
  const bool against = element.line.along().dot(seen.odom.b - seen.odom.a) < 0.0;
  const FloorSegment observed = against ? reversed(seen) : seen;
  const double travelled = travel_m_ - element.seen_travel_m;
  const double turned = turn_rad_ - element.seen_turn_rad;
  const bool jointly = joint() && joint_.knows(element.value.id);
  if (jointly) {
    element.seen_travel_m = travel_m_;
    element.seen_turn_rad = turn_rad_;
  } else if (travelled > 0.0 || turned > 0.0) {
    const double range = (observed.odom.middle() - view.camera).norm();
    double heading = params_.drift_per_rad * turned;
    double offset = std::hypot(params_.drift_per_m * travelled, heading * range);
    if (sways()) {
      // The whole memory has followed the drift already: what is left is what is not known of that. It is
      // believed as little as the sway that was found with it.
      const double left = drift_.sigmaAt(range);
      const double shift = drift_.sigmaAt(0.0);
      const double turn = std::sqrt(std::max(0.0, left * left - shift * shift)) / std::max(range, 1e-3);
      offset = std::min(offset,
                        params_.sway_doubt * std::max(left, params_.aligned_m + params_.aligned_rad * range));
      heading = std::min(heading, params_.sway_doubt * std::max(turn, params_.aligned_rad));
    }
    element.line.drift(offset, heading);
    element.seen_travel_m = travel_m_;
    element.seen_turn_rad = turn_rad_;
  }
  element.pixel_m = std::min(
      element.pixel_m, pixelAcross(observed, view.camera, view.height, view.observation.frame.intrinsics.fx));
  confirm(element, observed, view);
  if (params_.fusion == Fusion::kChapter) {
    element.line.replaceKeepingExtent(observed, params_.line);
  } else if (jointly) {
    element.line.fuseExtent(observed, params_.line);
  } else {
    element.line.fuse(observed, params_.line);
  }
  // A short piece tells little of the whole: it may be another edge in its line.
  const double part = std::min(1.0, observed.odom.length() / std::max(1e-6, element.line.length()));
  element.strength += 0.2 * part * (observed.strength - element.strength);
  vote(element, observed.label, (observed.odom.middle() - view.camera).norm());
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
  element.value.label = element.votes.winner(params_.label_share);
}

void SegmentMemory::begin(const FloorSegment& observed, const View& view) {
  MemoryElement element;
  element.value.id = next_id_++;
  element.value.label = observed.label;
  element.value.life = params_.life.initial;
  element.value.first_seen_us = element.value.last_seen_us = view.observation.frame.stamp_us;
  element.on_floor = !params_.confirm_by_parallax;
  vote(element, observed.label, (observed.odom.middle() - view.camera).norm());
  element.line = FloorLine(observed, params_.line);
  element.strength = observed.strength;
  element.pixel_m = pixelAcross(observed, view.camera, view.height, view.observation.frame.intrinsics.fx);
  element.sightings = 1;
  element.anchor_line = element.line;
  element.anchor_camera = view.camera;
  element.anchor_turn_rad = turn_rad_;
  element.seen_travel_m = travel_m_;
  element.seen_turn_rad = turn_rad_;
  confirm(element, observed, view);
  publish(element);
  look(element, view);
  if (joint()) {
    const double distance = (observed.odom.middle() - view.camera).norm();
    joint_.begin(element.value.id, observed, {view.T_odom_camera, view.observation.T_odom_robot.theta},
                 params_.align_noise * params_.align_noise, params_.slack_m + params_.slack_share * distance);
  }
  elements_.push_back(std::move(element));
}

void SegmentMemory::look(MemoryElement& element, const View& view) const {
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

bool SegmentMemory::isWellKnown(const MemoryElement& element, StampUs stamp_us) const {
  return !onTrial(element) && element.value.confirmed && !isNewHere(element, stamp_us) &&
         toSeconds(stamp_us - element.value.last_seen_us) <= params_.well_known_s &&
         travel_m_ - element.seen_travel_m <= params_.well_known_travel_m;
}

Sighting SegmentMemory::judgeUnobserved(MemoryElement& element, const Segment2& px, const View& view) {
  Sighting sighting = Sighting::kOutOfView;
  const auto& k = view.observation.frame.intrinsics;
  const double m = params_.view_margin_px;
  const auto inside = clipToBox(px, {m, m}, {k.width - 1 - m, k.height - 1 - m});
  const bool clear = inside && inside->length() >= params_.min_visible_px;
  if (clear && onTrial(element)) {
    // What was hardly ever seen needs no evidence against it.
    sighting = Sighting::kAbsent;
  } else if (clear && element.colours && view.turn_rate <= params_.max_absence_turn_radps) {
    switch (view.evidence.look(*inside, *element.colours)) {
      case PlaceShows::kBare:
        sighting = Sighting::kAbsent;
        break;
      case PlaceShows::kSomething:
        sighting = Sighting::kCovered;
        break;
      case PlaceShows::kUnknown:
        break;
    }
  }
  // Several images may fall into one tick of life; the best of them counts.
  element.sighting = std::max(element.sighting, sighting);
  return sighting;
}

ImageAnalysis SegmentMemory::update(const RobotObservation& observation,
                                    const std::vector<ImageSegment>& observed,
                                    std::vector<FloorSegment> floor, double turn_rate_radps) {
  travel(observation.T_odom_robot);
  const Pose3 T_odom_camera = toPose3(observation.T_odom_robot) * observation.T_robot_camera;
  View view{observation,
            T_odom_camera,
            T_odom_camera.translation().head<2>(),
            T_odom_camera.translation().z(),
            turn_rate_radps,
            {observation.frame.image, observation.frame.intrinsics, params_.evidence}};

  camera_height_m_ = view.height;
  if (joint()) forgetLines();

  // An end that something hides is no end.
  for (FloorSegment& segment : floor) {
    const Segment2& px = observed[static_cast<std::size_t>(segment.observed)].px;
    segment.open_a = segment.open_a || view.evidence.isHiddenBeyond(px, false);
    segment.open_b = segment.open_b || view.evidence.isHiddenBeyond(px, true);
  }
  if (joint()) followSlip(view, floor);
  // A body that sways puts what it sees pixels beside where it is expected, and what then meets nothing would
  // be remembered once more.
  Meeting meeting = sways() ? meetSwaying(view, observed, floor) : meet(view, observed, floor, floor);
  const auto& expected = meeting.expected;
  const auto& index_of = meeting.index_of;
  const auto& seen = meeting.seen;

  ImageAnalysis analysis;
  analysis.stamp_us = observation.frame.stamp_us;
  analysis.frame_seq = observation.frame.seq;
  analysis.intrinsics = observation.frame.intrinsics;
  analysis.T_odom_robot = observation.T_odom_robot;
  analysis.T_robot_camera = observation.T_robot_camera;
  analysis.observed = observed;
  for (const Expectation& e : expected) analysis.predicted.push_back(e.predicted);

  analysis.matches = meeting.matches;

  if (params_.align) {
    alignTo(meeting, floor, view);
    // What the camera's sway seemed to bring nearer lies beyond the range after all.
    for (FloorSegment& segment : floor) {
      const double far =
          std::max((segment.odom.a - view.camera).norm(), (segment.odom.b - view.camera).norm());
      if (far > params_.range_slack * params_.max_range_m) {
        cutToRange(segment, view.camera, params_.max_range_m);
      }
    }
  }

  agreement_ = {};
  for (std::size_t p = 0; p < expected.size(); ++p) {
    MemoryElement& element = elements_[index_of[p]];
    // While the camera turns nothing can be judged absent, so what is found tells nothing either.
    const bool tells =
        turn_rate_radps <= params_.max_absence_turn_radps && isWellKnown(element, analysis.stamp_us);
    if (seen[p].empty()) {
      const Sighting sighting = judgeUnobserved(element, expected[p].predicted.px, view);
      if (tells && sighting == Sighting::kAbsent) ++agreement_.absent;
      if (tells && sighting == Sighting::kCovered) ++agreement_.covered;
      continue;
    }
    if (tells) ++agreement_.matched;
    if (isNewHere(element, analysis.stamp_us)) ++agreement_.fresh;
    for (const FloorSegment* piece : seen[p]) take(element, *piece, view);
    if (params_.fusion == Fusion::kCovariance) {
      reviewEnds(element, seen[p], floor, view);
      reviewGaps(element, seen[p], observed, view);
    }
    publish(element);
    look(element, view);
  }
  std::vector<bool> expected_now(elements_.size(), false);
  for (const int i : index_of) expected_now[i] = true;
  for (std::size_t i = 0; i < elements_.size(); ++i) {
    if (!expected_now[i]) elements_[i].sighting = std::max(elements_[i].sighting, Sighting::kOutOfView);
  }

  std::move(parted_.begin(), parted_.end(), std::back_inserter(elements_));
  parted_.clear();

  // Unpredicted: near something stored on the floor (M3), else new (M2 first).
  if (turn_rate_radps <= params_.max_mapping_turn_radps) {
    std::vector<FloorSegment> fresh;
    for (const FloorSegment& segment : floor) {
      if (!meeting.used[segment.observed]) fresh.push_back(segment);
    }
    fresh = cleanDuplicates(fresh, 0.5 * params_.near_angle_rad, 0.5 * params_.near_distance_m,
                            0.5 * params_.max_gap_m);
    for (const FloorSegment& segment : fresh) {
      const double distance = (segment.odom.middle() - view.camera).norm();
      const double reach = params_.near_distance_m + params_.far_distance_share * distance;
      MemoryElement* best = nullptr;
      double best_distance = reach;
      for (const int i : cache(observation.T_odom_robot)) {
        MemoryElement& element = elements_[i];
        if (!labelsCompatible(element.value.label, segment.label)) continue;
        const Segment2 stored = element.line.segment();
        if (!samePolarity(stored, element.strength, segment.odom, segment.strength)) continue;
        const Neighbourhood near = neighbourhood(stored, segment.odom);
        if (near.angle_rad > params_.near_angle_rad || near.gap_m > params_.max_gap_m) continue;
        if (near.distance_m > best_distance || !fitsOnFloor(element, segment, distance)) continue;
        if (arePartedFrom(element.line, FloorLine(segment, params_.line))) continue;
        best_distance = near.distance_m;
        best = &element;
      }
      if (best) {
        take(*best, segment, view);
      } else {
        begin(segment, view);
        ++agreement_.fresh;
      }
    }
    const std::vector<int> cached = cache(observation.T_odom_robot);
    keepParted(cached);
    mergeDuplicates(cached);
  }
  countLife(observation.frame.stamp_us);
  publishAll();
  return analysis;
}

}  // namespace vismem
