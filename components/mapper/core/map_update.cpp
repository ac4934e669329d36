#include "mapper/core/map_update.h"

#include <algorithm>
#include <cmath>

#include "common/geometry/angles.h"
#include "common/geometry/rounding.h"

namespace vismem {
namespace {

constexpr double kOnRow_m = 2e-3;      // changes are cut from the rows themselves, which are in millimetres
constexpr double kLeastRest_m = 0.04;  // as of MapOutputParams::min_length_m
constexpr double kSameEdge_m = 0.08;   // as of ChangeParams::near_m
constexpr double kSameEdge_rad = 0.2;
constexpr double kSeenAgain = 0.3;     // share of a row's length that the drive's rows lie on
constexpr double kContinues_m = 0.15;  // gap between a row and the stretch that continues it
constexpr double kShareStep_m = 0.04;

MapSegment rowOf(const Label& label, const Segment2& floor) {
  MapSegment row;
  row.label = label;
  row.world.a << rounded(floor.a.x(), 1e3), rounded(floor.a.y(), 1e3), 0.0;
  row.world.b << rounded(floor.b.x(), 1e3), rounded(floor.b.y(), 1e3), 0.0;
  return row;
}

/// A stretch of a row, by shares of its length.
struct Share {
  double from = 0.0;
  double to = 1.0;
};

/// What is left of a stretch without another one.
std::vector<Share> without(const std::vector<Share>& all, const Share& gone) {
  std::vector<Share> rest;
  for (const Share& one : all) {
    if (gone.to <= one.from || gone.from >= one.to) {
      rest.push_back(one);
      continue;
    }
    if (gone.from > one.from) rest.push_back({one.from, gone.from});
    if (gone.to < one.to) rest.push_back({gone.to, one.to});
  }
  return rest;
}

/// The stretches of an edge that lie on none of the pieces cut from it.
std::vector<Share> restOf(const Segment2& edge, const std::vector<Segment2>& gone) {
  std::vector<Share> rest{{}};
  for (const Segment2& piece : gone) {
    if (distanceToLine(piece.a, edge) > kOnRow_m || distanceToLine(piece.b, edge) > kOnRow_m) continue;
    const double a = projectionFraction(piece.a, edge);
    const double b = projectionFraction(piece.b, edge);
    const double slack = kOnRow_m / edge.length();
    rest = without(rest, {std::min(a, b) - slack, std::max(a, b) + slack});
  }
  return rest;
}

/// The pieces of accepted changes, by label.
std::vector<Segment2> goneOf(const ChangeList& list, const Label& label) {
  std::vector<Segment2> gone;
  for (const ListedChange& listed : list.changes) {
    if (listed.decision == Decision::kAccept && listed.change.label == label)
      gone.insert(gone.end(), listed.change.before.begin(), listed.change.before.end());
  }
  return gone;
}

/// The stretches of a row that stay. Of a painted line those where one of its edges stays.
std::vector<Share> staying(const MapSegment& row, const std::map<Label, Label>& stripes,
                           const ChangeList& list) {
  SegmentMap one;
  one.segments = {row};
  std::vector<Share> gone{{}};
  for (const MapSegment& edge : expandStripes(one, stripes).segments) {
    Segment2 floor = edge.world.floor();
    const Segment2 middle = row.world.floor();
    // Shares of both edges run along the row.
    if ((floor.b - floor.a).dot(middle.b - middle.a) < 0.0) std::swap(floor.a, floor.b);
    for (const Share& share : restOf(floor, goneOf(list, edge.label))) gone = without(gone, share);
  }
  std::vector<Share> stay{{}};
  for (const Share& share : gone) stay = without(stay, share);
  return stay;
}

/// Share of a row's length that lies on the other one.
double shareOn(const MapSegment& row, const MapSegment& other) {
  const Segment2 floor = row.world.floor();
  const Segment2 along = other.world.floor();
  if (row.label != other.label || lineAngleDifference(floor.direction(), along.direction()) > kSameEdge_rad)
    return 0.0;
  const int steps = std::max(1, static_cast<int>(std::lround(floor.length() / kShareStep_m)));
  int on = 0;
  for (int i = 0; i < steps; ++i) {
    const Eigen::Vector2d p = floor.a + (i + 0.5) / steps * (floor.b - floor.a);
    on += distanceToSegment(p, along) <= kSameEdge_m;
  }
  return static_cast<double>(on) / steps;
}

/// Counts the drive's sightings on a row. @return whether it saw the row.
bool countAgain(CountedRow& row, const MapHistory& drive) {
  double share = 0.0;
  int most = 0;
  for (const CountedRow& seen : drive.rows) {
    const double on = shareOn(row.row, seen.row);
    if (on <= 0.0) continue;
    share += on;
    most = std::max(most, seen.times_seen);
  }
  if (share < kSeenAgain) return false;
  row.times_seen += most;
  ++row.sessions;
  return true;
}

/// How often the drive saw an edge of its own.
int timesSeen(const MapSegment& row, const MapHistory& drive) {
  int most = 0;
  for (const CountedRow& seen : drive.rows) {
    if (shareOn(row, seen.row) >= kSeenAgain) most = std::max(most, seen.times_seen);
  }
  return most;
}

/// A stretch that goes on where a row ends begins there, so that no gap is left between them.
void continueRows(MapSegment& added, const std::vector<CountedRow>& rows) {
  for (const CountedRow& known : rows) {
    const Segment2 row = known.row.world.floor();
    const Segment2 floor = added.world.floor();
    if (known.row.label != added.label ||
        lineAngleDifference(row.direction(), floor.direction()) > kSameEdge_rad ||
        distanceToLine(floor.middle(), row) > kSameEdge_m)
      continue;
    for (Eigen::Vector3d* end : {&added.world.a, &added.world.b}) {
      for (const Eigen::Vector3d& fixed : {known.row.world.a, known.row.world.b}) {
        if ((end->head<2>() - fixed.head<2>()).norm() <= kContinues_m) *end = fixed;
      }
    }
  }
}

/// Traces of what is gone no longer say that something may be there.
void forgetTraces(const ChangeList& list, std::vector<SeenFloor>& sessions) {
  for (const ListedChange& listed : list.changes) {
    if (listed.decision != Decision::kAccept) continue;
    for (const Segment2& edge : listed.change.before) {
      for (SeenFloor& session : sessions) {
        std::erase_if(session.traces, [&](const FloorTrace& trace) {
          return distanceToSegment(edge.middle(), trace.floor) <= kSameEdge_m &&
                 lineAngleDifference(edge.direction(), trace.floor.direction()) <= kSameEdge_rad;
        });
      }
    }
  }
}

void updateRows(const MapHistory& old, const std::map<Label, Label>& stripes, const ChangeList& list,
                UpdatedMap& updated) {
  for (const CountedRow& row : old.rows) {
    const Segment2 floor = row.row.world.floor();
    // Upright edges are nobody's change.
    if (row.row.world.a.z() > 0.0 || row.row.world.b.z() > 0.0 || floor.length() < kOnRow_m) {
      updated.history.rows.push_back(row);
      ++updated.kept;
      continue;
    }
    const std::vector<Share> stay = staying(row.row, stripes, list);
    const bool is_whole = stay.size() == 1 && stay.front().from <= 0.0 && stay.front().to >= 1.0;
    if (is_whole) {
      updated.history.rows.push_back(row);
      ++updated.kept;
      continue;
    }
    bool has_rest = false;
    for (const Share& share : stay) {
      if ((share.to - share.from) * floor.length() < kLeastRest_m) continue;
      CountedRow rest = row;
      rest.row = rowOf(row.row.label, {floor.a + share.from * (floor.b - floor.a),
                                       floor.a + share.to * (floor.b - floor.a)});
      rest.row.width_m = row.row.width_m;
      updated.history.rows.push_back(std::move(rest));
      has_rest = true;
    }
    ++(has_rest ? updated.cut : updated.gone);
  }
}

}  // namespace

SegmentMap UpdatedMap::map() const {
  SegmentMap map;
  for (const CountedRow& row : history.rows) map.segments.push_back(row.row);
  return map;
}

UpdatedMap updateMap(const MapHistory& old, const std::map<Label, Label>& stripes, const ChangeList& list,
                     const MapHistory& drive_map) {
  const MapHistory drive = transform(list.T_old_map, drive_map);
  UpdatedMap updated;
  updated.history.seen = old.seen;
  updateRows(old, stripes, list, updated);
  std::vector<CountedRow>& rows = updated.history.rows;
  for (CountedRow& row : rows) updated.seen_again += countAgain(row, drive);
  const std::size_t known = rows.size();
  const auto take = [&](MapSegment row, int& count) {
    if (!(row.world.length() > 0.0)) return;
    const int times = timesSeen(row, drive);
    rows.push_back({std::move(row), times, 1});
    ++count;
  };
  for (const ListedChange& listed : list.changes) {
    if (listed.decision != Decision::kAccept) continue;
    for (const Segment2& edge : listed.change.now) take(rowOf(listed.change.label, edge), updated.came);
  }
  const std::vector<CountedRow> before(rows.begin(), rows.begin() + static_cast<std::ptrdiff_t>(known));
  for (const MapSegment& added : list.added) {
    MapSegment row = rowOf(added.label, added.world.floor());
    continueRows(row, before);
    take(std::move(row), updated.added);
  }
  forgetTraces(list, updated.history.seen.sessions);
  updated.history.seen.sessions.insert(updated.history.seen.sessions.end(), drive.seen.sessions.begin(),
                                       drive.seen.sessions.end());
  updated.history.rejected = list.rejected;
  for (const ListedChange& listed : list.changes) {
    if (listed.decision != Decision::kReject) continue;
    for (ChangeFact& fact : factsOf(listed.change)) updated.history.rejected.push_back(std::move(fact));
  }
  return updated;
}

}  // namespace vismem
