#include "active_visual_memory/core/corners.h"

#include <algorithm>
#include <cmath>
#include <iterator>
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

/// Has it a label, both ends seen, and was it never seen to stand? Of what the border or the range cut nobody
/// knows where it ends.
bool mayBeConfirmed(const MemoryElement& element, double least_length_m, const CornerParams& params) {
  const FloorLine& line = element.line;
  return !element.stands && element.value.label != kUnknownLabel && !line.endA().open && !line.endB().open &&
         line.endA().views >= params.min_views && line.endB().views >= params.min_views &&
         line.length() >= least_length_m;
}

double sigmaOf(const MemoryElement& element, double t_m) {
  return std::sqrt(element.line.offsetVariance(t_m));
}

/// Does `next` go on in the line of `edge`, from its end b (or a)? @param limit of what counts as lying on
/// the floor, as a share of the distance from the camera.
bool goesOn(const Edge& edge, const Edge& next, bool at_b, double limit, const CornerParams& params) {
  const FloorLine& line = edge.element->line;
  const ExtentEnd& end = at_b ? line.endB() : line.endA();
  const ExtentEnd& begin = at_b ? next.element->line.endA() : next.element->line.endB();
  if (end.open) return false;
  if (edge.along.dot(next.along) < std::cos(params.max_line_rad)) return false;
  const Eigen::Vector2d gap =
      at_b ? Eigen::Vector2d(next.line.a - edge.line.b) : Eigen::Vector2d(edge.line.a - next.line.b);
  if (std::abs(edge.along.dot(gap)) > reachOf(end, params) + reachOf(begin, params)) return false;
  // Higher edges lie further from the camera than the line. What is not known of either must not hide that.
  const Eigen::Vector2d n{-edge.along.y(), edge.along.x()};
  const double camera = std::abs(n.dot(next.element->anchor_camera - edge.line.a));
  const double t_end = at_b ? line.endB().t_m : line.endA().t_m;
  double off = 0.0;
  for (const Eigen::Vector2d& p : {next.line.a, next.line.b})
    off = std::max(off, std::abs(n.dot(p - edge.line.a)));
  const double sigma = std::hypot(sigmaOf(*edge.element, t_end), sigmaOf(*next.element, 0.0));
  return off + params.sigmas * sigma + params.slack_m <= limit * camera;
}

/// Does `next` begin where `edge` ends, at a corner?
bool turnsAway(const Edge& edge, const Edge& next, bool at_b, double limit, const CornerParams& params) {
  if (edge.told->label != next.told->label) return false;
  const ExtentEnd& begin = at_b ? next.element->line.endA() : next.element->line.endB();
  Meeting meeting;
  if (!(at_b ? meet(edge, next, params, meeting) : meet(next, edge, params, meeting))) return false;
  const double distance = (meeting.corner - next.element->anchor_camera).norm();
  const ExtentEnd& end = at_b ? edge.element->line.endB() : edge.element->line.endA();
  const double sigma = std::sqrt(end.best_m2 + begin.best_m2);
  return meeting.distance_m + params.sigmas * sigma + params.slack_m <= limit * distance;
}

}  // namespace

void confirmBetweenCorners(std::span<MemoryElement> elements, const CornerParams& params) {
  if (!params.enabled) return;
  std::vector<Edge> confirmed;
  for (MemoryElement& element : elements) {
    if (element.value.confirmed) confirmed.push_back(edgeOf(element.value, element));
  }
  for (MemoryElement& element : elements) {
    if (element.value.confirmed || !mayBeConfirmed(element, params.min_length_m, params)) continue;
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

void confirmContinuations(std::span<MemoryElement> elements, double camera_height_m,
                          const CornerParams& params) {
  if (!params.enabled || camera_height_m <= params.least_height_m) return;
  const double limit = params.least_height_m / (camera_height_m - params.least_height_m);
  std::vector<Edge> confirmed;
  std::vector<Edge> others;
  for (MemoryElement& element : elements) {
    if (element.value.confirmed) {
      confirmed.push_back(edgeOf(element.value, element));
    } else if (mayBeConfirmed(element, params.least_length_m, params) && element.not_vertical) {
      others.push_back(edgeOf(element.value, element));
    }
  }
  constexpr bool kEnds[] = {true, false};
  for (std::size_t c = 0; c < confirmed.size(); ++c) {
    const Edge edge = confirmed[c];
    std::erase_if(others, [&](const Edge& next) {
      const bool held = std::any_of(std::begin(kEnds), std::end(kEnds), [&](bool at_b) {
        return goesOn(edge, next, at_b, limit, params) || turnsAway(edge, next, at_b, limit, params);
      });
      if (held) {
        next.told->confirmed = true;
        confirmed.push_back(next);
      }
      return held;
    });
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
