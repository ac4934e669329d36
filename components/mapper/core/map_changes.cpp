#include "mapper/core/map_changes.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "mapper/core/seen_map.h"

namespace vismem {
namespace {

constexpr double kCompareStep_m = 0.04;  // of points along an edge
constexpr double kFactNear_m = 0.15;     // a thing that a second drive finds again

/// What one map and its views say of an edge of the other one.
struct Verdict {
  SeenEdge edge;
  double here_m = 0.0;     ///< lies on an edge of this map
  double missing_m = 0.0;  ///< does not, and its place was looked at
  double unseen_m = 0.0;
  double nats = 0.0;   ///< for its absence, where it is missing
  Segment2 missing{};  ///< from the first to the last missing point
  Segment2 unseen{};

  double judged_m() const { return here_m + missing_m; }
};

/// A stretch of an edge, by shares of its length.
class ShareRange {
 public:
  void add(double from, double to) {
    from_ = std::min(from_, from);
    to_ = std::max(to_, to);
  }
  Segment2 of(const Segment2& edge) const {
    const Eigen::Vector2d along = edge.b - edge.a;
    return {edge.a + std::min(from_, to_) * along, edge.a + to_ * along};
  }

 private:
  double from_ = 1.0;
  double to_ = 0.0;
};

/// For the absence of an edge where `there` looked and saw so much.
/// @param own_views  of its place by the drives that know it: how often it is seen if it is there.
double natsFor(const SeenMap::Looks& there, const SeenEdge& edge, double own_views,
               const ChangeParams& params) {
  constexpr double kLeastRate = 0.05;
  constexpr double kMostRate = 0.95;
  constexpr double kUnknownRate = 0.5;  // of an edge that no drive counted
  const double seen = std::min<double>(edge.times_seen, own_views);
  const double rate = edge.is_counted && own_views > 0.0
                          ? std::clamp((seen + 0.5) / (own_views + 1.0), kLeastRate, kMostRate)
                          : kUnknownRate;
  const double none = params.false_sighting;
  const double nats = (there.sightings * std::log(none / rate) +
                       (there.views - there.sightings) * std::log((1.0 - none) / (1.0 - rate))) /
                      params.views_in_one;
  // Sightings of something else near it speak for one side only.
  return std::max(nats, -2.0 * params.least_nats);
}

/// @param there   the map that may lack the edge.
/// @param own     the map that has it.
/// @param all     whether all of the place counts as seen by `there`.
Verdict verdictOn(const SeenEdge& edge, const SeenMap& there, const SeenMap& own, bool all,
                  const ChangeParams& params) {
  Verdict verdict{edge};
  ShareRange missing;
  ShareRange unseen;
  SeenMap::Looks theirs;
  double own_views = 0.0;
  const int steps = std::max(1, static_cast<int>(std::lround(edge.floor.length() / kCompareStep_m)));
  const double step_m = edge.floor.length() / steps;
  int looked = 0;
  for (int i = 0; i < steps; ++i) {
    const double share = (i + 0.5) / steps;
    const Eigen::Vector2d p = edge.floor.a + share * (edge.floor.b - edge.floor.a);
    const double from = share - 0.5 / steps;
    const double to = share + 0.5 / steps;
    if (there.liesOn(p, edge)) {
      verdict.here_m += step_m;
      continue;
    }
    const SeenMap::Looks looks = all ? SeenMap::Looks{} : there.looksAt(p, edge);
    if (!all && looks.views < params.least_views) {
      verdict.unseen_m += step_m;
      unseen.add(from, to);
      continue;
    }
    verdict.missing_m += step_m;
    missing.add(from, to);
    theirs.views += looks.views;
    theirs.sightings += looks.sightings;
    own_views += own.viewsOfOwn(p, edge);
    ++looked;
  }
  verdict.missing = missing.of(edge.floor);
  verdict.unseen = unseen.of(edge.floor);
  if (looked == 0) return verdict;
  // Points of one edge are seen together: their mean counts once.
  for (double* sum : {&theirs.views, &theirs.sightings, &own_views}) *sum /= looked;
  // A drawing shows all: what it lacks is new.
  verdict.nats =
      all ? std::max(params.least_nats, params.least_alone_nats) : natsFor(theirs, edge, own_views, params);
  return verdict;
}

double distanceOf(const Segment2& a, const Segment2& b) {
  return std::min({distanceToSegment(a.a, b), distanceToSegment(a.b, b), distanceToSegment(b.a, a),
                   distanceToSegment(b.b, a)});
}

/// Indices of edges of one label that hang together.
std::vector<std::vector<std::size_t>> thingsOf(const std::vector<SeenEdge>& edges, double reach_m) {
  std::vector<std::vector<std::size_t>> things;
  std::vector<bool> taken(edges.size(), false);
  for (std::size_t first = 0; first < edges.size(); ++first) {
    if (taken[first]) continue;
    taken[first] = true;
    std::vector<std::size_t> group{first};
    for (std::size_t i = 0; i < group.size(); ++i) {
      for (std::size_t j = 0; j < edges.size(); ++j) {
        if (taken[j] || edges[j].label != edges[first].label ||
            distanceOf(edges[group[i]].floor, edges[j].floor) > reach_m)
          continue;
        taken[j] = true;
        group.push_back(j);
      }
    }
    things.push_back(std::move(group));
  }
  return things;
}

/// Largest side of the box around edges [m].
double sizeOf(const std::vector<Segment2>& edges) {
  Eigen::Vector2d low = edges.front().a;
  Eigen::Vector2d high = low;
  for (const Segment2& edge : edges) {
    low = low.cwiseMin(edge.a).cwiseMin(edge.b);
    high = high.cwiseMax(edge.a).cwiseMax(edge.b);
  }
  return (high - low).maxCoeff();
}

/// The things of one map that the other one lacks.
class MissingThings {
 public:
  MissingThings(const SeenMap& there, const SeenMap& own, bool all, const ChangeParams& params)
      : params_(params) {
    for (const SeenEdge& edge : own.edges()) verdicts_.push_back(verdictOn(edge, there, own, all, params));
    for (const auto& thing : thingsOf(own.edges(), params.thing_m)) judge(thing);
  }

