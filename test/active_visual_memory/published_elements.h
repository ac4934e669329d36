/// @file Elements as images saw them and what ShapeEdges publishes of them: shared by tests.
#pragma once

#include <utility>
#include <vector>

#include "active_visual_memory/core/markings/shape_edges.h"
#include "active_visual_memory/core/memory/memory_element.h"

namespace vismem {

/// A confirmed element that three images saw from end to end.
inline MemoryElement seen(std::uint64_t id, const Segment2& line, bool censored_b = false,
                          double strength = 100.0) {
  FloorSegment segment;
  segment.place(line);
  segment.a.P = segment.b.P = 1e-4 * Eigen::Matrix2d::Identity();
  segment.b.censored = censored_b;
  segment.label = "line";
  MemoryElement element;
  element.value.id = id;
  element.value.label = "line";
  element.value.life = 50.0 + static_cast<double>(id);
  element.line = FloorLine(segment, {});
  for (int i = 0; i < 3; ++i) element.line.fuse(segment, {});
  element.strength = strength;
  publish(element, true, CameraTiltCovariance::Zero());
  return element;
}

struct Published {
  std::vector<MemorySegment> segments;
  std::vector<Primitive> primitives;
};

inline Published complete(const std::vector<MemoryElement>& elements,
                          std::vector<Primitive> primitives = {}) {
  Published published{{}, std::move(primitives)};
  for (const MemoryElement& element : elements) published.segments.push_back(element.value);
  std::uint64_t next = 1000;
  ShapeEdges shapes({});
  shapes.complete(published.segments, elements, published.primitives, [&] { return next++; });
  return published;
}

// A bright line from (0, 0) to (1, 0), 5 cm wide: its lower edge runs along +x (bright on the left).
inline const Segment2 kLower{{0.0, 0.0}, {1.0, 0.0}};
inline const Segment2 kUpper{{1.0, 0.05}, {0.0, 0.05}};

}  // namespace vismem
