#include "common/segment_map/distance_field.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <sstream>

#include "common/config/config_error.h"

namespace vismem {
namespace {

constexpr double kMaxTiles = 1 << 22;

/// Lines that can be within the truncation somewhere in a tile, tile by tile.
std::vector<std::vector<std::uint32_t>> linesByTile(std::span<const Segment2> lines,
                                                    const Eigen::Vector2d& origin, double tile_m,
                                                    double truncation_m, int tiles_x, int tiles_y) {
  std::vector<std::vector<std::uint32_t>> by_tile(static_cast<std::size_t>(tiles_x) * tiles_y);
  const double reach = truncation_m + tile_m * std::sqrt(0.5);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const Eigen::Vector2d low = lines[i].a.cwiseMin(lines[i].b).array() - truncation_m;
    const Eigen::Vector2d high = lines[i].a.cwiseMax(lines[i].b).array() + truncation_m;
    const auto tile = [&](double value, int axis, int count) {
      return std::clamp(static_cast<int>(std::floor((value - origin[axis]) / tile_m)), 0, count - 1);
    };
    for (int y = tile(low.y(), 1, tiles_y); y <= tile(high.y(), 1, tiles_y); ++y) {
      for (int x = tile(low.x(), 0, tiles_x); x <= tile(high.x(), 0, tiles_x); ++x) {
        const Eigen::Vector2d middle = origin + tile_m * Eigen::Vector2d(x + 0.5, y + 0.5);
        if (distanceToSegment(middle, lines[i]) > reach) continue;
        by_tile[static_cast<std::size_t>(y) * tiles_x + x].push_back(static_cast<std::uint32_t>(i));
      }
    }
  }
  return by_tile;
}

}  // namespace

std::vector<Segment2> floorLines(const SegmentMap& map, const Label& observed) {
  std::vector<Segment2> lines;
  for (const auto& segment : map.segments) {
    const bool on_floor = segment.world.a.z() == 0.0 && segment.world.b.z() == 0.0;
    if (on_floor && labelFitsMap(observed, segment.label)) lines.push_back(segment.world.floor());
  }
  return lines;
}

std::optional<NearestLine> nearestLine(std::span<const Segment2> lines, const Eigen::Vector2d& p_world) {
  if (lines.empty()) return std::nullopt;
  NearestLine nearest{0, std::numeric_limits<double>::infinity()};
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const double distance_m = distanceToSegment(p_world, lines[i]);
    if (distance_m < nearest.distance_m) nearest = {i, distance_m};
  }
  return nearest;
}

DistanceField::DistanceField(std::span<const Segment2> lines, const DistanceFieldParams& params)
    : params_(params) {
  if (!(params.cell_m > 0.0) || !(params.truncation_m > 0.0)) {
    std::ostringstream out;
    out << "distance field: cell_m = " << params.cell_m << ", truncation_m = " << params.truncation_m
        << " (both must be > 0)";
    throw ConfigError({out.str()});
  }
  if (lines.empty()) return;
  Eigen::Vector2d low = lines.front().a;
  Eigen::Vector2d high = low;
  for (const auto& line : lines) {
    low = low.cwiseMin(line.a).cwiseMin(line.b);
    high = high.cwiseMax(line.a).cwiseMax(line.b);
  }
  const double tile_m = params.cell_m * kCells;
  origin_ = low.array() - params.truncation_m;
  const Eigen::Vector2d extent = (high - origin_).array() + params.truncation_m;
  const Eigen::Vector2d tiles = (extent / tile_m).array().floor() + 1.0;
  if (!(tiles.x() * tiles.y() <= kMaxTiles)) {
    std::ostringstream out;
    out << "distance field: the lines spread over " << extent.x() << " x " << extent.y()
        << " m (too far for cells of " << params.cell_m << " m: at most " << kMaxTiles << " tiles of "
        << tile_m << " m)";
    throw ConfigError({out.str()});
  }
  tiles_x_ = static_cast<int>(tiles.x());
  tiles_y_ = static_cast<int>(tiles.y());

  const auto by_tile = linesByTile(lines, origin_, tile_m, params.truncation_m, tiles_x_, tiles_y_);
  tile_of_.assign(by_tile.size(), -1);
  for (std::size_t tile = 0; tile < by_tile.size(); ++tile) {
    if (by_tile[tile].empty()) continue;
    tile_of_[tile] = static_cast<std::int32_t>(tileCount());
    // Both copies of a shared border node come from the same arithmetic on the same indices, so they are
    // equal.
    const int first_x = static_cast<int>(tile % tiles_x_) * kCells;
    const int first_y = static_cast<int>(tile / tiles_x_) * kCells;
    for (int y = 0; y < kNodes; ++y) {
      for (int x = 0; x < kNodes; ++x) {
        const Eigen::Vector2d p = origin_ + params.cell_m * Eigen::Vector2d(first_x + x, first_y + y);
        double nearest = params.truncation_m;
        for (const auto i : by_tile[tile]) nearest = std::min(nearest, distanceToSegment(p, lines[i]));
        nodes_.push_back(static_cast<float>(nearest));
      }
    }
  }
}

