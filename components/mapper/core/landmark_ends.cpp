#include "mapper/core/landmark_ends.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <optional>
#include <vector>

#include "common/geometry/angles.h"
#include "common/geometry/plane.h"
#include "common/geometry/projection.h"

namespace vismem {
namespace {

constexpr double kFarthest_m = 8.0;

/// The camera of a keyframe in the frame of a landmark's anchor.
Pose3 cameraIn(const MapState& state, const DriveRecord& record, int anchor, int keyframe) {
  const Pose2 T_anchor_world = inverse(state.poses[static_cast<std::size_t>(anchor)]);
  return toPose3(T_anchor_world) * cameraOf(record, state, keyframe);
}

std::optional<SeenEnd> placed(const LineLandmark& landmark, const Keyframe& keyframe,
                              const Pose3& T_anchor_camera, const LineSighting& sighting, bool at_b,
                              double along_px) {
  const Eigen::Vector2d px = at_b ? sighting.px.b : sighting.px.a;
  const Eigen::Vector2d along = (sighting.px.b - sighting.px.a).normalized();
  const auto at = backProjectToGround(keyframe.intrinsics, T_anchor_camera, px, kFarthest_m);
  const auto inwards = backProjectToGround(keyframe.intrinsics, T_anchor_camera,
                                           px + (at_b ? -along_px : along_px) * along, kFarthest_m);
  if (!at || !inwards) return std::nullopt;
  const Eigen::Vector2d u = landmark.along();
  const auto tOf = [&](const Eigen::Vector3d& p) { return u.dot(p.head<2>() - landmark.pointAt(0.0)); };
  return SeenEnd{tOf(*at), std::abs(tOf(*at) - tOf(*inwards)),
                 at_b ? sighting.censored_b : sighting.censored_a};
}

/// Which end of a sighting may lie on top of an upright edge that stands on the other one.
enum class UprightEnd { kNone, kA, kB };

UprightEnd uprightEnd(const Keyframe& keyframe, const Pose3& T_anchor_camera, const Segment2& px,
                      const LandmarkEndParams& params) {
  constexpr double kRise_m = 0.1;
  const auto a = backProjectToGround(keyframe.intrinsics, T_anchor_camera, px.a, kFarthest_m);
  const auto b = backProjectToGround(keyframe.intrinsics, T_anchor_camera, px.b, kFarthest_m);
  const Eigen::Vector3d camera = T_anchor_camera.translation();
  const auto distance = [&](const std::optional<Eigen::Vector3d>& p) {
    return p ? (*p - camera).norm() : 2.0 * kFarthest_m;
  };
  const bool a_is_foot = distance(a) <= distance(b);
  const auto& foot = a_is_foot ? a : b;
  if (!foot) return UprightEnd::kNone;
  const Eigen::Vector3d raised = *foot + Eigen::Vector3d(0.0, 0.0, kRise_m);
  const auto up = projectToIdeal(keyframe.intrinsics, T_anchor_camera.inverse() * raised);
  if (!up) return UprightEnd::kNone;
  const double off_px = distanceToLine(a_is_foot ? px.b : px.a, {a_is_foot ? px.a : px.b, *up});
  if (off_px > std::min(params.upright_px, params.upright_rad * px.length())) return UprightEnd::kNone;
  return a_is_foot ? UprightEnd::kB : UprightEnd::kA;
}

double kernel(const SeenEnd& seen, double t_m) {
  const double z = (t_m - seen.t_m) / seen.sigma_m;
  return std::exp(-0.5 * z * z) / seen.sigma_m;
}

/// The place that most views agree on. @param outward +1 for end b, -1 for end a.
LandmarkEnd agreedEnd(const LandmarkEnd& known, const std::vector<SeenEnd>& seen, double outward,
                      const LandmarkEndParams& params) {
  double best = 0.0;
  std::optional<double> place;
  int censored = 0;
  for (const SeenEnd& candidate : seen) {
    censored += candidate.censored;
    if (candidate.censored) continue;
    double score = 0.0;
    for (const SeenEnd& each : seen) score += each.censored ? 0.0 : kernel(each, candidate.t_m);
    if (score <= best) continue;
    best = score;
    place = candidate.t_m;
  }
  if (!place) return {known.t_m, known.closed && censored == 0};
  double agreed = 0.0;
  double weights = 0.0;
  double sum = 0.0;
  double beyond = 0.0;
  int views = 0;
  for (const SeenEnd& each : seen) {
    const double off = outward * (each.t_m - *place);
    if (off > params.beyond_sigmas * each.sigma_m + 0.02) beyond += 1.0 / each.sigma_m;
    if (each.censored || std::abs(off) > params.beyond_sigmas * each.sigma_m) continue;
    const double weight = 1.0 / (each.sigma_m * each.sigma_m);
    agreed += 1.0 / each.sigma_m;
    weights += weight;
    sum += weight * each.t_m;
    ++views;
  }
  if (beyond > agreed) return {known.t_m, known.closed};
  const int asked = std::min<int>(params.min_views, static_cast<int>(seen.size()));
  if (views < asked) return known;
  return {sum / weights, true};
}

/// The end, but no further out than enough views reached. @param outward +1 for end b, -1 for end a.
LandmarkEnd withinSeen(const LandmarkEnd& known, std::vector<SeenEnd> seen, double outward,
                       const LandmarkEndParams& params) {
  if (seen.empty()) return known;
  std::sort(seen.begin(), seen.end(), [&](const SeenEnd& one, const SeenEnd& other) {
    return outward * one.t_m > outward * other.t_m;
  });
  const auto views = static_cast<std::size_t>(params.min_views);
  const SeenEnd& furthest = seen[std::min(views, seen.size()) - 1];
  const double slack_m = params.beyond_sigmas * furthest.sigma_m;
  if (outward * (known.t_m - furthest.t_m) <= slack_m) return known;
  return {furthest.t_m, false};
}

/// What single images showed of both ends of a landmark.
struct SeenEnds {
  std::vector<SeenEnd> a;
  std::vector<SeenEnd> b;
};

/// @param height_m  of the edge above the floor, if it lies there.
SeenEnds seenEnds(const DriveRecord& record, const LandmarkEndParams& params, const MapState& state,
                  const LineLandmark& landmark, double height_m) {
  SeenEnds ends;
  for (const auto& seen : landmark.seen) {
    const Keyframe& keyframe = record.keyframes[static_cast<std::size_t>(seen.keyframe)];
    const LineSighting& sighting = keyframe.sightings[static_cast<std::size_t>(seen.sighting)];
    Pose3 T = cameraIn(state, record, landmark.anchor, seen.keyframe);
    const UprightEnd top = uprightEnd(keyframe, T, sighting.px, params);
    T.translation().z() -= height_m;
    for (const bool at_b : {false, true}) {
      if (top == (at_b ? UprightEnd::kB : UprightEnd::kA)) continue;
      auto end = placed(landmark, keyframe, T, sighting, at_b, params.along_px);
      if (!end) continue;
      end->sigma_m = std::max(end->sigma_m, params.least_sigma_m);
      (at_b ? ends.b : ends.a).push_back(*end);
    }
  }
  return ends;
}

}  // namespace

std::optional<SeenEnd> seenEnd(const DriveRecord& record, const MapState& state, const LineLandmark& landmark,
                               const LineLandmark::Seen& seen, bool at_b, double sigma_px) {
  const Keyframe& keyframe = record.keyframes[static_cast<std::size_t>(seen.keyframe)];
  return placed(landmark, keyframe, cameraIn(state, record, landmark.anchor, seen.keyframe),
                keyframe.sightings[static_cast<std::size_t>(seen.sighting)], at_b, sigma_px);
}

void updateEnds(const DriveRecord& record, const LandmarkEndParams& params, MapState& state) {
  for (LineLandmark& landmark : state.landmarks) {
    const SeenEnds seen = seenEnds(record, params, state, landmark, 0.0);
    const LandmarkEnd a = agreedEnd(withinSeen(landmark.a, seen.a, -1.0, params), seen.a, -1.0, params);
    const LandmarkEnd b = agreedEnd(withinSeen(landmark.b, seen.b, 1.0, params), seen.b, 1.0, params);
    constexpr double kLeast_m = 0.02;
    if (b.t_m - a.t_m < kLeast_m) continue;
    landmark.a = a;
    landmark.b = b;
  }
}

int dropUprights(const DriveRecord& record, const LandmarkEndParams& params, int least_views,
                 MapState& state) {
  return static_cast<int>(std::erase_if(state.landmarks, [&](const LineLandmark& landmark) {
    const auto of_floor =
        std::count_if(landmark.seen.begin(), landmark.seen.end(), [&](const LineLandmark::Seen& seen) {
          const Keyframe& keyframe = record.keyframes[static_cast<std::size_t>(seen.keyframe)];
          const LineSighting& sighting = keyframe.sightings[static_cast<std::size_t>(seen.sighting)];
          return uprightEnd(keyframe, cameraIn(state, record, landmark.anchor, seen.keyframe), sighting.px,
                            params) == UprightEnd::kNone;
        });
    return of_floor < least_views;
  }));
}

namespace {

/// Median distance from the median, in sigmas; of the ends that were seen, if those are enough.
std::optional<double> scatterOf(const std::vector<SeenEnd>& seen, const LandmarkEndParams& params) {
  std::vector<SeenEnd> ends;
  std::copy_if(seen.begin(), seen.end(), std::back_inserter(ends),
               [](const SeenEnd& end) { return !end.censored; });
  if (static_cast<int>(ends.size()) < params.least_raised_views) return std::nullopt;
  const auto middle = [&](auto&& value) {
    std::vector<double> values;
    for (const SeenEnd& end : ends) values.push_back(value(end));
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), at, values.end());
    return *at;
  };
  const double place = middle([](const SeenEnd& end) { return end.t_m; });
  return middle([&](const SeenEnd& end) { return std::abs(end.t_m - place) / end.sigma_m; });
}

