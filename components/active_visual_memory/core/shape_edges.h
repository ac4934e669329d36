/// @file Edges that shapes tell of and images show badly: square ends of painted lines, rims of circles.
/// Pure. SPEC M9.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <tuple>
#include <vector>

#include "active_visual_memory/core/circle_rims.h"
#include "active_visual_memory/core/corners.h"
#include "active_visual_memory/core/cross_marks.h"
#include "active_visual_memory/core/junctions.h"
#include "active_visual_memory/core/line_sides.h"
#include "active_visual_memory/core/memory_element.h"
#include "active_visual_memory/core/shadow_strips.h"
#include "common/visual_memory/memory_snapshot.h"

namespace vismem {

/// Completes what is published, not what is remembered: the next images meet what was really seen.
/// *Single-threaded* (owner: the perception loop). Invariant: one edge of a shape keeps its id.
class ShapeEdges {
 public:
  struct Params {
    bool enabled = true;
    // Ends of painted lines: the end edge of a line of 5 cm is a few pixels long at best.
    double min_width_m = 0.03;
    double max_width_m = 0.13;
    double max_angle_rad = 0.10;             ///< between both sides of a line
    double max_skew_m = 0.04;                ///< both sides end at one place along the line within this ..
    double max_skew_sigmas = 2.0;            ///< .. and so much of what is not known of the ends
    double most_skew_m = 0.10;               ///< but never more than this
    double min_strength_share = 0.6;         ///< contrast of the weaker side over that of the stronger
    double overshoot_strength_share = 0.35;  ///< the same for a side that may have run into another edge
    int min_views = 3;                       ///< of each of the two ends
    /// Far lines end too short: a side that ends later by no more than this much of what is not known of the
    /// other's end tells where both end.
    double short_sigmas = 0.0;
    double neighbour_m = 0.06;     ///< what begins so near to a corner makes it a junction, not an end
    double continuation_m = 0.30;  ///< what goes on in line this far behind makes it a gap, not an end
    CornerParams corners;
    LineWidthParams line_widths;
    JunctionParams junctions;
    ShadowParams shadows;
    CircleRimParams circles;
    CrossMarkParams crosses;
    CourseParams course;
  };
  using NewId = std::function<std::uint64_t()>;

  explicit ShapeEdges(const Params& params) : params_(params) {}

  /// Adds ends of lines and tells circles in regular chords instead of those found.
  /// @param segments what is to be published. @param elements what it was taken from.
  /// @param primitives the shapes found; circles then name the chords they are told in.
  void complete(std::vector<MemorySegment>& segments, std::span<const MemoryElement> elements,
                std::vector<Primitive>& primitives, const NewId& new_id);
  void clear() { ids_.clear(); }

 private:
  using Key = std::tuple<std::uint64_t, std::uint64_t, int>;
  std::uint64_t idOf(const Key& key, const NewId& new_id);
  void addLineEnds(std::vector<MemorySegment>& segments, std::span<const MemoryElement> elements,
                   const NewId& new_id);

  Params params_;
  std::map<Key, std::uint64_t> ids_;
  std::map<Key, std::uint64_t> used_;
};

}  // namespace vismem
