#include "active_visual_memory/core/corners.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/geometry/angles.h"

namespace vismem {
namespace {

struct Edge {
  MemorySegment* told = nullptr;
  const MemoryElement* element = nullptr;
  Segment2 line;
  Eigen::Vector2d along;
};

/// Where the end b of one edge meets the end a of another one.
struct Meeting {
  std::size_t from = 0;
  std::size_t to = 0;
  Eigen::Vector2d corner;
  double distance_m = 0.0;  ///< of both ends from it, together
};

Edge edgeOf(MemorySegment& told, const MemoryElement& element) {
  const Segment2 line = told.odom.floor();
  return {&told, &element, line, (line.b - line.a).normalized()};
}

double reachOf(const ExtentEnd& end, const CornerParams& params) {
  return std::min(params.most_reach_m, params.reach_m + params.reach_sigmas * std::sqrt(end.best_m2));
}

bool meet(const Edge& one, const Edge& other, const CornerParams& params, Meeting& meeting) {
  if (one.element->line.endB().open || other.element->line.endA().open) return false;
  if ((one.line.b - other.line.a).norm() > 2.0 * params.most_reach_m) return false;
  const double cross = one.along.x() * other.along.y() - one.along.y() * other.along.x();
  if (std::abs(cross) < std::sin(params.min_angle_rad)) return false;
  const Eigen::Vector2d between = other.line.a - one.line.b;
  const double outward_one = (between.x() * other.along.y() - between.y() * other.along.x()) / cross;
  const double outward_other = (between.x() * one.along.y() - between.y() * one.along.x()) / cross;
  if (std::abs(outward_one) > reachOf(one.element->line.endB(), params) ||
      std::abs(outward_other) > reachOf(other.element->line.endA(), params)) {
    return false;
  }
  meeting.corner = one.line.b + outward_one * one.along;
  meeting.distance_m = std::abs(outward_one) + std::abs(outward_other);
  return true;
}

}  // namespace

void confirmBetweenCorners(std::span<MemoryElement> elements, const CornerParams& params) {
  if (!params.enabled) return;
  std::vector<Edge> confirmed;
  for (MemoryElement& element : elements) {
    if (element.value.confirmed) confirmed.push_back(edgeOf(element.value, element));
  }
  for (MemoryElement& element : elements) {
    const FloorLine& line = element.line;
    const bool known = !line.endA().open && !line.endB().open && line.endA().views >= params.min_views &&
                       line.endB().views >= params.min_views && line.length() >= params.min_length_m;
    if (element.value.confirmed || element.stands || !known || element.value.label == kUnknownLabel) continue;
    const Edge edge = edgeOf(element.value, element);
    Meeting meeting;
    const Edge* before = nullptr;
    const Edge* behind = nullptr;
    for (const Edge& other : confirmed) {
      if (other.told->label != element.value.label) continue;
      if (!before && meet(other, edge, params, meeting)) before = &other;
      if (!behind && meet(edge, other, params, meeting)) behind = &other;
    }
    element.value.confirmed = before && behind && before != behind;
  }
}

void meetAtCorners(std::vector<MemorySegment>& segments, std::span<const MemoryElement> elements,
                   const CornerParams& params) {
  if (!params.enabled) return;
  std::vector<Edge> edges;
  for (MemorySegment& segment : segments) {
    if (!segment.confirmed) continue;
    const auto element = std::find_if(elements.begin(), elements.end(),
                                      [&](const MemoryElement& e) { return e.value.id == segment.id; });
    if (element == elements.end()) continue;
    edges.push_back(edgeOf(segment, *element));
  }
  std::vector<Meeting> meetings;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    for (std::size_t k = 0; k < edges.size(); ++k) {
      Meeting meeting;
      if (i == k || !meet(edges[i], edges[k], params, meeting)) continue;
      meeting.from = i;
      meeting.to = k;
      meetings.push_back(meeting);
    }
  }
  // The nearest first; an end meets one other end.
  std::stable_sort(meetings.begin(), meetings.end(),
                   [](const Meeting& a, const Meeting& b) { return a.distance_m < b.distance_m; });
  std::vector<bool> ended(edges.size(), false);
  std::vector<bool> begun(edges.size(), false);
  for (const Meeting& meeting : meetings) {
    if (ended[meeting.from] || begun[meeting.to]) continue;
    ended[meeting.from] = begun[meeting.to] = true;
    const Eigen::Vector3d corner{meeting.corner.x(), meeting.corner.y(), 0.0};
    edges[meeting.from].told->odom.b = corner;
    edges[meeting.to].told->odom.a = corner;
  }
}

}  // namespace vismem
