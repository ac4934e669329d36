#include <algorithm>
#include <cmath>
#include <optional>

#include "active_visual_memory/core/primitives/finders.h"
#include "common/geometry/plane.h"
#include "common/visual_memory/labels.h"

namespace vismem {
namespace {

struct Head {
  int stroke = 0;
  double angle = 0.0;                             ///< from the shaft, > 0 counter-clockwise
  Eigen::Vector2d tip = Eigen::Vector2d::Zero();  ///< intersection with the line of the shaft
  Eigen::Vector2d end = Eigen::Vector2d::Zero();
  double length = 0.0;
};

/// The strokes that may be heads at one end of a shaft.
std::pmr::vector<Head> headsAt(std::span<const FloorEdge> strokes, std::size_t s, int end,
                               const ArrowParams& params, std::pmr::memory_resource* scratch) {
  const FloorEdge& shaft = strokes[s];
  const Eigen::Vector2d shaft_end = shaft.end(end);
  const Eigen::Vector2d backwards = shaft.inward(end);
  std::pmr::vector<Head> heads(scratch);
  for (std::size_t h = 0; h < strokes.size(); ++h) {
    const FloorEdge& head = strokes[h];
    if (h == s || head.length < params.min_head_m || head.length * params.shaft_ratio > shaft.length)
      continue;
    if (shareIds(head.segments, shaft.segments) || !labelsCompatible(head.label, shaft.label)) continue;
    const int near =
        (head.line.a - shaft_end).squaredNorm() <= (head.line.b - shaft_end).squaredNorm() ? 0 : 1;
    const double reach = params.gap_m + 0.5 * (head.width_m + shaft.width_m);
    const auto place = intersection(head, shaft);
    if (!place || (*place - shaft_end).norm() > reach || (*place - head.end(near)).norm() > reach) continue;
    const Eigen::Vector2d away = head.inward(near);
    const double angle = std::atan2(cross2(backwards, away), backwards.dot(away));
    if (std::abs(angle) < params.min_head_rad || std::abs(angle) > params.max_head_rad) continue;
    heads.push_back({static_cast<int>(h), angle, *place, head.end(1 - near), head.length});
  }
  return heads;
}

/// The arrow of a shaft and two heads at one of its ends, if they are symmetric.
std::optional<Primitive> arrowOf(std::span<const FloorEdge> strokes, const FloorEdge& shaft, int end,
                                 const Head& one, const Head& two, const ArrowParams& params,
                                 std::pmr::memory_resource* scratch) {
  if (std::abs(one.angle + two.angle) > params.symmetry_rad) return std::nullopt;
  const double ratio = std::min(one.length, two.length) / std::max(one.length, two.length);
  if (ratio < params.head_ratio) return std::nullopt;
  if (shareIds(strokes[one.stroke].segments, strokes[two.stroke].segments)) return std::nullopt;
  // In the pointing direction the left head lies clockwise of the way back.
  const Head& left = one.angle < 0.0 ? one : two;
  const Head& right = one.angle < 0.0 ? two : one;
  const Eigen::Vector2d backwards = shaft.inward(end);
  Primitive primitive;
  primitive.kind = PrimitiveKind::kArrow;
  // A painted shaft ends where the heads begin; its middle line continues to the tip.
  const Eigen::Vector2d tip = 0.5 * (one.tip + two.tip);
  primitive.vertices = {tip, shaft.end(1 - end), left.end, right.end};
  primitive.centre = 0.5 * (tip + shaft.end(1 - end));
  primitive.heading_rad = std::atan2(-backwards.y(), -backwards.x());
  primitive.length_m = (tip - shaft.end(1 - end)).norm();
  primitive.width_m = (left.end - right.end).norm();
  primitive.quality = 1.0 - 0.5 * std::abs(one.angle + two.angle) / params.symmetry_rad -
                      0.5 * (1.0 - ratio) / (1.0 - params.head_ratio);
  const SegmentIds heads = joinedIds(strokes[one.stroke].segments, strokes[two.stroke].segments, scratch);
  const SegmentIds all = joinedIds(shaft.segments, heads, scratch);
  primitive.segments.assign(all.begin(), all.end());
  return primitive;
}

}  // namespace

Shapes findArrows(std::span<const FloorEdge> strokes, const ArrowParams& params, double max_shaft_m,
                  std::pmr::memory_resource* scratch) {
  Shapes found(scratch);
  for (std::size_t s = 0; s < strokes.size(); ++s) {
    if (strokes[s].length > max_shaft_m) continue;
    for (int end = 0; end < 2; ++end) {
      const std::pmr::vector<Head> heads = headsAt(strokes, s, end, params, scratch);
      for (std::size_t m = 0; m < heads.size(); ++m) {
        for (std::size_t n = m + 1; n < heads.size(); ++n) {
          if (const auto arrow = arrowOf(strokes, strokes[s], end, heads[m], heads[n], params, scratch)) {
            found.push_back(*arrow);
          }
        }
      }
    }
  }
  return found;
}

}  // namespace vismem
