/// @file Remembered segments as lines in plan view, for the finders of shapes. Pure. See M8.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory_resource>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "common/geometry/segment.h"
#include "common/visual_memory/memory_snapshot.h"

namespace vismem {

using SegmentIds = std::span<const std::uint64_t>;

/// A straight piece of an outline: an edge with its brighter side left of a -> b, or a stripe. Label and ids
/// are those of the remembered segments, or of the finder's scratch memory. *Value.*
struct FloorEdge {
  Segment2 line;
  Eigen::Vector2d along = Eigen::Vector2d::UnitX();  ///< unit vector a -> b
  double length = 0.0;
  std::string_view label;
  double width_m = 0.0;  ///< of a stripe, which has no polarity; 0: an edge
  SegmentIds segments;   ///< sorted

  bool isStripe() const { return width_m > 0.0; }
  /// End 0 is a, end 1 is b.
  const Eigen::Vector2d& end(int which) const { return which == 0 ? line.a : line.b; }
  /// Unit vector from the given end into the edge.
  Eigen::Vector2d inward(int which) const { return which == 0 ? along : Eigen::Vector2d(-along); }
};

/// A list in the scratch memory of a search.
using FloorEdges = std::pmr::vector<FloorEdge>;

/// An edge of length > 0; empty for less.
std::optional<FloorEdge> makeFloorEdge(const Segment2& line, std::string_view label, SegmentIds segments,
                                       double width_m = 0.0);

/// Remembered segments, in their order. @param confirmed_only  leaves out the unconfirmed ones.
FloorEdges floorEdges(std::span<const MemorySegment> segments, bool confirmed_only,
                      std::pmr::memory_resource* scratch);

/// Sorted union of two sorted lists, in scratch memory.
SegmentIds joinedIds(SegmentIds a, SegmentIds b, std::pmr::memory_resource* scratch);
/// True if two sorted lists share an id.
bool shareIds(SegmentIds a, SegmentIds b);

/// Intersection of the lines of two edges; empty if they are parallel within 0.01 rad.
std::optional<Eigen::Vector2d> intersection(const FloorEdge& a, const FloorEdge& b);

}  // namespace vismem
