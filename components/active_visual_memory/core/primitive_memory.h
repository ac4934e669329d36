/// @file The shapes in memory over time, and the corners they make the robot look for. Pure. SPEC M8, M9, A2.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "active_visual_memory/core/primitive_finder.h"

namespace vismem {

/// A side of a confirmed shape that the memory holds in pieces or in part: what completes it.
struct SideCompletion {
  Segment2 side;                        ///< from corner to corner
  std::vector<std::uint64_t> segments;  ///< the pieces on it, sorted
};

/// *Single-threaded* (owner: the perception loop). Invariants: ids are never used twice; life in [0,
/// maximum]. A shape is found in the memory's segments, not in images, so it is as steady as they are: it
/// lives on while half of its segments do (out of view they fade slowly by themselves), and fades when they
/// are gone. While it is not found it goes wherever its segments go: the memory moves as a whole when
/// odometry has drifted.
class PrimitiveMemory {
 public:
  struct Params {
    PrimitiveParams finder;
    StampUs interval_us = 200'000;  ///< shapes are looked for this often
    double max_life = 100.0;
    double gain_per_s = 40.0;  ///< while it is found
    double loss_per_s = 25.0;  ///< while it is not found and its segments are gone
    double published_life = 15.0;
    double smoothing = 0.3;  ///< weight of a new finding, once the first few are averaged
  };

  explicit PrimitiveMemory(const Params& params) : params_(params) {}

  /// @param segments the published memory at `stamp_us`.
  /// @return true if shapes were looked for.
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
