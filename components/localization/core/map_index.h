/// @file The map as localization asks for it: "how far is the nearest segment of this label (and direction)".
/// Pure. SPEC L4, L5; DESIGN 9.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <map>
#include <numbers>
#include <optional>
#include <span>
#include <vector>

#include "common/geometry/segment.h"
#include "common/segment_map/segment_map.h"
#include "localization/core/floor_cells.h"
#include "localization/core/segment_grid.h"
#include "localization/core/segment_tree.h"

namespace vismem {

/// The map's segments by label, with fields over what of them touches the floor. Segments labelled `any`
/// belong to every label. *Pure* after construction.
class MapIndex {
 public:
  struct Params {
    double reach_m = 1.0;  ///< of the fields: larger distances are not found by them
    double cell_m = 0.5;   ///< of their grid; changes speed alone
    /// Segments within this angle of a direction count for it; empty: all directions alike, one field a
    /// label.
    std::optional<double> direction_gate_rad;
    /// Segments shorter than this in plan view are left out of the floor: vertical edges have no direction
    /// there.
    double minimum_plan_length_m = 0.0;
    bool build_fields = true;
    bool build_trees = false;  ///< and cells, to ask what is nearest in an image, or far away on the floor
  };

  /// @param map expanded to edges (no widths).
  MapIndex(const SegmentMap& map, const Params& params);

  /// Number of a label; empty for `unknown` and for labels the map has no segment of.
  std::optional<int> labelId(const Label& label) const;
  /// The same for the floor: empty too for labels without a segment that touches it.
  std::optional<int> floorLabelId(const Label& label) const;
  int labelCount() const { return static_cast<int>(by_label_.size()); }
  const Label& labelName(int label) const { return names_[static_cast<std::size_t>(label)]; }
  /// All segments of space that count for the label.
  const std::vector<Segment3>& segments(int label) const {
    return by_label_[static_cast<std::size_t>(label)];
  }
  /// The same, to ask what is nearest in an image; null unless they were to be built.
  const SegmentTree* tree(int label) const {
    return trees_.empty() ? nullptr : &trees_[static_cast<std::size_t>(label)];
  }
  /// The same by the cells of the floor; null if some of them are above it.
  const FloorCells* floorCells(int label) const {
    return cells_.empty() || is_above_[static_cast<std::size_t>(label)]
               ? nullptr
               : &cells_[static_cast<std::size_t>(label)];
  }
  /// What of them touches the floor: lines, and the feet of upright edges as segments without length.
  const std::vector<Segment2>& floor(int label) const { return floor_[static_cast<std::size_t>(label)]; }
  Eigen::Vector2d low() const { return low_; }
  Eigen::Vector2d high() const { return high_; }

  /// What the fields do not reach is at least this far; empty without fields.
  std::optional<double> fieldReach() const {
    return fields_ ? std::optional<double>(fields_->reach()) : std::nullopt;
  }
  /// What to ask the fields. @param direction_rad of the observed line; ignored without a direction gate.
  SegmentGrid::Question question(int label, const Eigen::Vector2d& p, double direction_rad) const {
    return {p, label, binOf(direction_rad)};
  }
  /// Distance on the floor, by the field; empty beyond the truncation.
  std::optional<FieldSample> nearest(const SegmentGrid::Question& question) const {
    return fields_->nearest(question);
  }
  std::optional<FieldSample> nearest(int label, const Eigen::Vector2d& p, double direction_rad) const {
    return nearest(question(label, p, direction_rad));
  }
  /// To as many questions. Needs fields.
  void nearest(std::span<const SegmentGrid::Question> questions,
               std::span<std::optional<FieldSample>> samples) const {
    fields_->nearest(questions, samples);
  }
  /// Distances alone, squared [m^2]; the reach's beyond the truncation. Needs fields.
  void nearestSquares(std::span<const SegmentGrid::Question> questions, std::span<double> squares) const {
    fields_->nearestSquares(questions, squares);
  }
  /// The reference: over all segments, whatever the distance. Same gate (by the same bins), same gradient.
  std::optional<FieldSample> nearestBruteForce(const SegmentGrid::Question& question) const;
  std::optional<FieldSample> nearestBruteForce(int label, const Eigen::Vector2d& p,
                                               double direction_rad) const {
    return nearestBruteForce(question(label, p, direction_rad));
  }
  /// Distance without truncation: by the field where it reaches, else by the cells (without: over all
  /// segments).
  /// @param label one that floorLabelId gave.
  double distance(int label, const Eigen::Vector2d& p) const;

 private:
  int binOf(double direction_rad) const {
    if (bins_ == 1) return 0;
    const double half_turns = direction_rad * std::numbers::inv_pi;
    double fraction = half_turns - static_cast<double>(static_cast<std::int64_t>(half_turns));
    if (fraction < 0.0) fraction += 1.0;
    return std::min(bins_ - 1, static_cast<int>(fraction * bins_));
  }

  int bins_ = 1;
  std::map<Label, int> ids_;
  std::vector<Label> names_;
  std::optional<int> any_;  // of labels that have no segments of their own, if the map has `any`
  std::vector<std::vector<Segment3>> by_label_;
  std::vector<std::vector<Segment2>> floor_;
  std::vector<std::vector<Segment2>> binned_;  // [label * bins_ + bin]
  std::optional<SegmentGrid> fields_;
  std::vector<SegmentTree> trees_;  // by label, or none
  std::vector<FloorCells> cells_;   // of floor_, or none
  std::vector<bool> is_above_;      // by label: not all of by_label_ is in cells_
  Eigen::Vector2d low_ = Eigen::Vector2d::Zero();
  Eigen::Vector2d high_ = Eigen::Vector2d::Zero();
};

}  // namespace vismem
