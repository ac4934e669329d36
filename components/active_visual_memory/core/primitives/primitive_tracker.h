/// @file Shapes over time, and hypotheses of their unseen corners.
/// Pure. Implements M9. See M8, A2.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "active_visual_memory/core/memory/memory_element.h"
#include "active_visual_memory/core/primitives/primitive_finder.h"
#include "common/config/parameter_visitor.h"
#include "common/memory/scratch.h"

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
      v.flag(expert("ConfirmedOnly", "M8, B6: unconfirmed segments make no shape, and no edge of a map"),
             finder.confirmed_only);
    }
  };

  explicit PrimitiveTracker(const Params& params);

  /// @param segments the published memory at `stamp_us`.
  /// @return true if shapes were searched for.
  bool update(StampUs stamp_us, std::span<const MemorySegment> segments);

  /// The published shapes, oldest first. Until the next update.
  const std::vector<Primitive>& published() const { return published_; }
  const std::vector<VertexHypothesis>& hypotheses() const { return hypotheses_; }
  /// Of published parallelograms and triangles: the sides that consist of several segments of the last
  /// update.
  std::pmr::vector<SideCompletion> completions(std::pmr::memory_resource* scratch) const;

  void clear();

 private:
  struct Entry {
    Primitive value;
    int findings = 0;
  };
  struct Place {
    std::uint64_t segment = 0;
    Segment2 odom;
  };
  using Places = std::vector<Place>;  ///< sorted
  static const Segment2* find(const Places& places, std::uint64_t segment);
  void take(Entry& entry, const Primitive& found, double dt_s) const;
  /// Moves a shape by the least-squares rigid motion of its segments' lines; their extents may change.
  void follow(Primitive& shape) const;
  void publish();

  Params params_;
  std::vector<Entry> entries_;
  Places places_;  ///< of all segments
  Places before_;  ///< the same at the update before
  std::vector<Primitive> published_;
  std::vector<VertexHypothesis> hypotheses_;
  Scratch scratch_;  ///< of one update
  std::uint64_t next_id_ = 1;
  bool has_last_ = false;
  StampUs last_us_ = 0;
};

}  // namespace vismem
