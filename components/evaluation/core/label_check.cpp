#include "evaluation/core/label_check.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "common/geometry/angles.h"
#include "common/geometry/projection.h"
#include "evaluation/core/surveyed_floor.h"

namespace vismem {
namespace {

constexpr int kDepthSteps = 64;  // along an edge, to find the point that a pixel shows

/// Share of `segment` that lies beside `edge`.
double overlap(const Segment2& segment, const Segment2& edge) {
  const auto [low, high] =
      std::minmax({projectionFraction(segment.a, edge), projectionFraction(segment.b, edge)});
  const double inside = std::min(1.0, high) - std::max(0.0, low);
  return high > low ? std::max(0.0, inside) / (high - low) : 0.0;
}

/// Mean distance of the segment's ends from the edge's line [px]; empty when it does not lie on the edge.
std::optional<double> distanceTo(const Segment2& edge, const Segment2& segment,
                                 const LabelCheckParams& params) {
  if (lineAngleDifference(edge.direction(), segment.direction()) > params.angle_rad) return std::nullopt;
  const double a = distanceToLine(segment.a, edge);
  const double b = distanceToLine(segment.b, edge);
  if (std::max(a, b) > params.distance_px || overlap(segment, edge) < params.least_overlap)
    return std::nullopt;
  return 0.5 * (a + b);
}

/// Point of the edge whose image is nearest to a pixel.
Eigen::Vector3d pointAt(const Segment3& edge, const CameraIntrinsics& k, const Pose3& T_camera_world,
                        const Eigen::Vector2d& px) {
  Eigen::Vector3d best = edge.middle();
  double nearest = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= kDepthSteps; ++i) {
    const Eigen::Vector3d p = edge.a + (edge.b - edge.a) * i / kDepthSteps;
    const auto at = projectToIdeal(k, T_camera_world * p);
    if (!at || (*at - px).norm() >= nearest) continue;
    nearest = (*at - px).norm();
    best = p;
  }
  return best;
}

}  // namespace

double LabelLengths::total_px() const {
  return std::accumulate(found_px.begin(), found_px.end(), 0.0,
                         [](double sum, const auto& item) { return sum + item.second; });
}

double LabelLengths::share(const Label& label) const {
  const auto found = found_px.find(label);
  return found == found_px.end() ? 0.0 : found->second / total_px();
}

LabelCheck::LabelCheck(const SegmentMap& edges, std::vector<Segment3> obstacles,
                       const LabelCheckParams& params)
    : obstacles_(std::move(obstacles)), params_(params) {
  std::copy_if(edges.segments.begin(), edges.segments.end(), std::back_inserter(edges_),
               [](const MapSegment& edge) { return edge.label != kAnyLabel; });
}

void LabelCheck::add(const std::vector<ImageSegment>& observed, const CameraIntrinsics& k,
                     const Pose3& T_world_camera) {
  struct Visible {
    const MapSegment* edge;
    Segment2 px;
  };
  const Pose3 T_camera_world = T_world_camera.inverse(Eigen::Isometry);
  const Eigen::Vector2d camera = T_world_camera.translation().head<2>();
  std::vector<Visible> visible;
  for (const MapSegment& edge : edges_) {
    if (distanceToSegment(camera, edge.world.floor()) > params_.max_range_m) continue;
    if (const auto px = projectSegment(k, T_world_camera, edge.world)) visible.push_back({&edge, *px});
  }
  for (const ImageSegment& segment : observed) {
    const MapSegment* best = nullptr;
    double best_px = std::numeric_limits<double>::infinity();
    double other_px = best_px;
    for (const auto& [edge, px] : visible) {
      const auto distance_px = distanceTo(px, segment.px, params_);
      if (!distance_px) continue;
      const bool nearer = *distance_px < best_px;
      const bool other = best != nullptr && edge->label != best->label;
      if (other) other_px = std::min(other_px, nearer ? best_px : *distance_px);
      if (!nearer) continue;
      best_px = *distance_px;
      best = edge;
    }
    if (best == nullptr || other_px < best_px + params_.ambiguous_px) continue;
    const Eigen::Vector3d p = pointAt(best->world, k, T_camera_world, segment.px.middle());
    if (isHidden(T_world_camera.translation(), p, obstacles_)) continue;
    lengths_[best->label].found_px[segment.label] += segment.px.length();
  }
}

}  // namespace vismem
