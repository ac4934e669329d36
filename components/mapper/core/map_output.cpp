#include "mapper/core/map_output.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "common/geometry/angles.h"
#include "common/geometry/plane.h"
#include "common/geometry/rounding.h"

namespace vismem {
namespace {

Eigen::Vector3d onFloor(const Eigen::Vector2d& p) {
  return {rounded(p.x(), 1e3), rounded(p.y(), 1e3), 0.0};  // in millimetres
}

void setRow(MappedRow& row, const Segment2& map) {
  row.map = map;
  row.updateWorld();
}

/// Two edges beside each other with opposite polarity.
struct Pair {
  double width_m = 0.0;
  double skew_begin_m = 0.0;  ///< from end a of one to end b of the other, along one
  double skew_end_m = 0.0;
  double overlap_m = 0.0;
};

std::optional<Pair> pairOf(const MappedRow& one, const MappedRow& other, const MapOutputParams& params) {
  if (one.row.label != other.row.label || one.derived || other.derived) return std::nullopt;
  if (one.is_chord || other.is_chord) return std::nullopt;
  const Eigen::Vector2d u = (one.map.b - one.map.a).normalized();
  if (u.dot(other.map.b - other.map.a) >= 0.0) return std::nullopt;
  if (lineAngleDifference(one.map.direction(), other.map.direction()) > params.stripe_angle_rad) {
    return std::nullopt;
  }
  const auto t = [&](const Eigen::Vector2d& p) { return u.dot(p - one.map.a); };
  Pair pair;
  pair.width_m =
      0.5 * (std::abs(cross2(u, other.map.a - one.map.a)) + std::abs(cross2(u, other.map.b - one.map.a)));
  pair.skew_begin_m = t(other.map.b);
  pair.skew_end_m = t(other.map.a) - one.map.length();
  pair.overlap_m = std::min(one.map.length(), t(other.map.a)) - std::max(0.0, t(other.map.b));
  if (pair.width_m < params.stripe_least_m || pair.width_m > params.stripe_most_m) return std::nullopt;
  if (pair.overlap_m <= 0.0) return std::nullopt;
  return pair;
}

/// A line ends squarely: both its edges end at the same place along it. @return that edge of the end.
MappedRow squareEnd(MappedRow& one, bool one_at_b, MappedRow& other) {
  Segment2 edge = one.map;
  Segment2 facing = other.map;
  Eigen::Vector2d& end = one_at_b ? edge.b : edge.a;
  Eigen::Vector2d& end_facing = one_at_b ? facing.a : facing.b;
  const Eigen::Vector2d u = (edge.b - edge.a).normalized();
  const double mine = std::max(1, one.times_seen);
  const double its = std::max(1, other.times_seen);
  const double skew = u.dot(end_facing - end);
  end += skew * its / (mine + its) * u;
  end_facing -= skew * mine / (mine + its) * u;
  MappedRow row = one;
  row.derived = true;
  row.closed_a = row.closed_b = true;
  setRow(row, one_at_b ? Segment2{end, end_facing} : Segment2{end_facing, end});
  setRow(one, edge);
  setRow(other, facing);
  return row;
}

/// Whether a further edge of the label ends near a place: a line goes on there, or its end was seen.
bool hasOtherEnd(const std::vector<MappedRow>& rows, std::size_t one, std::size_t other,
                 const Eigen::Vector2d& at, double reach_m) {
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (k == one || k == other || rows[k].derived || rows[k].row.label != rows[one].row.label) continue;
    if (std::min((rows[k].map.a - at).norm(), (rows[k].map.b - at).norm()) <= reach_m) return true;
  }
  return false;
}

}  // namespace

void MappedRow::updateWorld() {
  row.world = {onFloor(map.a), onFloor(map.b)};
}

Pose2 mapFrameOf(const MapState& state) {
  double longest = 0.0;
  double direction = 0.0;
  for (const LineLandmark& landmark : state.landmarks) {
    const Segment2 world = state.worldSegment(landmark);
    if (landmark.label == kUnknownLabel || world.length() <= longest) continue;
    longest = world.length();
    direction = world.direction();
  }
  if (state.poses.empty()) return {};
  const Eigen::Vector2d start = state.poses.front().position();
  // Of the two senses the one nearer to the robot's first heading.
  if (std::cos(direction - state.poses.front().theta) < 0.0) direction += degToRad(180.0);
  return inverse(Pose2{start.x(), start.y(), wrapAngle(direction)});
}

