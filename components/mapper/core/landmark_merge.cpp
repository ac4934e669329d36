#include "mapper/core/landmark_merge.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <vector>

#include "common/geometry/angles.h"
#include "common/geometry/plane.h"
#include "localization/core/map/visibility.h"

namespace vismem {
namespace {

/// How one landmark lies beside another, in world.
struct Beside {
  double across_m = 0.0;  ///< mean distance of the overlapping or facing part from the other's line
  double gap_m = 0.0;     ///< between the extents; < 0: they overlap
};

std::optional<Beside> beside(const Segment2& one, const Segment2& other, double angle_rad) {
  if (std::abs(angleDifference(one.direction(), other.direction())) > angle_rad) return std::nullopt;
  const Segment2& longer = one.length() >= other.length() ? one : other;
  const Segment2& shorter = one.length() >= other.length() ? other : one;
  const Eigen::Vector2d u = (longer.b - longer.a).normalized();
  const double ta = u.dot(shorter.a - longer.a);
  const double tb = u.dot(shorter.b - longer.a);
  const double low = std::max(0.0, std::min(ta, tb));
  const double high = std::min(longer.length(), std::max(ta, tb));
  // Where both have a point: in the overlap, else in the middle of the gap.
  const double t = 0.5 * (low + high);
  const double share = std::clamp((t - ta) / (tb - ta), 0.0, 1.0);
  const Eigen::Vector2d p = shorter.a + share * (shorter.b - shorter.a);
  return Beside{std::abs(cross2(u, p - longer.a)), low - high};
}

/// More where no image saw either of the two ends that face each other.
double mostGap(const LineLandmark& one, const LineLandmark& other, const MapState& state,
               const LandmarkMergeParams& params) {
  const Segment2 first = state.worldSegment(one);
  const Segment2 second = state.worldSegment(other);
  const bool is_before = (first.b - first.a).dot(second.middle() - first.middle()) > 0.0;
  const bool is_hidden = is_before ? !one.b.closed && !other.a.closed : !one.a.closed && !other.b.closed;
  if (!is_hidden || !matchesAny(one.label, params.obstacles)) return params.gap_m;
  const double share_m = params.open_gap_share * (first.length() + second.length());
  return std::clamp(share_m, params.gap_m, params.open_gap_m);
}

double acrossSigma(const LineLandmark& landmark) {
  const double half = 0.5 * (landmark.b.t_m - landmark.a.t_m);
  return std::sqrt(landmark.P_line(0, 0) + half * half * landmark.P_line(1, 1));
}

/// Whether two sightings of one image are two edges: beside each other, not end to end in one line.
bool areTwo(const Segment2& one, const Segment2& other) {
  constexpr double kBeside_px = 3.0;
  constexpr double kOverlap_px = 4.0;
  const Eigen::Vector2d u = (one.b - one.a).normalized();
  const double ta = u.dot(other.a - one.a);
  const double tb = u.dot(other.b - one.a);
  const double overlap = std::min(one.length(), std::max(ta, tb)) - std::max(0.0, std::min(ta, tb));
  return overlap > kOverlap_px || distanceToLine(other.middle(), one) > kBeside_px;
}

bool seenTogether(const DriveRecord& record, const LineLandmark& one, const LineLandmark& other) {
  std::map<int, std::vector<int>> of_one;
  for (const auto& seen : one.seen) of_one[seen.keyframe].push_back(seen.sighting);
  for (const auto& seen : other.seen) {
    const auto found = of_one.find(seen.keyframe);
    if (found == of_one.end()) continue;
    const auto& sightings = record.keyframes[static_cast<std::size_t>(seen.keyframe)].sightings;
    for (const int index : found->second) {
      // A piece of a landmark that was cut may share a sighting.
      if (index == seen.sighting) continue;
      if (areTwo(sightings[static_cast<std::size_t>(index)].px,
                 sightings[static_cast<std::size_t>(seen.sighting)].px)) {
        return true;
      }
    }
  }
  return false;
}

/// The outermost end of two, or their mean where both are closed and near.
LandmarkEnd joined(const LandmarkEnd& one, std::size_t weight_one, const LandmarkEnd& other,
                   std::size_t weight_other, double outward, double end_m) {
  const bool near = std::abs(one.t_m - other.t_m) <= end_m;
  if (near && one.closed && other.closed) {
    const auto a = static_cast<double>(weight_one);
    const auto b = static_cast<double>(weight_other);
    return {(a * one.t_m + b * other.t_m) / (a + b), true};
  }
  if (near && one.closed != other.closed) return one.closed ? one : other;
  return outward * one.t_m > outward * other.t_m ? one : other;
}

/// Adds `other` to `into`, which keeps its anchor.
void absorb(LineLandmark& into, const LineLandmark& other, const MapState& state,
            const LandmarkMergeParams& params) {
  const Pose2 T_into_other = inverse(state.poses[static_cast<std::size_t>(into.anchor)]) *
                             state.poses[static_cast<std::size_t>(other.anchor)];
  const Segment2 moved = transform(T_into_other, other.segment());
  const Eigen::Vector2d u = into.along();
  const Eigen::Vector2d origin = into.pointAt(0.0);
  const LandmarkEnd a{u.dot(moved.a - origin), other.a.closed};
  const LandmarkEnd b{u.dot(moved.b - origin), other.b.closed};
  into.a = joined(into.a, into.seen.size(), a, other.seen.size(), -1.0, params.end_m);
  into.b = joined(into.b, into.seen.size(), b, other.seen.size(), 1.0, params.end_m);
  into.id = std::min(into.id, other.id);
  into.elements.insert(into.elements.end(), other.elements.begin(), other.elements.end());
  into.seen.insert(into.seen.end(), other.seen.begin(), other.seen.end());
  std::sort(into.seen.begin(), into.seen.end(), [](const auto& x, const auto& y) {
    return x.keyframe != y.keyframe ? x.keyframe < y.keyframe : x.sighting < y.sighting;
  });
  into.seen.erase(std::unique(into.seen.begin(), into.seen.end(),
                              [](const auto& x, const auto& y) {
                                return x.keyframe == y.keyframe && x.sighting == y.sighting;
                              }),
                  into.seen.end());
  into.dropped = into.dropped && other.dropped;
  into.recentre();
}

/// Whether all views of one lie further than a way from all views of the other.
bool areOtherVisits(const DriveRecord& record, const LineLandmark& one, const LineLandmark& other,
                    double apart_m) {
  return std::none_of(one.seen.begin(), one.seen.end(), [&](const auto& seen) {
    return std::any_of(other.seen.begin(), other.seen.end(), [&](const auto& each) {
      return std::abs(wayAt(record, seen) - wayAt(record, each)) <= apart_m;
    });
  });
}

bool areOne(const DriveRecord& record, const LineLandmark& one, const LineLandmark& other,
            const MapState& state, const LandmarkMergeParams& params) {
  if (one.label != other.label) return false;
  const auto near = beside(state.worldSegment(one), state.worldSegment(other), params.angle_rad);
  if (!near || near->gap_m > mostGap(one, other, state, params)) return false;
  const double sigma = std::hypot(acrossSigma(one), acrossSigma(other));
  const double gate = std::min(params.most_across_m, std::max(params.across_m, params.sigmas * sigma));
  return near->across_m <= gate && !seenTogether(record, one, other);
}

}  // namespace

int mergeLandmarks(const DriveRecord& record, const LandmarkMergeParams& params, MapState& state) {
  int merges = 0;
  for (std::size_t i = 0; i < state.landmarks.size(); ++i) {
    for (std::size_t j = i + 1; j < state.landmarks.size();) {
      if (!areOne(record, state.landmarks[i], state.landmarks[j], state, params)) {
        ++j;
        continue;
      }
      // The one that was seen more often keeps its anchor.
      LineLandmark& kept = state.landmarks[i];
      LineLandmark& other = state.landmarks[j];
      if (other.seen.size() > kept.seen.size()) std::swap(kept, other);
      absorb(kept, other, state, params);
      state.landmarks.erase(state.landmarks.begin() + static_cast<std::ptrdiff_t>(j));
      ++merges;
      j = i + 1;  // the longer one may now touch others
    }
  }
  return merges;
}

std::optional<EdgesTwice> edgesTwice(const DriveRecord& record, const EdgesTwiceParams& params,
                                     const MapState& state) {
  EdgesTwice found;
  for (std::size_t i = 0; i < state.landmarks.size(); ++i) {
    const LineLandmark& one = state.landmarks[i];
    for (std::size_t j = i + 1; j < state.landmarks.size(); ++j) {
      const LineLandmark& other = state.landmarks[j];
      if (one.label != other.label || one.isChord() || other.isChord()) continue;
      const Segment2 world = state.worldSegment(one);
      const auto near = beside(world, state.worldSegment(other), params.angle_rad);
      if (!near || -near->gap_m < params.least_m) continue;
      if (near->across_m < params.least_across_m || near->across_m > params.most_across_m) continue;
      if (!areOtherVisits(record, one, other, params.apart_m)) continue;
      ++found.edges;
      found.length_m -= near->gap_m;
      if (near->across_m <= found.across_m) continue;
      found.across_m = near->across_m;
      found.world = world.middle();
    }
  }
  if (found.edges < params.least_edges) return std::nullopt;
  return found;
}

}  // namespace vismem
