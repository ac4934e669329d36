/// @file The map indexed by label and direction: distance from a point to the nearest matching segment. Pure.
/// See L4, L5.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <map>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "common/config/parameter_visitor.h"
#include "common/geometry/segment.h"
#include "common/segment_map/segment_map.h"
#include "localization/core/map/segment_grid.h"

namespace vismem {

/// Map parameters that all rooms share.
struct MapParams {
  double cell_m = 0.5;  ///< cell size of the grid over the map; affects speed only
  /// Labels of upright map segments that occlude the floor behind them; "*_foot" matches every label with
  /// that ending.
  std::vector<std::string> opaque_labels{"skirting", "*_foot"};

  void visit(ParameterVisitor& v) {
    v.words(basic("OpaqueLabels",
                  "labels of upright map segments that occlude the floor behind them; *_foot: every label "
                  "with that ending"),
            opaque_labels);
  }
};

/// The map's segments by label, with a distance field over those that touch the floor, and over level edges
/// above it. Segments labelled `any` belong to every label. *Pure* after construction.
class MapIndex {
 public:
  struct Params {
    double reach_m = 1.0;  ///< truncation distance of the fields
    double cell_m = 0.5;   ///< cell size of their grid; affects speed only
    /// A segment counts for a direction within this angle; empty: one field per label, all directions.
    std::optional<double> direction_gate_rad;
    /// Segments shorter than this in plan view are left out of the floor: a vertical edge has no direction
    /// there.
    double minimum_plan_length_m = 0.0;
  };

  /// @param map expanded to edges (no widths).
  MapIndex(const SegmentMap& map, const Params& params);

  /// Number of a label; empty for `unknown` and for labels without a map segment.
  std::optional<int> labelId(const Label& label) const;
  /// The same for the floor: also empty for labels without a segment that touches the floor.
  std::optional<int> floorLabelId(const Label& label) const;
  int labelCount() const { return static_cast<int>(by_label_.size()); }
  const Label& labelName(int label) const { return names_[static_cast<std::size_t>(label)]; }
  /// All 3-D segments that count for the label.
  const std::vector<Segment3>& segments(int label) const {
    return by_label_[static_cast<std::size_t>(label)];
  }
  /// Their parts on the floor: lines, and the feet of upright edges as segments of zero length.
  const std::vector<Segment2>& floor(int label) const { return floor_[static_cast<std::size_t>(label)]; }
  /// A height at which an observed line of a label may lie, with the field of the lines there.
  struct Level {
    double height_m = 0.0;
    int field = 0;  ///< for nearest() and nearestSquare()
  };
  /// The floor first, if the label has lines there. The level edges of one thing, such as foot and top of a
  /// skirting, look alike where wall and floor do: each counts for the labels of both.
  const std::vector<Level>& levels(int label) const { return levels_[static_cast<std::size_t>(label)]; }
  Eigen::Vector2d low() const { return low_; }
  Eigen::Vector2d high() const { return high_; }

  /// Distance in plan view from a field; empty beyond the truncation distance.
  /// @param label of the floor's lines, or the field of a Level.
  /// @param direction_rad of the observed line; ignored without a direction gate.
  std::optional<FieldSample> nearest(int label, const Eigen::Vector2d& p, double direction_rad) const {
    return field_->nearest({p, label, binOf(direction_rad)});
  }
  /// Squared distance only [m^2], truncated at the squared reach.
  double nearestSquare(int label, const Eigen::Vector2d& p, double direction_rad) const {
    return field_->nearestSquare({p, label, binOf(direction_rad)});
  }
  /// Distance without truncation: from the field within its reach, else from all segments.
  /// @param label a result of floorLabelId.
  double distance(int label, const Eigen::Vector2d& p) const;

 private:
  int binOf(double direction_rad) const {
    if (bins_ == 1) return 0;
    const double half_turns = direction_rad * std::numbers::inv_pi;
    double fraction = half_turns - static_cast<double>(static_cast<std::int64_t>(half_turns));
    if (fraction < 0.0) fraction += 1.0;
    return std::min(bins_ - 1, static_cast<int>(fraction * bins_));
  }

  std::uint16_t binsOf(const Segment2& plan, const Params& params) const;
  void addLevels(const Params& params, std::vector<SegmentGrid::Item>& items);

  int bins_ = 1;
  std::map<Label, int> ids_;
  std::vector<Label> names_;
  std::optional<int> any_;  // for labels without segments of their own, if the map has `any`
  std::vector<std::vector<Segment3>> by_label_;
  std::vector<std::vector<Segment2>> floor_;
  std::vector<std::vector<Level>> levels_;
  std::optional<SegmentGrid> field_;
  Eigen::Vector2d low_ = Eigen::Vector2d::Zero();
  Eigen::Vector2d high_ = Eigen::Vector2d::Zero();
};

}  // namespace vismem