  std::vector<MapChange> take(MapChange::Kind kind) {
    for (MapChange& thing : things_) {
      thing.kind = kind;
      if (kind == MapChange::Kind::kNew) std::swap(thing.before, thing.now);
    }
    return std::move(things_);
  }
  /// Where nobody looked before.
  std::vector<MapSegment> unseen() const {
    std::vector<MapSegment> rows;
    for (std::size_t i = 0; i < verdicts_.size(); ++i) {
      const Verdict& v = verdicts_[i];
      if (reported_.count(i) > 0 || v.unseen_m < params_.least_m) continue;
      MapSegment row;
      row.label = v.edge.label;
      row.world.a << v.unseen.a, 0.0;
      row.world.b << v.unseen.b, 0.0;
      rows.push_back(row);
    }
    return rows;
  }

 private:
  /// Edges that meet confirm each other. A lone one may have been matched wrongly.
  bool isSure(const std::vector<std::size_t>& thing) const {
    const Verdict& first = verdicts_[thing.front()];
    return thing.size() > 1 || !first.edge.is_counted || first.nats >= params_.least_alone_nats;
  }
  bool isMissing(double missing_m, double judged_m, double nats) const {
    return missing_m >= params_.least_m && missing_m >= params_.gone_share * judged_m &&
           nats >= params_.least_nats;
  }
  void judge(const std::vector<std::size_t>& thing) {
    std::vector<Segment2> whole;
    double missing_m = 0.0;
    double judged_m = 0.0;
    double longest_m = 0.0;
    double nats = 0.0;
    for (const std::size_t i : thing) {
      const Verdict& v = verdicts_[i];
      whole.push_back(v.edge.floor);
      missing_m += v.missing_m;
      judged_m += v.judged_m();
      longest_m = std::max(longest_m, v.missing_m);
      nats += v.missing_m * v.nats;
    }
    // Sides as long as the longest one count fully, scraps hardly.
    if (longest_m > 0.0) nats /= longest_m;
    const bool is_rigid = sizeOf(whole) <= params_.most_thing_m;
    if (is_rigid && isMissing(missing_m, judged_m, nats)) {
      report(thing, whole);
    } else {
      judgeParts(thing, is_rigid);
    }
  }
  /// Edges of a thing of which others are there. A rigid thing's own sides touch: what is missing of it was
  /// overlooked, but what only stands near it is another thing.
  void judgeParts(const std::vector<std::size_t>& thing, bool is_rigid) {
    std::vector<SeenEdge> edges;
    std::vector<std::size_t> index;
    std::vector<Segment2> here;
    for (const std::size_t i : thing) {
      const Verdict& v = verdicts_[i];
      if (v.here_m > 0.5 * v.judged_m()) here.push_back(v.edge.floor);
      if (!isMissing(v.missing_m, v.judged_m(), v.nats)) continue;
      edges.push_back({v.missing, v.edge.label, v.edge.is_counted, v.edge.times_seen});
      index.push_back(i);
    }
    for (const auto& group : thingsOf(edges, params_.thing_m)) {
      std::vector<std::size_t> members;
      std::vector<Segment2> floor;
      for (const std::size_t g : group) {
        members.push_back(index[g]);
        floor.push_back(edges[g].floor);
      }
      if (is_rigid && touches(floor, here)) continue;
      report(members, std::move(floor));
    }
  }
  bool touches(const std::vector<Segment2>& some, const std::vector<Segment2>& others) const {
    return std::any_of(some.begin(), some.end(), [&](const Segment2& one) {
      return std::any_of(others.begin(), others.end(),
                         [&](const Segment2& other) { return distanceOf(one, other) <= params_.near_m; });
    });
  }
  void report(const std::vector<std::size_t>& members, std::vector<Segment2> floor) {
    if (!isSure(members)) return;
    reported_.insert(members.begin(), members.end());
    things_.push_back(
        {MapChange::Kind::kRemoved, verdicts_[members.front()].edge.label, std::move(floor), {}});
  }