DistanceField::Place DistanceField::locate(const Eigen::Vector2d& p_world) const {
  const double x = (p_world.x() - origin_.x()) / params_.cell_m;
  const double y = (p_world.y() - origin_.y()) / params_.cell_m;
  // Written so that a NaN falls out as well.
  if (!(x >= 0.0 && y >= 0.0 && x < tiles_x_ * double{kCells} && y < tiles_y_ * double{kCells})) return {};
  const int cell_x = static_cast<int>(x);
  const int cell_y = static_cast<int>(y);
  const std::int32_t tile = tile_of_[static_cast<std::size_t>(cell_y / kCells) * tiles_x_ + cell_x / kCells];
  if (tile < 0) return {};
  const std::size_t node =
      (static_cast<std::size_t>(tile) * kNodes + cell_y % kCells) * kNodes + cell_x % kCells;
  return {&nodes_[node], x - cell_x, y - cell_y};
}

DistanceField::Value DistanceField::at(const Eigen::Vector2d& p_world) const {
  const Place place = locate(p_world);
  if (place.node == nullptr) return {params_.truncation_m, Eigen::Vector2d::Zero()};
  const double d00 = place.node[0];
  const double d10 = place.node[1];
  const double d01 = place.node[kNodes];
  const double d11 = place.node[kNodes + 1];
  const double bottom = d00 + place.fx * (d10 - d00);
  const double top = d01 + place.fx * (d11 - d01);
  Value value;
  value.distance_m = bottom + place.fy * (top - bottom);
  value.gradient.x() = ((1.0 - place.fy) * (d10 - d00) + place.fy * (d11 - d01)) / params_.cell_m;
  value.gradient.y() = (top - bottom) / params_.cell_m;
  return value;
}

double DistanceField::distance(const Eigen::Vector2d& p_world) const {
  return at(p_world).distance_m;
}

LabelledDistanceFields::LabelledDistanceFields(const SegmentMap& map, const DistanceFieldParams& params) {
  std::set<Label> labels{kAnyLabel};
  for (const auto& segment : map.segments) labels.insert(segment.label);
  for (const auto& label : labels) {
    const auto lines = floorLines(map, label);
    if (!lines.empty()) fields_.emplace(label, DistanceField(lines, params));
  }
}

const DistanceField* LabelledDistanceFields::find(const Label& observed) const {
  if (observed == kUnknownLabel) return nullptr;
  auto found = fields_.find(observed);
  // A label that the map does not name can still be one of its `any` lines.
  if (found == fields_.end()) found = fields_.find(kAnyLabel);
  return found == fields_.end() ? nullptr : &found->second;
}

}  // namespace vismem
