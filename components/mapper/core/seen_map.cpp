#include "mapper/core/seen_map.h"

#include <algorithm>
#include <cmath>

#include "common/geometry/angles.h"
#include "common/geometry/plane.h"

namespace vismem {
namespace {

/// Whether the way from one point to another crosses an edge, but near its end.
bool isCrossed(const Eigen::Vector2d& from, const Eigen::Vector2d& to, const Segment2& edge, double end_m) {
  const Eigen::Vector2d way = to - from;
  const Eigen::Vector2d along = edge.b - edge.a;
  const double det = cross2(way, along);
  if (std::abs(det) < 1e-12) return false;
  const double on_way = cross2(edge.a - from, along) / det;
  const double on_edge = cross2(edge.a - from, way) / det;
  return on_way > 0.0 && on_way * way.norm() < way.norm() - end_m && on_edge >= 0.0 && on_edge <= 1.0;
}

}  // namespace

SeenMap::SeenMap(const std::vector<CountedRow>& map, const std::vector<SeenFloor>& sessions,
                 const ChangeParams& params)
    : params_(params) {
  constexpr double kFloor_m = 0.02;
  for (const CountedRow& counted : map) {
    const MapSegment& row = counted.row;
    if (row.world.a.z() >= kFloor_m || row.world.b.z() >= kFloor_m) continue;
    edges_.push_back({row.world.floor(), row.label, counted.sessions > 0, counted.times_seen});
    if (matchesAny(row.label, params_.opaque_labels)) walls_.push_back(row.world.floor());
  }
  for (const SeenFloor& seen : sessions) {
    Session& session = sessions_.emplace_back();
    session.traces = &seen.traces;
    for (const SeenView& view : seen.views) {
      session.views.push_back(
          {view.T_map_camera.translation().head<2>(), CameraView(view.intrinsics, view.T_map_camera)});
    }
  }
}

SeenMap::Looks SeenMap::looksAt(const Eigen::Vector2d& p, const SeenEdge& edge) const {
  Looks all;
  for (const Session& session : sessions_) {
    const Looks one = looksOf(session, p, edge);
    all.views += one.views;
    all.sightings += one.sightings;
  }
  return all;
}

double SeenMap::viewsOfOwn(const Eigen::Vector2d& p, const SeenEdge& edge) const {
  double own = 0.0;
  double all = 0.0;
  for (const Session& session : sessions_) {
    const Looks one = looksOf(session, p, edge);
    all += one.views;
    if (one.sightings > 0.0) own += one.views;
  }
  return own > 0.0 ? own : all;
}

bool SeenMap::liesOn(const Eigen::Vector2d& p, const SeenEdge& edge) const {
  return std::any_of(edges_.begin(), edges_.end(), [&](const SeenEdge& own) {
    return own.label == edge.label && isNear(p, edge.floor, own.floor);
  });
}

bool SeenMap::isNear(const Eigen::Vector2d& p, const Segment2& edge, const Segment2& own) const {
  return lineAngleDifference(own.direction(), edge.direction()) <= params_.angle_rad &&
         distanceToSegment(p, own) <= params_.near_m;
}

bool SeenMap::isHidden(const Eigen::Vector2d& camera, const Eigen::Vector2d& p) const {
  return std::any_of(walls_.begin(), walls_.end(),
                     [&](const Segment2& wall) { return isCrossed(camera, p, wall, params_.near_m); });
}

SeenMap::Looks SeenMap::looksOf(const Session& session, const Eigen::Vector2d& p,
                                const SeenEdge& edge) const {
  Looks looks;
  for (const View& view : session.views) {
    if ((p - view.camera).norm() > params_.range_m || !view.view.shows(p)) continue;
    if (!isHidden(view.camera, p)) ++looks.views;
  }
  for (const FloorTrace& trace : *session.traces) {
    if (trace.label != kUnknownLabel && trace.label != edge.label) continue;
    if (isNear(p, edge.floor, trace.floor)) looks.sightings += trace.sightings;
  }
  looks.sightings = std::min(looks.sightings, looks.views);
  return looks;
}

}  // namespace vismem
