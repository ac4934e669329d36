#include "localization/core/map/map_index.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/geometry/angles.h"

namespace vismem {
namespace {

constexpr int kDirectionBins = 12;
constexpr double kOnFloor_m = 0.02;  // tolerance for maps drawn by hand

/// The part of a map segment on the floor.
std::optional<Segment2> touchingFloor(const Segment3& world) {
  const bool a = std::abs(world.a.z()) <= kOnFloor_m;
  const bool b = std::abs(world.b.z()) <= kOnFloor_m;
  if (a && b) return world.floor();
  if (a) return Segment2{world.a.head<2>(), world.a.head<2>()};
  if (b) return Segment2{world.b.head<2>(), world.b.head<2>()};
  return std::nullopt;
}

}  // namespace

MapIndex::MapIndex(const SegmentMap& map, const Params& params) {
  if (params.direction_gate_rad) bins_ = kDirectionBins;
  bool has_any = false;
  for (const MapSegment& segment : map.segments) {
    has_any = has_any || segment.label == kAnyLabel;
    if (segment.label != kAnyLabel) ids_.try_emplace(segment.label, static_cast<int>(ids_.size()));
  }
  int labels = static_cast<int>(ids_.size());
  if (has_any) any_ = labels++;
  names_.assign(static_cast<std::size_t>(labels), kAnyLabel);
  for (const auto& [name, id] : ids_) names_[static_cast<std::size_t>(id)] = name;
  by_label_.resize(static_cast<std::size_t>(labels));
  floor_.resize(static_cast<std::size_t>(labels));
  low_ = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());
  high_ = -low_;
  const double bin_width = std::numbers::pi / bins_;
  std::vector<SegmentGrid::Item> items;
  for (const MapSegment& segment : map.segments) {
    const Segment2 plan = segment.world.floor();
    low_ = low_.cwiseMin(plan.a).cwiseMin(plan.b);
    high_ = high_.cwiseMax(plan.a).cwiseMax(plan.b);
    const auto floor = touchingFloor(segment.world);
    for (int label = 0; label < labels; ++label) {
      if (segment.label != kAnyLabel && ids_.at(segment.label) != label) continue;
      by_label_[static_cast<std::size_t>(label)].push_back(segment.world);
      if (!floor || floor->length() < params.minimum_plan_length_m) continue;
      auto& lines = floor_[static_cast<std::size_t>(label)];
      SegmentGrid::Item item{*floor, label, 0};
      lines.push_back(*floor);
      for (int bin = 0; bin < bins_; ++bin) {
        const double off = lineAngleDifference(floor->direction(), (bin + 0.5) * bin_width);
        if (bins_ > 1 && off > *params.direction_gate_rad + 0.5 * bin_width) continue;
        item.bins = static_cast<std::uint16_t>(item.bins | (1u << bin));
      }
      items.push_back(item);
    }
  }
  field_.emplace(std::move(items), params.reach_m, params.cell_m);
}

std::optional<int> MapIndex::labelId(const Label& label) const {
  if (label == kUnknownLabel) return std::nullopt;
  const auto found = ids_.find(label);
  if (found != ids_.end()) return found->second;
  return any_;
}

std::optional<int> MapIndex::floorLabelId(const Label& label) const {
  const auto id = labelId(label);
  if (!id || floor(*id).empty()) return std::nullopt;
  return id;
}

double MapIndex::distance(int label, const Eigen::Vector2d& p) const {
  if (const auto sample = nearest(label, p, 0.0)) return sample->distance_m;
  double nearest_m = std::numeric_limits<double>::infinity();
  for (const Segment2& segment : floor(label)) nearest_m = std::min(nearest_m, distanceToSegment(p, segment));
  return nearest_m;
}

}  // namespace vismem