/// Scatter of both ends if the edge lies at a height; of the one that was seen to end.
std::optional<double> scatterAt(const DriveRecord& record, const LandmarkEndParams& params,
                                const MapState& state, const LineLandmark& landmark, double height_m) {
  const SeenEnds ends = seenEnds(record, params, state, landmark, height_m);
  const auto a = scatterOf(ends.a, params);
  const auto b = scatterOf(ends.b, params);
  if (!a || !b) return a ? a : b;
  return std::max(*a, *b);
}

}  // namespace

int dropRaised(const DriveRecord& record, const LandmarkEndParams& params, MapState& state) {
  constexpr double kStep_m = 0.05;
  return static_cast<int>(std::erase_if(state.landmarks, [&](const LineLandmark& landmark) {
    const auto floor = scatterAt(record, params, state, landmark, 0.0);
    if (!floor || *floor <= params.raised_sigmas || landmark.seen.empty()) return false;
    const auto& keyframe = record.keyframes[static_cast<std::size_t>(landmark.seen.front().keyframe)];
    const double most_m = params.most_height_share * keyframe.T_robot_camera.translation().z();
    for (double height_m = kStep_m; height_m <= most_m; height_m += kStep_m) {
      const auto raised = scatterAt(record, params, state, landmark, height_m);
      if (raised && *raised * params.raised_gain <= *floor) return true;
    }
    return false;
  }));
}

