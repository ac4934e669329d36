#include "mapper/core/map_changes.h"

#include <algorithm>
#include <cmath>

#include "common/geometry/angles.h"
#include "common/geometry/plane.h"

namespace vismem {
namespace {

constexpr double kStep_m = 0.04;  // of points along an edge

struct Edge {
  Segment2 floor;
  Label label;
};

std::vector<Edge> edgesOf(const SegmentMap& map) {
  constexpr double kFloor_m = 0.02;
  std::vector<Edge> edges;
  for (const MapSegment& row : map.segments) {
    if (row.world.a.z() < kFloor_m && row.world.b.z() < kFloor_m)
      edges.push_back({row.world.floor(), row.label});
  }
  return edges;
}

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

/// A map with the views of the drive that made it.
class SeenMap {
 public:
  SeenMap(const SegmentMap& map, const SeenFloor& seen, const ChangeParams& params)
      : edges_(edgesOf(map)), seen_(seen), params_(params) {
    for (const Edge& edge : edges_) {
      if (matchesAny(edge.label, params_.opaque_labels)) walls_.push_back(edge.floor);
    }
  }

  const std::vector<Edge>& edges() const { return edges_; }

  /// Whether the floor was seen here, unhidden by this map's edges.
  bool isSeen(const Eigen::Vector2d& p) const {
    int views = 0;
    for (const FloorView& view : seen_.views) {
      if ((p - view.camera).norm() > params_.range_m || !view.view.shows(p)) continue;
      const bool is_hidden = std::any_of(walls_.begin(), walls_.end(), [&](const Segment2& wall) {
        return isCrossed(view.camera, p, wall, params_.near_m);
      });
      if (!is_hidden && ++views >= params_.least_views) return true;
    }
    return false;
  }

  /// Edges of another map of which most of what this one saw lies on none of its edges, cut to that part.
  std::vector<Edge> missing(const std::vector<Edge>& others) const {
    std::vector<Edge> found;
    for (const Edge& edge : others) {
      const int steps = std::max(1, static_cast<int>(std::lround(edge.floor.length() / kStep_m)));
      int judged = 0;
      int missing = 0;
      double first = 1.0;
      double last = 0.0;
      for (int i = 0; i < steps; ++i) {
        const double share = (i + 0.5) / steps;
        const Eigen::Vector2d p = edge.floor.a + share * (edge.floor.b - edge.floor.a);
        const bool lies_here = liesOn(p, edge);
        if (!lies_here && !seen_.views.empty() && (!isSeen(p) || hasTrace(p, edge))) continue;
        ++judged;
        if (lies_here) continue;
        ++missing;
        first = std::min(first, share - 0.5 / steps);
        last = std::max(last, share + 0.5 / steps);
      }
      const double missing_m = missing * edge.floor.length() / steps;
      if (missing_m < params_.least_m || missing < params_.gone_share * judged) continue;
      const Eigen::Vector2d along = edge.floor.b - edge.floor.a;
      found.push_back({{edge.floor.a + first * along, edge.floor.a + last * along}, edge.label});
    }
    return found;
  }

 private:
  bool isNear(const Eigen::Vector2d& p, const Segment2& edge, const Segment2& own) const {
    return lineAngleDifference(own.direction(), edge.direction()) <= params_.angle_rad &&
           distanceToSegment(p, own) <= params_.near_m;
  }
  bool liesOn(const Eigen::Vector2d& p, const Edge& edge) const {
    return std::any_of(edges_.begin(), edges_.end(), [&](const Edge& own) {
      return own.label == edge.label && isNear(p, edge.floor, own.floor);
    });
  }
  bool hasTrace(const Eigen::Vector2d& p, const Edge& edge) const {
    return std::any_of(seen_.traces.begin(), seen_.traces.end(),
                       [&](const Segment2& trace) { return isNear(p, edge.floor, trace); });
  }

  std::vector<Edge> edges_;
  std::vector<Segment2> walls_;
  const SeenFloor& seen_;
  const ChangeParams& params_;
};

double distanceOf(const Segment2& a, const Segment2& b) {
  return std::min({distanceToSegment(a.a, b), distanceToSegment(a.b, b), distanceToSegment(b.a, a),
                   distanceToSegment(b.b, a)});
}

/// Edges of one label that hang together, as things.
std::vector<MapChange> thingsOf(const std::vector<Edge>& edges, MapChange::Kind kind, double reach_m) {
  std::vector<MapChange> things;
  std::vector<bool> taken(edges.size(), false);
  for (std::size_t first = 0; first < edges.size(); ++first) {
    if (taken[first]) continue;
    taken[first] = true;
    std::vector<Segment2> group{edges[first].floor};
    for (std::size_t i = 0; i < group.size(); ++i) {
      for (std::size_t j = 0; j < edges.size(); ++j) {
        if (taken[j] || edges[j].label != edges[first].label ||
            distanceOf(group[i], edges[j].floor) > reach_m)
          continue;
        taken[j] = true;
        group.push_back(edges[j].floor);
      }
    }
    MapChange thing{kind, edges[first].label, {}, {}};
    (kind == MapChange::Kind::kNew ? thing.now : thing.before) = std::move(group);
    things.push_back(std::move(thing));
  }
  return things;
}

}  // namespace

std::string nameOf(MapChange::Kind kind) {
  return kind == MapChange::Kind::kMoved ? "moved" : kind == MapChange::Kind::kRemoved ? "removed" : "new";
}

Eigen::Vector2d placeOf(const std::vector<Segment2>& edges) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double length_m = 0.0;
  for (const Segment2& edge : edges) {
    sum += edge.length() * edge.middle();
    length_m += edge.length();
  }
  return sum / length_m;
}

std::vector<MapChange> mapChanges(const SegmentMap& before, const SeenFloor& seen_before,
                                  const SegmentMap& now, const SeenFloor& seen_now,
                                  const ChangeParams& params) {
  if (seen_now.views.empty()) return {};
  const SeenMap then(before, seen_before, params);
  const SeenMap today(now, seen_now, params);
  std::vector<MapChange> changes =
      thingsOf(today.missing(then.edges()), MapChange::Kind::kRemoved, params.thing_m);
  std::vector<MapChange> fresh = thingsOf(then.missing(today.edges()), MapChange::Kind::kNew, params.thing_m);
  // The nearest new thing of a label is the removed one.
  while (true) {
    MapChange* from = nullptr;
    std::size_t to = 0;
    double nearest_m = params.most_moved_m;
    for (MapChange& removed : changes) {
      if (removed.kind != MapChange::Kind::kRemoved) continue;
      for (std::size_t i = 0; i < fresh.size(); ++i) {
        const double distance_m = (placeOf(fresh[i].now) - placeOf(removed.before)).norm();
        if (fresh[i].label != removed.label || distance_m >= nearest_m) continue;
        nearest_m = distance_m;
        from = &removed;
        to = i;
      }
    }
    if (!from) break;
    from->kind = MapChange::Kind::kMoved;
    from->now = std::move(fresh[to].now);
    fresh.erase(fresh.begin() + static_cast<std::ptrdiff_t>(to));
  }
  changes.insert(changes.end(), fresh.begin(), fresh.end());
  return changes;
}

}  // namespace vismem