std::vector<MappedRow> rowsOf(const MapState& state, const Pose2& T_map_world,
                              const MapOutputParams& params) {
  std::vector<MappedRow> rows;
  for (const LineLandmark& landmark : state.landmarks) {
    if (landmark.label == kUnknownLabel || landmark.b.t_m - landmark.a.t_m < params.min_length_m) continue;
    MappedRow row;
    row.id = landmark.id;
    row.row.label = landmark.label;
    row.closed_a = landmark.a.closed;
    row.closed_b = landmark.b.closed;
    row.across_sigma_m = std::sqrt(landmark.P_line(0, 0));
    row.direction_sigma_rad = std::sqrt(landmark.P_line(1, 1));
    row.sigma_a_m = landmark.sigma_a_m;
    row.sigma_b_m = landmark.sigma_b_m;
    row.times_seen = static_cast<int>(landmark.seen.size());
    row.sessions = landmark.sessions;
    row.is_chord = landmark.isChord();
    setRow(row, transform(T_map_world, state.worldSegment(landmark)));
    rows.push_back(std::move(row));
  }
  return rows;
}

void addStripeEnds(std::vector<MappedRow>& rows, const MapOutputParams& params) {
  const std::size_t edges = rows.size();
  for (std::size_t i = 0; i < edges; ++i) {
    for (std::size_t j = i + 1; j < edges; ++j) {
      const auto pair = pairOf(rows[i], rows[j], params);
      if (!pair) continue;
      const auto add = [&](bool at_b, double skew_m) {
        const bool is_closed =
            at_b ? rows[i].closed_b && rows[j].closed_a : rows[i].closed_a && rows[j].closed_b;
        if (!is_closed || std::abs(skew_m) > params.stripe_skew_m) return;
        const Eigen::Vector2d at = at_b ? rows[i].map.b : rows[i].map.a;
        const Eigen::Vector2d facing = at_b ? rows[j].map.a : rows[j].map.b;
        for (const Eigen::Vector2d& end : {at, facing}) {
          if (hasOtherEnd(rows, i, j, end, params.stripe_skew_m)) return;
        }
        rows.push_back(squareEnd(rows[i], at_b, rows[j]));
      };
      add(false, pair->skew_begin_m);
      add(true, pair->skew_end_m);
    }
  }
}

void joinIntoStripes(std::vector<MappedRow>& rows, const std::map<Label, Label>& stripe_edges,
                     const MapOutputParams& params) {
  constexpr double kLeastShare = 0.7;
  constexpr double kLeastWidth_m = 0.03;  // of a stripe in drawings
  for (const auto& [stripe, edge] : stripe_edges) {
    for (std::size_t i = 0; i < rows.size(); ++i) {
      for (std::size_t j = i + 1; j < rows.size(); ++j) {
        if (rows[i].row.label != edge) break;
        const auto pair = pairOf(rows[i], rows[j], params);
        if (!pair || pair->width_m < kLeastWidth_m) continue;
        if (pair->overlap_m < kLeastShare * std::max(rows[i].map.length(), rows[j].map.length())) continue;
        MappedRow& one = rows[i];
        const MappedRow other = rows[j];
        setRow(one, {0.5 * (one.map.a + other.map.b), 0.5 * (one.map.b + other.map.a)});
        one.row.label = stripe;
        one.row.width_m = rounded(pair->width_m, 1e3);
        one.times_seen = std::min(one.times_seen, other.times_seen);
        rows.erase(rows.begin() + static_cast<std::ptrdiff_t>(j));
        break;
      }
    }
  }
}

SegmentMap segmentMapOf(const std::vector<MappedRow>& rows) {
  SegmentMap map;
  for (const MappedRow& row : rows) {
    if (row.row.world.length() > 0.0) map.segments.push_back(row.row);
  }
  return map;
}

}  // namespace vismem
