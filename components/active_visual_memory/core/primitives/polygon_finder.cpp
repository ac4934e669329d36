#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <numbers>
#include <optional>

#include "active_visual_memory/core/primitives/finders.h"
#include "common/geometry/angles.h"
#include "common/geometry/plane.h"
#include "common/visual_memory/labels.h"

namespace vismem {
namespace {

struct Corner {
  int other = 0;      ///< the other edge of the corner
  int other_end = 0;  ///< and its end there
  Eigen::Vector2d place = Eigen::Vector2d::Zero();
  double gap_share = 0.0;  ///< of the ends from the corner, relative to what is allowed
};

/// Corners per edge and end, those of both ends of an edge one behind the other.
using Corners = std::pmr::vector<std::pmr::vector<Corner>>;

double allowedGap(const FloorEdge& edge, double other_width_m, const PolygonParams& params) {
  return params.corner_gap_m + 0.5 * other_width_m + params.corner_share * edge.length;
}

Corners findCorners(const FloorEdges& edges, const PolygonParams& params) {
  Corners corners(2 * edges.size(), edges.get_allocator());
  for (std::size_t i = 0; i < edges.size(); ++i) {
    for (std::size_t j = i + 1; j < edges.size(); ++j) {
      const FloorEdge& a = edges[i];
      const FloorEdge& b = edges[j];
      const double gap_a = allowedGap(a, b.width_m, params);
      const double gap_b = allowedGap(b, a.width_m, params);
      for (int end_a = 0; end_a < 2; ++end_a) {
        for (int end_b = 0; end_b < 2; ++end_b) {
          if ((a.end(end_a) - b.end(end_b)).squaredNorm() > (gap_a + gap_b) * (gap_a + gap_b)) continue;
          const double angle = std::acos(std::clamp(a.inward(end_a).dot(b.inward(end_b)), -1.0, 1.0));
          if (angle < params.min_corner_rad || angle > std::numbers::pi - params.min_corner_rad) continue;
          const auto place = intersection(a, b);
          if (!place) continue;
          const double off_a = (*place - a.end(end_a)).norm();
          const double off_b = (*place - b.end(end_b)).norm();
          if (off_a > gap_a || off_b > gap_b) continue;
          if (!labelsCompatible(a.label, b.label) || shareIds(a.segments, b.segments)) continue;
          const double share = 0.5 * (off_a / gap_a + off_b / gap_b);
          corners[2 * i + end_a].push_back({static_cast<int>(j), end_b, *place, share});
          corners[2 * j + end_b].push_back({static_cast<int>(i), end_a, *place, share});
        }
      }
    }
  }
  return corners;
}

/// Adds sides of two collinear pieces with an occlusion between them.
void addBrokenSides(FloorEdges& edges, const PolygonParams& params, std::pmr::memory_resource* scratch) {
  const std::size_t originals = edges.size();
  for (std::size_t i = 0; i < originals; ++i) {
    for (std::size_t j = i + 1; j < originals; ++j) {
      const FloorEdge& a = edges[i];
      const FloorEdge& b = edges[j];
      // One side has one polarity.
      if (a.along.dot(b.along) < std::cos(params.broken_angle_rad)) continue;
      const bool a_first = a.along.dot(b.line.middle() - a.line.middle()) > 0.0;
      const FloorEdge& first = a_first ? a : b;
      const FloorEdge& second = a_first ? b : a;
      const Eigen::Vector2d hole = second.line.a - first.line.b;
      const double gap = first.along.dot(hole);
      if (gap < -params.corner_gap_m || gap > params.broken_gap_m) continue;
      const Segment2 whole{first.line.a, second.line.b};
      const double length = whole.length();
      if (length > params.max_side_m || !labelsCompatible(a.label, b.label)) continue;
      if (distanceToLine(first.line.b, whole) > params.broken_offset_m ||
          distanceToLine(second.line.a, whole) > params.broken_offset_m) {
        continue;
      }
      if (const auto side =
              makeFloorEdge(whole, a.label == kUnknownLabel ? b.label : a.label,
                            joinedIds(a.segments, b.segments, scratch), std::max(a.width_m, b.width_m))) {
        edges.push_back(*side);
      }
    }
  }
}

/// Which side of the edge is the brighter one when it is walked from `from`: +1 left, -1 right, 0 both (a
/// stripe).
int polarityFrom(const FloorEdge& edge, int from_end) {
  if (edge.isStripe()) return 0;
  return from_end == 0 ? 1 : -1;
}

bool agree(std::initializer_list<int> polarities) {
  int known = 0;
  for (const int p : polarities) {
    if (p == 0) continue;
    if (known != 0 && p != known) return false;
    known = p;
  }
  return true;
}

/// Puts the corners counter-clockwise, the hidden one with them.
void orient(Primitive& primitive) {
  double area = 0.0;
  const std::size_t n = primitive.vertices.size();
  for (std::size_t i = 0; i < n; ++i) area += cross2(primitive.vertices[i], primitive.vertices[(i + 1) % n]);
  if (area >= 0.0) return;
  std::reverse(primitive.vertices.begin(), primitive.vertices.end());
  if (primitive.hidden_vertex >= 0)
    primitive.hidden_vertex = static_cast<int>(n) - 1 - primitive.hidden_vertex;
}

void measureParallelogram(Primitive& primitive) {
  const Eigen::Vector2d u =
      0.5 * (primitive.vertices[1] - primitive.vertices[0] + primitive.vertices[2] - primitive.vertices[3]);
  const Eigen::Vector2d v =
      0.5 * (primitive.vertices[3] - primitive.vertices[0] + primitive.vertices[2] - primitive.vertices[1]);
  const Eigen::Vector2d& longer = u.norm() >= v.norm() ? u : v;
  primitive.length_m = longer.norm();
  primitive.width_m = std::min(u.norm(), v.norm());
  primitive.heading_rad = std::atan2(longer.y(), longer.x());
  if (primitive.heading_rad < 0.0) primitive.heading_rad += std::numbers::pi;
}

/// Sets what follows from corners and sides.
void finish(Primitive& primitive, std::initializer_list<const FloorEdge*> sides,
            std::pmr::memory_resource* scratch) {
  SegmentIds ids;
  for (const FloorEdge* side : sides) ids = joinedIds(ids, side->segments, scratch);
  primitive.segments.assign(ids.begin(), ids.end());
  orient(primitive);
  primitive.centre.setZero();
  for (const auto& v : primitive.vertices) primitive.centre += v;
  primitive.centre /= static_cast<double>(primitive.vertices.size());
  if (primitive.kind == PrimitiveKind::kParallelogram) measureParallelogram(primitive);
}

class PolygonSearch {
 public:
  PolygonSearch(const FloorEdges& edges, const Corners& corners, const PolygonParams& params)
      : edges_(edges), corners_(corners), params_(params) {}