namespace {

/// Where a landmark lies along another one.
struct Stretch {
  double low_m = 0.0;
  double high_m = 0.0;
};

std::optional<Stretch> stretchAlong(const LineLandmark& whole, const LineLandmark& part,
                                    const MapState& state, const OverlapParams& params) {
  const Segment2 along = state.worldSegment(whole);
  const Segment2 other = state.worldSegment(part);
  if (lineAngleDifference(along.direction(), other.direction()) > params.angle_rad) return std::nullopt;
  if (distanceToLine(other.a, along) > params.across_m || distanceToLine(other.b, along) > params.across_m) {
    return std::nullopt;
  }
  const Eigen::Vector2d u = (along.b - along.a).normalized();
  const double ta = u.dot(other.a - along.a) + whole.a.t_m;
  const double tb = u.dot(other.b - along.a) + whole.a.t_m;
  const Stretch stretch{std::min(ta, tb), std::max(ta, tb)};
  const double inside = std::min(stretch.high_m, whole.b.t_m) - std::max(stretch.low_m, whole.a.t_m);
  if (inside < params.least_share * other.length()) return std::nullopt;
  return stretch;
}

LineLandmark piece(const LineLandmark& whole, const LandmarkEnd& a, const LandmarkEnd& b) {
  LineLandmark result = whole;
  result.a = a;
  result.b = b;
  result.recentre();
  return result;
}

/// Sightings whose part of the line lies on the piece.
void keepOwnSightings(const DriveRecord& record, const MapState& state, LineLandmark& landmark) {
  std::erase_if(landmark.seen, [&](const LineLandmark::Seen& seen) {
    const Keyframe& keyframe = record.keyframes[static_cast<std::size_t>(seen.keyframe)];
    const LineSighting& sighting = keyframe.sightings[static_cast<std::size_t>(seen.sighting)];
    const Pose3 T = cameraIn(state, record, landmark.anchor, seen.keyframe);
    const auto a = placed(landmark, keyframe, T, sighting, false, 1.0);
    const auto b = placed(landmark, keyframe, T, sighting, true, 1.0);
    if (!a || !b) return true;
    const double inside = std::min(b->t_m, landmark.b.t_m) - std::max(a->t_m, landmark.a.t_m);
    return inside < 0.3 * std::min(b->t_m - a->t_m, landmark.b.t_m - landmark.a.t_m);
  });
}

/// The next id for a piece of this landmark: pieces are cut again, the first as well as the last.
std::uint64_t freePieceId(const std::vector<LineLandmark>& all, const LineLandmark& whole) {
  constexpr std::uint64_t kIdsOfAnElement = 100;  // as of LineLandmark::id
  std::uint64_t last = whole.id;
  for (const LineLandmark& each : all) {
    if (each.id / kIdsOfAnElement == whole.id / kIdsOfAnElement) last = std::max(last, each.id);
  }
  return last + 1;
}

}  // namespace

