#include "mapper/core/landmark_ends.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "active_visual_memory/core/ground/camera_tilt.h"
#include "common/geometry/angles.h"
#include "common/geometry/plane.h"
#include "common/geometry/projection.h"

namespace vismem {
namespace {

constexpr double kFarthest_m = 8.0;

/// An observed end on the landmark's line.
struct SeenEnd {
  double t_m = 0.0;
  double sigma_m = 0.0;
  bool censored = false;
};

/// The camera of a keyframe in the frame of a landmark's anchor.
Pose3 cameraIn(const MapState& state, const DriveRecord& record, int anchor, int keyframe) {
  const auto k = static_cast<std::size_t>(keyframe);
  CameraTilt tilt = state.camera_tilt;
  tilt.head<2>() += state.frame_tilts[k];
  const Pose2 T_anchor_robot = inverse(state.poses[static_cast<std::size_t>(anchor)]) * state.poses[k];
  return toPose3(T_anchor_robot) * tilted(record.keyframes[k].T_robot_camera, tilt);
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
    if (candidate.censored || std::abs(candidate.t_m - known.t_m) > params.reach_m) continue;
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

}  // namespace

void updateEnds(const DriveRecord& record, const LandmarkEndParams& params, MapState& state) {
  for (LineLandmark& landmark : state.landmarks) {
    std::vector<SeenEnd> at_a;
    std::vector<SeenEnd> at_b;
    for (const auto& seen : landmark.seen) {
      const Keyframe& keyframe = record.keyframes[static_cast<std::size_t>(seen.keyframe)];
      const LineSighting& sighting = keyframe.sightings[static_cast<std::size_t>(seen.sighting)];
      const Pose3 T = cameraIn(state, record, landmark.anchor, seen.keyframe);
      for (const bool at_b_end : {false, true}) {
        auto end = placed(landmark, keyframe, T, sighting, at_b_end, params.along_px);
        if (!end) continue;
        end->sigma_m = std::max(end->sigma_m, params.least_sigma_m);
        (at_b_end ? at_b : at_a).push_back(*end);
      }
    }
    const LandmarkEnd a = agreedEnd(landmark.a, at_a, -1.0, params);
    const LandmarkEnd b = agreedEnd(landmark.b, at_b, 1.0, params);
    constexpr double kLeast_m = 0.02;
    if (b.t_m - a.t_m < kLeast_m) continue;
    landmark.a = a;
    landmark.b = b;
  }
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