  /// Searches shapes on a base with a corner at either end.
  void from(int base, Shapes& found) const {
    for (const Corner& left : cornersAt(base, 0)) {
      for (const Corner& right : cornersAt(base, 1)) {
        if (left.other == right.other) continue;
        triangle(base, left, right, found);
        const FloorEdge& a = edges_[left.other];
        const FloorEdge& b = edges_[right.other];
        if (shareIds(a.segments, b.segments)) continue;
        const Eigen::Vector2d up_a = a.inward(left.other_end);
        const Eigen::Vector2d up_b = b.inward(right.other_end);
        if (up_a.dot(up_b) < std::cos(params_.parallel_rad)) continue;
        // Three corners make the shape: the fourth may be hidden, at the top of either upright.
        for (const Corner& far : cornersAt(right.other, 1 - right.other_end)) {
          close(base, left, right, far, false, found);
        }
        for (const Corner& far : cornersAt(left.other, 1 - left.other_end)) {
          close(base, left, right, far, true, found);
        }
      }
    }
  }

 private:
  std::span<const Corner> cornersAt(int edge, int end) const { return corners_[2 * edge + end]; }
  bool sideFits(double length) const { return length >= params_.min_side_m && length <= params_.max_side_m; }

  /// @param from_left the far side begins at the left upright.
  void close(int base, const Corner& left, const Corner& right, const Corner& far, bool from_left,
             Shapes& found) const {
    const FloorEdge& i = edges_[base];
    const FloorEdge& near_upright = edges_[from_left ? left.other : right.other];
    const FloorEdge& far_upright = edges_[from_left ? right.other : left.other];
    const Corner& far_foot = from_left ? right : left;  // where the far upright stands on the base
    const Corner& near_foot = from_left ? left : right;
    const FloorEdge& across = edges_[far.other];
    if (far.other == base || shareIds(across.segments, i.segments) ||
        shareIds(across.segments, far_upright.segments) || shareIds(across.segments, near_upright.segments)) {
      return;
    }
    // Parallel to the base, and running back over it.
    const Eigen::Vector2d back = across.inward(far.other_end);
    const Eigen::Vector2d base_back = from_left ? i.along : Eigen::Vector2d(-i.along);
    if (back.dot(base_back) < std::cos(params_.parallel_rad)) return;

    const auto place = intersection(far_upright, across);
    if (!place) return;
    const Eigen::Vector2d p0 = near_foot.place, p1 = far_foot.place, p2 = far.place, p3 = *place;
    const double base_length = (p1 - p0).norm();
    const double upright_length = (p2 - p0).norm();
    if (!sideFits(base_length) || !sideFits(upright_length)) return;
    const double allowed = params_.closing_m + params_.closing_share * std::max(base_length, upright_length);
    const double closing = (p3 - (p1 + p2 - p0)).norm();
    if (closing > allowed) return;

    // Whether the far upright reaches the far side, or that corner is hidden.
    const int upright_top = 1 - far_foot.other_end;
    const int across_end = 1 - far.other_end;
    const double off_upright = far_upright.inward(far_foot.other_end).dot(p3 - far_upright.end(upright_top));
    const double off_across = back.dot(p3 - across.end(across_end));
    const double gap_upright = allowedGap(far_upright, across.width_m, params_);
    const double gap_across = allowedGap(across, far_upright.width_m, params_);
    if (off_upright < -gap_upright || off_across < -gap_across) return;  // it goes on beyond the corner
    const bool closed = off_upright <= gap_upright && off_across <= gap_across;
    if (!agree({polarityFrom(i, from_left ? 0 : 1), polarityFrom(far_upright, far_foot.other_end),
                polarityFrom(across, across_end), polarityFrom(near_upright, 1 - near_foot.other_end)})) {
      return;
    }
    Primitive& primitive = found.emplace_back();
    primitive.kind = PrimitiveKind::kParallelogram;
    primitive.vertices = {p0, p1, p3, p2};
    primitive.hidden_vertex = closed ? -1 : 2;
    const double gaps = (near_foot.gap_share + far_foot.gap_share + far.gap_share) / 3.0;
    primitive.quality = (closed ? 1.0 : 0.7) * (1.0 - 0.5 * closing / allowed - 0.4 * gaps);
    finish(primitive, {&i, &near_upright, &far_upright, &across}, edges_.get_allocator().resource());
  }

