/// @file Remembered segments as lines in plan view, for the finders of shapes. Pure. See M8.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/geometry/segment.h"
#include "common/visual_memory/memory_snapshot.h"

namespace vismem {

/// A straight piece of an outline: an edge with its brighter side left of a -> b, or a stripe.
struct FloorEdge {
  Segment2 line;
  Eigen::Vector2d along = Eigen::Vector2d::UnitX();  ///< unit vector a -> b
  double length = 0.0;
  Label label = kUnknownLabel;
  double width_m = 0.0;                 ///< of a stripe, which has no polarity; 0: an edge
  std::vector<std::uint64_t> segments;  ///< ids, sorted

  bool isStripe() const { return width_m > 0.0; }
  /// End 0 is a, end 1 is b.
  const Eigen::Vector2d& end(int which) const { return which == 0 ? line.a : line.b; }
  /// Unit vector from the given end into the edge.
  Eigen::Vector2d inward(int which) const { return which == 0 ? along : Eigen::Vector2d(-along); }
};

/// An edge of length > 0; empty for less.
std::optional<FloorEdge> makeFloorEdge(const Segment2& line, Label label, std::vector<std::uint64_t> segments,
                                       double width_m = 0.0);

/// The remembered segments, in their order. @param confirmed_only leaves out unconfirmed ones.
std::vector<FloorEdge> floorEdges(std::span<const MemorySegment> segments, bool confirmed_only);

/// Sorted union of two sorted lists of ids.
std::vector<std::uint64_t> joinedIds(const std::vector<std::uint64_t>& a,
                                     const std::vector<std::uint64_t>& b);
/// True if two sorted lists share an id.
bool shareIds(const std::vector<std::uint64_t>& a, const std::vector<std::uint64_t>& b);

/// Intersection of the lines of two edges; empty if they are parallel within 0.01 rad.
std::optional<Eigen::Vector2d> intersection(const FloorEdge& a, const FloorEdge& b);

}  // namespace vismem
