/// @file Corners of two remembered edges: where end b of one and end a of another lie at one place. Pure. See
/// M9.
#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "active_visual_memory/core/memory/memory_element.h"
#include "common/geometry/segment.h"
#include "common/visual_memory/memory_snapshot.h"

namespace vismem {

/// The line of an edge is known much better than its ends, which the detector moves by a pixel or two. So a
/// corner is the intersection of two lines whose ends lie near it.
struct CornerParams {
  double min_angle_rad = 0.4;  ///< between both edges, and to a fold
  double reach_m = 0.03;       ///< distance of an end from its corner: this ..
  double reach_sigmas = 1.0;   ///< .. plus this many sigmas of its best view ..
  double most_reach_m = 0.12;  ///< .. at most this
  // Confirmation between two corners:
  int min_views = 3;           ///< of either end
  double min_length_m = 0.12;  ///< shorter edges have no reliable direction
  // Confirmation as a continuation of a confirmed edge:
  double least_height_m = 0.06;  ///< lower edges count as lying on the floor
  double sigmas = 2.0;           ///< of both lines together
  double slack_m = 0.01;         ///< added to that
  double max_line_rad = 0.06;    ///< between an edge and its continuation
  double least_length_m = 0.25;  ///< of a continuation
};

/// A remembered edge with its published segment. *Value*; refers to both.
struct CornerEdge {
  MemorySegment* published = nullptr;
  const MemoryElement* element = nullptr;
  Segment2 line;
  Eigen::Vector2d along;
};

/// The corner between end b of edge `from` and end a of edge `to`.
struct EdgeCorner {
  std::size_t from = 0;
  std::size_t to = 0;
  Eigen::Vector2d place;
  double distance_m = 0.0;  ///< sum of the distances of both ends from it
};

CornerEdge cornerEdge(MemorySegment& published, const MemoryElement& element);

/// How far an end may lie from a corner [m].
double endReach(const ExtentEnd& end, const CornerParams& params);

/// Finds the corner between end b of `one` and end a of `other`.
/// @param[out] corner  place and distance; the indices are the caller's.
/// @return false if an end is censored, the lines are nearly parallel, or an end lies beyond its reach.
bool findCorner(const CornerEdge& one, const CornerEdge& other, const CornerParams& params,
                EdgeCorner& corner);

}  // namespace vismem