  void triangle(int base, const Corner& left, const Corner& right, Shapes& found) const {
    const FloorEdge& i = edges_[base];
    const FloorEdge& a = edges_[left.other];
    const FloorEdge& b = edges_[right.other];
    if (left.other <= base || right.other <= base || shareIds(a.segments, b.segments))
      return;  // once per triangle
    for (const Corner& top : cornersAt(left.other, 1 - left.other_end)) {
      if (top.other != right.other || top.other_end != 1 - right.other_end) continue;
      const Eigen::Vector2d p0 = left.place, p1 = right.place, p2 = top.place;
      if (!sideFits((p1 - p0).norm()) || !sideFits((p2 - p1).norm()) || !sideFits((p0 - p2).norm())) return;
      if (!agree({polarityFrom(i, 0), polarityFrom(b, right.other_end), polarityFrom(a, 1 - left.other_end)}))
        return;
      Primitive& primitive = found.emplace_back();
      primitive.kind = PrimitiveKind::kTriangle;
      primitive.vertices = {p0, p1, p2};
      primitive.quality = 1.0 - (left.gap_share + right.gap_share + top.gap_share) / 3.0 * 0.6;
      finish(primitive, {&i, &a, &b}, edges_.get_allocator().resource());
    }
  }

  const FloorEdges& edges_;
  const Corners& corners_;
  const PolygonParams& params_;
};

}  // namespace

Shapes findPolygons(std::span<const FloorEdge> edges, const PolygonParams& params,
                    std::pmr::memory_resource* scratch) {
  FloorEdges sides(scratch);
  for (const FloorEdge& edge : edges) {
    if (edge.length <= params.max_side_m) sides.push_back(edge);
  }
  addBrokenSides(sides, params, scratch);
  const Corners corners = findCorners(sides, params);
  const PolygonSearch search(sides, corners, params);
  Shapes found(scratch);
  for (std::size_t i = 0; i < sides.size(); ++i) {
    if (sides[i].length >= 0.5 * params.min_side_m) search.from(static_cast<int>(i), found);
  }
  return found;
}

}  // namespace vismem
