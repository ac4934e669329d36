/// @file How far the nearest map line is, in plan view: by search, and by a table. Pure. SPEC L5; DESIGN 9.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "common/geometry/segment.h"
#include "common/segment_map/segment_map.h"

namespace vismem {

/// The map's lines on the floor (z = 0 at both ends) that an observed label can be, in plan view.
/// Stripes must have been expanded (expandStripes): a width is not looked at.
std::vector<Segment2> floorLines(const SegmentMap& map, const Label& observed);

struct NearestLine {
  std::size_t index = 0;    ///< into the lines given
  double distance_m = 0.0;  ///< to the nearest point of the segment
};
/// Exact, by looking at every line. @return empty without lines. Of several equally near ones the first.
std::optional<NearestLine> nearestLine(std::span<const Segment2> lines, const Eigen::Vector2d& p_world);

struct DistanceFieldParams {
  double cell_m = 0.05;       ///< between nodes
  double truncation_m = 1.0;  ///< larger distances read as this
};

/// Distance to the nearest of a set of lines, truncated: exact at the nodes of a grid, bilinear between them.
/// Memory grows with the length of the lines, not with the area: only tiles near a line are stored (about 5
/// kB each, 1.6 m wide with the default cell). Immutable: *thread-safe*.
class DistanceField {
 public:
  struct Value {
    double distance_m = 0.0;
    /// Of the distance [m/m], away from the line; exact derivative of the bilinear value, zero where
    /// truncated.
    Eigen::Vector2d gradient = Eigen::Vector2d::Zero();
  };

  /// @throws ConfigError for parameters that are not positive and for lines spread over more than 2^22 tiles.
  DistanceField(std::span<const Segment2> lines, const DistanceFieldParams& params);

  Value at(const Eigen::Vector2d& p_world) const;
  double distance(const Eigen::Vector2d& p_world) const;
  const DistanceFieldParams& params() const { return params_; }
  std::size_t tileCount() const { return nodes_.size() / (kNodes * kNodes); }

 private:
  static constexpr int kCells = 32;          // cells of a tile
  static constexpr int kNodes = kCells + 1;  // its nodes; the border is stored in both neighbours

  struct Place {
    const float* node = nullptr;  // lower corner of the cell; null: truncated
    double fx = 0.0;              // within the cell
    double fy = 0.0;
  };
  Place locate(const Eigen::Vector2d& p_world) const;

  DistanceFieldParams params_;
  Eigen::Vector2d origin_ = Eigen::Vector2d::Zero();
  int tiles_x_ = 0;
  int tiles_y_ = 0;
  std::vector<std::int32_t> tile_of_;  // -1: truncated everywhere
  std::vector<float> nodes_;
};

/// One field per label of a map; lines labelled `any` are in all of them. Immutable: *thread-safe*.
class LabelledDistanceFields {
 public:
  LabelledDistanceFields(const SegmentMap& map, const DistanceFieldParams& params);

  /// @return null when the map has no floor line that the label can be (always for kUnknownLabel).
  const DistanceField* find(const Label& observed) const;

 private:
  std::map<Label, DistanceField> fields_;
};

}  // namespace vismem
