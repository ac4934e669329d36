/// @file Shapes over time, and hypotheses of their unseen corners.
/// Pure. Implements M9. See M8, A2.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "active_visual_memory/core/memory/memory_element.h"
#include "active_visual_memory/core/primitives/primitive_finder.h"
#include "common/config/parameter_visitor.h"

namespace vismem {

/// Tracks shapes in the segments of the memory. *Single-threaded* (owner: the perception loop). Invariants:
/// ids are never used twice; life in [0, maximum]. A shape lives while half of its segments do, and fades
/// when they are gone. While it is not found it moves with its segments, which follow the odometry drift.
class PrimitiveTracker {
 public:
  struct Params {
    PrimitiveParams finder;
    StampUs interval_us = 200'000;  ///< shapes are searched for this often
    double max_life = 100.0;
    double gain_per_s = 40.0;  ///< while it is found
    double loss_per_s = 25.0;  ///< while it is not found and its segments are gone
    double published_life = 15.0;
    double smoothing = 0.3;  ///< weight of a new finding, once the first few are averaged

    void visit(ParameterVisitor& v) {
      v.flag(
          expert("ConfirmedOnly", "M8, B6: unconfirmed segments alone make no shape, and no edge of a map"),
          finder.confirmed_only);
    }
  };

  explicit PrimitiveTracker(const Params& params) : params_(params) {}

  /// @param segments the published memory at `stamp_us`.
  /// @return true if shapes were searched for.
  bool update(StampUs stamp_us, std::span<const MemorySegment> segments);

  /// The published shapes, oldest first.
  std::vector<Primitive> published() const;
  std::vector<VertexHypothesis> hypotheses() const;
  /// Of published parallelograms and triangles: the sides that consist of several segments.
  std::vector<SideCompletion> completions(std::span<const MemorySegment> segments) const;

  void clear();

 private:
  struct Entry {
    Primitive value;
    int findings = 0;
    /// Where its segments were at the last update, as value.segments.
    std::vector<std::optional<Segment2>> places;
  };
  void take(Entry& entry, Primitive found, double dt_s) const;
  static std::vector<std::optional<Segment2>> placesOf(const Primitive& shape,
                                                       std::span<const MemorySegment> segments);
  static void follow(Primitive& shape, const std::vector<std::optional<Segment2>>& before,
                     const std::vector<std::optional<Segment2>>& now);
  bool isPublished(const Entry& entry) const { return entry.value.life >= params_.published_life; }

  Params params_;
  std::vector<Entry> entries_;
  std::uint64_t next_id_ = 1;
  bool has_last_ = false;
  StampUs last_us_ = 0;
};

}  // namespace vismem