  const ChangeParams& params_;
  std::vector<Verdict> verdicts_;
  std::set<std::size_t> reported_;
  std::vector<MapChange> things_;
};

bool isRejected(const MapChange& change, const std::vector<ChangeFact>& rejected) {
  const std::vector<ChangeFact> facts = factsOf(change);
  return std::any_of(rejected.begin(), rejected.end(),
                     [&](const ChangeFact& fact) { return isSameFact(fact, facts.front()); });
}

/// Whether the drive of today saw what the fact denies: the thing that was gone, or the place of the one that
/// came, empty.
bool isContradicted(const ChangeFact& fact, const SeenMap& today, const SeenMap& then,
                    const ChangeParams& params) {
  double here_m = 0.0;
  double missing_m = 0.0;
  double nats = 0.0;
  for (const Segment2& edge : fact.edges) {
    const Verdict verdict = verdictOn({edge, fact.label}, today, then, false, params);
    here_m += verdict.here_m;
    missing_m += verdict.missing_m;
    nats += verdict.nats;
  }
  if (fact.is_gone) return here_m > missing_m;
  return missing_m > here_m && nats >= params.least_nats;
}

/// The nearest new thing of a label is the removed one, if both are things that can be moved. What moved less
/// than maps err did not.
void pairMoved(std::vector<MapChange>& changes, std::vector<MapChange>& fresh, const ChangeParams& params) {
  while (true) {
    std::size_t from = changes.size();
    std::size_t to = 0;
    double nearest_m = params.most_moved_m;
    for (std::size_t r = 0; r < changes.size(); ++r) {
      if (changes[r].kind != MapChange::Kind::kRemoved) continue;
      for (std::size_t i = 0; i < fresh.size(); ++i) {
        const double distance_m = (placeOf(fresh[i].now) - placeOf(changes[r].before)).norm();
        if (fresh[i].label != changes[r].label || distance_m >= nearest_m) continue;
        const bool can_move =
            std::max(sizeOf(changes[r].before), sizeOf(fresh[i].now)) <= params.most_thing_m;
        if (!can_move && distance_m >= params.least_moved_m) continue;
        nearest_m = distance_m;
        from = r;
        to = i;
      }
    }
    if (from == changes.size()) return;
    changes[from].kind = MapChange::Kind::kMoved;
    changes[from].now = std::move(fresh[to].now);
    fresh.erase(fresh.begin() + static_cast<std::ptrdiff_t>(to));
    if (nearest_m < params.least_moved_m) changes.erase(changes.begin() + static_cast<std::ptrdiff_t>(from));
  }
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

std::vector<ChangeFact> factsOf(const MapChange& change) {
  std::vector<ChangeFact> facts;
  if (!change.before.empty()) facts.push_back({true, change.label, change.before});
  if (!change.now.empty()) facts.push_back({false, change.label, change.now});
  return facts;
}

bool isSameFact(const ChangeFact& one, const ChangeFact& other) {
  if (one.is_gone != other.is_gone || one.label != other.label) return false;
  const auto covers = [](const ChangeFact& all, const ChangeFact& part) {
    return std::all_of(part.edges.begin(), part.edges.end(), [&](const Segment2& edge) {
      return std::any_of(all.edges.begin(), all.edges.end(), [&](const Segment2& counterpart) {
        return distanceToSegment(edge.middle(), counterpart) <= kFactNear_m;
      });
    });
  };
  // One drive may have seen a side of a thing that the other one did not.
  return (placeOf(one.edges) - placeOf(other.edges)).norm() <= 2.0 * kFactNear_m &&
         (covers(one, other) || covers(other, one));
}

SeenFloor transform(const Pose2& T_a_b, SeenFloor seen) {
  for (SeenView& view : seen.views) view.T_map_camera = toPose3(T_a_b) * view.T_map_camera;
  for (FloorTrace& trace : seen.traces) trace.floor = transform(T_a_b, trace.floor);
  return seen;
}

MapComparison compareMaps(const std::vector<CountedRow>& before, const SeenBefore& seen_before,
                          const std::vector<CountedRow>& now, const SeenFloor& seen_now,
                          const ChangeParams& params, const std::vector<ChangeFact>& rejected) {
  MapComparison found;
  found.rejected = rejected;
  if (seen_now.views.empty()) return found;
  const std::vector<SeenFloor> sessions_now{seen_now};
  const SeenMap then(before, seen_before.sessions, params);
  const SeenMap today(now, sessions_now, params);
  std::erase_if(found.rejected,
                [&](const ChangeFact& fact) { return isContradicted(fact, today, then, params); });
  MissingThings removed(today, then, false, params);
  MissingThings fresh(then, today, seen_before.is_complete, params);
  found.added = fresh.unseen();
  found.changes = removed.take(MapChange::Kind::kRemoved);
  std::vector<MapChange> brought = fresh.take(MapChange::Kind::kNew);
  // Before pairs are made: a thing that was rejected is no other one's new place.
  for (std::vector<MapChange>* some : {&found.changes, &brought})
    std::erase_if(*some, [&](const MapChange& change) { return isRejected(change, found.rejected); });
  pairMoved(found.changes, brought, params);
  found.changes.insert(found.changes.end(), brought.begin(), brought.end());
  return found;
}

}  // namespace vismem