int cutOverlaps(const DriveRecord& record, const OverlapParams& params, MapState& state) {
  int cuts = 0;
  std::vector<LineLandmark>& all = state.landmarks;
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (std::size_t j = 0; j < all.size(); ++j) {
      if (i == j || all[i].label == all[j].label || all[j].label == kUnknownLabel) continue;
      if (static_cast<int>(all[j].seen.size()) < params.min_sightings) continue;
      if (all[j].b.t_m - all[j].a.t_m >= all[i].b.t_m - all[i].a.t_m) continue;
      const auto stretch = stretchAlong(all[i], all[j], state, params);
      if (!stretch) continue;
      const LineLandmark whole = all[i];
      std::vector<LineLandmark> rest;
      if (stretch->low_m - whole.a.t_m >= params.least_piece_m) {
        rest.push_back(piece(whole, whole.a, {stretch->low_m, true}));
      }
      if (whole.b.t_m - stretch->high_m >= params.least_piece_m) {
        rest.push_back(piece(whole, {stretch->high_m, true}, whole.b));
        rest.back().id = freePieceId(all, whole);
      }
      for (LineLandmark& each : rest) keepOwnSightings(record, state, each);
      std::erase_if(rest, [](const LineLandmark& each) { return each.seen.empty(); });
      ++cuts;
      all.erase(all.begin() + static_cast<std::ptrdiff_t>(i));
      all.insert(all.end(), rest.begin(), rest.end());
      --i;
      break;
    }
  }
  return cuts;
}

}  // namespace vismem
