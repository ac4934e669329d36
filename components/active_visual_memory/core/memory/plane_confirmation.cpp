#include "active_visual_memory/core/memory/plane_confirmation.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

#include "common/geometry/plane.h"

namespace vismem {
namespace {

/// Whether it is located and has a label, two true ends, a view across the viewing ray, and no parallax off
/// the floor. A censored edge may continue anywhere.
bool mayBeConfirmed(const MemoryElement& element, const CornerParams& params) {
  const FloorLine& line = element.line;
  return !element.plane.stands && element.plane.not_vertical && isLocated(element.value) &&
         element.value.label != kUnknownLabel && !line.endA().censored && !line.endB().censored &&
         line.endA().views >= params.min_views && line.endB().views >= params.min_views &&
         line.length() >= params.least_length_m;
}

double sigmaOf(const MemoryElement& element, double t_m) {
  return std::sqrt(element.line.offsetVariance(t_m));
}

/// Whether `next` continues `edge` in its line, from its end b (or a).
/// @param limit  of confirmContinuations: a share of the distance from the camera.
bool goesOn(const PublishedEdge& edge, const PublishedEdge& next, bool at_b, double limit,
            const CornerParams& params) {
  const ExtentEnd& end = edge.element->line.end(at_b);
  const ExtentEnd& begin = next.element->line.end(!at_b);
  if (end.censored || edge.along.dot(next.along) < std::cos(params.max_line_rad)) return false;
  const Eigen::Vector2d gap = next.place(!at_b) - edge.place(at_b);
  if (std::abs(edge.along.dot(gap)) > params.reach.of(end) + params.reach.of(begin)) return false;
  // Higher edges are projected behind the line by more than the uncertainty of both.
  const Eigen::Vector2d n = turned90(edge.along);
  const double camera = std::abs(n.dot(next.element->plane.anchor_camera - edge.line.a));
  double off = 0.0;
  for (const Eigen::Vector2d& p : {next.line.a, next.line.b})
    off = std::max(off, std::abs(n.dot(p - edge.line.a)));
  const double sigma = std::hypot(sigmaOf(*edge.element, end.t_m), sigmaOf(*next.element, 0.0));
  return off + params.sigmas * sigma + params.slack_m <= limit * camera;
}

/// Whether `next` begins at a corner where `edge` ends.
bool turnsAway(const PublishedEdge& edge, const PublishedEdge& next, bool at_b, double limit,
               const CornerParams& params) {
  if (edge.published->label != next.published->label) return false;
  const auto corner = at_b ? findCorner(edge, next, params) : findCorner(next, edge, params);
  if (!corner) return false;
  const double distance = (corner->place - next.element->plane.anchor_camera).norm();
  const double sigma =
      std::sqrt(edge.element->line.end(at_b).best_m2 + next.element->line.end(!at_b).best_m2);
  return corner->distance_m + params.sigmas * sigma + params.slack_m <= limit * distance;
}

}  // namespace

void confirmContinuations(std::span<MemoryElement> elements, double limit, const CornerParams& params,
                          std::pmr::memory_resource* scratch) {
  std::pmr::vector<PublishedEdge> confirmed(scratch);
  std::pmr::vector<PublishedEdge> others(scratch);
  for (MemoryElement& element : elements) {
    if (element.value.confirmed) {
      confirmed.emplace_back(element.value, &element);
    } else if (mayBeConfirmed(element, params)) {
      others.emplace_back(element.value, &element);
    }
  }
  constexpr bool kEnds[] = {true, false};
  for (std::size_t c = 0; c < confirmed.size(); ++c) {
    const PublishedEdge edge = confirmed[c];
    std::erase_if(others, [&](const PublishedEdge& next) {
      const bool held = std::any_of(std::begin(kEnds), std::end(kEnds), [&](bool at_b) {
        return goesOn(edge, next, at_b, limit, params) || turnsAway(edge, next, at_b, limit, params);
      });
      if (held) {
        next.published->confirmed = true;
        confirmed.push_back(next);
      }
      return held;
    });
  }
}

}  // namespace vismem
