#include "localization/core/map/map_index.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/geometry/angles.h"

namespace vismem {
namespace {

constexpr int kDirectionBins = 12;
constexpr double kOnFloor_m = 0.02;     // tolerance for maps drawn by hand
constexpr double kOneThing_m = 0.05;    // in plan view, between the edges of one thing
constexpr double kThingHeight_m = 0.2;  // a lintel is another thing than the threshold below it
constexpr std::size_t kMostLevels = 3;

/// The part of a map segment on the floor.
std::optional<Segment2> touchingFloor(const Segment3& world) {
  const bool a = std::abs(world.a.z()) <= kOnFloor_m;
  const bool b = std::abs(world.b.z()) <= kOnFloor_m;
  if (a && b) return world.floor();
  if (a) return Segment2{world.a.head<2>(), world.a.head<2>()};
  if (b) return Segment2{world.b.head<2>(), world.b.head<2>()};
  return std::nullopt;
}

/// Height of a level edge above the floor; empty for other segments.
std::optional<double> heightOf(const Segment3& world) {
  const double height = 0.5 * (world.a.z() + world.b.z());
  if (height <= kOnFloor_m || std::abs(world.a.z() - world.b.z()) > kOnFloor_m) return std::nullopt;
  return height;
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
      floor_[static_cast<std::size_t>(label)].push_back(*floor);
      items.push_back({*floor, label, binsOf(*floor, params)});
    }
  }
  addLevels(params, items);
  field_.emplace(std::move(items), params.reach_m, params.cell_m);
}

std::uint16_t MapIndex::binsOf(const Segment2& plan, const Params& params) const {
  const double bin_width = std::numbers::pi / bins_;
  unsigned bins = 0;
  for (int bin = 0; bin < bins_; ++bin) {
    const double off = lineAngleDifference(plan.direction(), (bin + 0.5) * bin_width);
    if (bins_ > 1 && off > *params.direction_gate_rad + 0.5 * bin_width) continue;
    bins |= 1u << bin;
  }
  return static_cast<std::uint16_t>(bins);
}

void MapIndex::addLevels(const Params& params, std::vector<SegmentGrid::Item>& items) {
  const int labels = labelCount();
  levels_.resize(static_cast<std::size_t>(labels));
  std::vector<SegmentGrid::Item> raised;
  std::vector<double> heights;
  for (int label = 0; label < labels; ++label) {
    if (!floor_[static_cast<std::size_t>(label)].empty()) {
      levels_[static_cast<std::size_t>(label)].push_back({0.0, label});
    }
    for (const Segment3& segment : by_label_[static_cast<std::size_t>(label)]) {
      const auto height = heightOf(segment);
      const Segment2 plan = segment.floor();
      if (!height || plan.length() < params.minimum_plan_length_m) continue;
      raised.push_back({plan, label, binsOf(plan, params)});
      heights.push_back(*height);
    }
  }
  if (raised.empty()) return;
  int fields = labels;
  // Adds an edge to the label's level of its height; a new level while the label has few.
  const auto add = [&](int label, double height, SegmentGrid::Item item) {
    auto& levels = levels_[static_cast<std::size_t>(label)];
    auto at = std::find_if(levels.begin(), levels.end(), [&](const Level& level) {
      return std::abs(level.height_m - height) < 0.5 * kOnFloor_m;
    });
    if (at == levels.end()) {
      if (levels.size() >= kMostLevels) return;
      at = levels.insert(height == 0.0 ? levels.begin() : levels.end(), {height, fields++});
    }
    item.label = at->field;
    items.push_back(item);
  };
  std::vector<SegmentGrid::Item> low;
  for (std::size_t i = 0; i < raised.size(); ++i) {
    if (heights[i] <= kThingHeight_m) low.push_back(raised[i]);
  }
  const auto oneThing = [&](const SegmentGrid& others, const SegmentGrid::Item& item, int label) {
    const double square = others.nearestSquare({item.plan.middle(), label, binOf(item.plan.direction())});
    return square < kOneThing_m * kOneThing_m;
  };
  const std::vector<SegmentGrid::Item> on_floor = items;
  const SegmentGrid floor_edges(on_floor, params.reach_m, params.cell_m);
  const SegmentGrid low_edges(low, params.reach_m, params.cell_m);
  for (std::size_t i = 0; i < raised.size(); ++i) {
    for (int label = 0; label < labels; ++label) {
      const bool counts = label == raised[i].label ||
                          (heights[i] <= kThingHeight_m && oneThing(floor_edges, raised[i], label));
      if (counts) add(label, heights[i], raised[i]);
    }
  }
  for (const SegmentGrid::Item& item : on_floor) {
    for (int label = 0; label < labels; ++label) {
      if (label != item.label && oneThing(low_edges, item, label)) add(label, 0.0, item);
    }
  }
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
