/// @file Edges derived from shapes: ends of line markings, edges of circles, corners, junctions. Pure. See
/// M9.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "active_visual_memory/core/markings/circle_marking.h"
#include "active_visual_memory/core/markings/cross_spot.h"
#include "active_visual_memory/core/markings/junctions.h"
#include "active_visual_memory/core/markings/line_ends.h"
#include "active_visual_memory/core/markings/line_marking.h"
#include "active_visual_memory/core/memory/memory_element.h"
#include "common/config/parameter_visitor.h"
#include "common/memory/scratch.h"
#include "common/visual_memory/memory_snapshot.h"

namespace vismem {

/// Completes the published segments; the remembered ones stay, so the next image is associated with
/// observations only. *Single-threaded* (owner: the perception loop). Invariant: an edge of a shape keeps its
/// id.
class ShapeEdges {
 public:
  struct Params {
    bool enabled = true;
    /// Widths of line markings, for all parts. The end edge of a line of 5 cm is a few pixels long at best.
    LineWidthRange line_width;
    CornerParams corners;
    LineWidthParams line_widths;  ///< whose range is `line_width`
    JunctionParams junctions;     ///< whose range is `line_width`
    CircleMarkingParams circles;
    CrossSpotParams crosses;
    DominantDirectionParams dominant_direction;

    void visit(ParameterVisitor& v);
  };
  using NewId = std::function<std::uint64_t()>;

  explicit ShapeEdges(const Params& params);

  /// @param segments    to be published; completed in place.
  /// @param elements    that the segments were taken from.
  /// @param primitives  the shapes found; circles then name their published chords.
  void complete(std::vector<MemorySegment>& segments, std::span<const MemoryElement> elements,
                std::vector<Primitive>& primitives, const NewId& new_id);
  void clear() { ids_.clear(); }

 private:
  using Key = std::tuple<std::uint64_t, std::uint64_t, int>;
  using Ids = std::vector<std::pair<Key, std::uint64_t>>;
  std::uint64_t idOf(const Key& key);

  Params params_;
  Ids ids_;   ///< of the last image, sorted
  Ids used_;  ///< of this image
  const NewId* new_id_ = nullptr;
  Scratch scratch_;
};

}  // namespace vismem
