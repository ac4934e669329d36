#include "experiments/trials/clutter.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/geometry/projection.h"

namespace vismem {
namespace {

constexpr double kOnFloor_m = 0.02;
constexpr double kReach_m = 4.0;
constexpr double kShortest_m = 0.3;
constexpr double kLongest_m = 1.5;
/// Edges of average contrast.
constexpr double kStrength = 40.0;

bool isOnFloor(const MapSegment& edge) {
  return std::abs(edge.world.a.z()) <= kOnFloor_m && std::abs(edge.world.b.z()) <= kOnFloor_m;
}

/// Labels of the map's edges on the floor, one for each edge; without those of any label.
std::vector<Label> floorLabels(const SegmentMap& edges) {
  std::vector<Label> labels;
  for (const MapSegment& edge : edges.segments) {
    if (edge.label != kAnyLabel && isOnFloor(edge)) labels.push_back(edge.label);
  }
  return labels;
}

Eigen::Vector2d anyPixel(const CameraIntrinsics& intrinsics, RandomEngine& engine) {
  // Two statements: the order of evaluation of arguments is not defined, and runs must repeat.
  const double u = uniform(engine, 0.0, intrinsics.width - 1.0);
  const double v = uniform(engine, 0.0, intrinsics.height - 1.0);
  return {u, v};
}

}  // namespace

Clutter::Clutter(const Disturbance& disturbance, const SegmentMap& edges)
    : disturbance_(disturbance), labels_(floorLabels(edges)) {}

void Clutter::add(double time_s, const CameraIntrinsics& intrinsics, const Pose3& T_world_camera,
                  RandomEngine& engine, std::vector<ImageSegment>& image) {
  const double share = disturbance_.false_share;
  if (!(share > 0.0)) return;
  std::erase_if(objects_, [&](const Object& one) { return one.until_s <= time_s; });
  const auto labelled =
      std::count_if(image.begin(), image.end(), [](const auto& one) { return one.label != kUnknownLabel; });
  // Number of false segments for the requested share; its fraction is drawn.
  const double wanted = share / (1.0 - share) * static_cast<double>(labelled);
  auto left = static_cast<int>(wanted);
  if (uniform(engine, 0.0, 1.0) < wanted - left) ++left;
  const auto show = [&](const Object& one) {
    if (left <= 0) return;
    const auto px = projectSegment(intrinsics, T_world_camera, one.world);
    if (!px || px->length() < kLeast_px) return;
    image.push_back({*px, one.label, kStrength});
    --left;
  };
  for (const Object& one : objects_) show(one);
  // An image without floor in range has no place for more.
  for (int tries = 4 * left; left > 0 && tries > 0; --tries) {
    const Eigen::Vector2d px = anyPixel(intrinsics, engine);
    const double direction = uniform(engine, -std::numbers::pi, std::numbers::pi);
    const double length = uniform(engine, kShortest_m, kLongest_m);
    const double lasts = -disturbance_.clutter_s * std::log(1.0 - uniform(engine, 0.0, 1.0));
    const auto floor = backProjectToGround(intrinsics, T_world_camera, px, kReach_m);
    if (!floor) continue;
    const Eigen::Vector3d half =
        0.5 * length * Eigen::Vector3d(std::cos(direction), std::sin(direction), 0.0);
    const Label label = labels_.empty() ? kUnknownLabel : labels_[pick(engine, labels_.size())];
    objects_.push_back({{*floor - half, *floor + half}, label, time_s + lasts});
    show(objects_.back());
  }
}

void loseSegments(const Disturbance& disturbance, RandomEngine& engine, std::vector<ImageSegment>& image) {
  if (!(disturbance.lost_share > 0.0)) return;
  std::erase_if(image,
                [&](const ImageSegment&) { return uniform(engine, 0.0, 1.0) < disturbance.lost_share; });
}

}  // namespace vismem
