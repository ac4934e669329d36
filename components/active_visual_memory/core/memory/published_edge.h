/// @file Remembered edges as they are published, and their corners: where end b of one and end a of another
/// lie at one place. Pure. See M9.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory_resource>
#include <optional>
#include <span>
#include <vector>

#include "active_visual_memory/core/memory/memory_element.h"
#include "common/geometry/segment.h"
#include "common/visual_memory/memory_snapshot.h"

namespace vismem {

/// A published segment with the element that it was taken from. *Value*; refers to both.
struct PublishedEdge {
  MemorySegment* published = nullptr;
  const MemoryElement* element = nullptr;  ///< null: an edge derived from a shape
  Segment2 line;                           ///< when it was listed
  Eigen::Vector2d along;                   ///< unit vector a -> b

  PublishedEdge(MemorySegment& published_segment, const MemoryElement* of);
  double length() const { return line.length(); }
  const Eigen::Vector2d& place(bool at_b) const { return at_b ? line.b : line.a; }
  bool confirmed() const { return published->confirmed; }
};

/// Lists segments with the elements that they were taken from, in their order.
/// @param elements  in the order of their ids.
/// @param scratch   memory of the list.
std::pmr::vector<PublishedEdge> publishedEdges(
    std::vector<MemorySegment>& segments, std::span<const MemoryElement> elements,
    std::pmr::memory_resource* scratch = std::pmr::get_default_resource());

/// Moves a published segment on the floor.
void placeAt(MemorySegment& published, const Segment2& line);
void eraseSegments(std::vector<MemorySegment>& segments, std::span<const std::uint64_t> ids);

/// How far an end may lie from the place where its edge ends by the lines around [m].
struct EndReach {
  double least_m;
  double sigmas;  ///< of the best view of the end, added to least_m
  double most_m;

  double of(const ExtentEnd& end) const {
    return std::min(most_m, least_m + sigmas * std::sqrt(end.best_m2));
  }
};

/// The line of an edge is known much better than its ends, which the detector moves by a pixel or two. So a
/// corner is the intersection of two lines whose ends lie near it.
struct CornerParams {
  double min_angle_rad = 0.4;       ///< between both edges, and to a fold
  EndReach reach{0.03, 1.0, 0.12};  ///< of an end to its corner
  // Confirmation as a continuation of a confirmed edge:
  int min_views = 3;             ///< of either end
  double sigmas = 2.0;           ///< of both lines together
  double slack_m = 0.01;         ///< added to that
  double max_line_rad = 0.06;    ///< between an edge and its continuation
  double least_length_m = 0.25;  ///< of a continuation
};

/// The corner between end b of one edge and end a of another.
struct EdgeCorner {
  Eigen::Vector2d place;
  double distance_m = 0.0;  ///< sum of the distances of both ends from it
};

/// Finds the corner between end b of `one` and end a of `other`, which have elements.
/// @return empty if an end is censored, the lines are nearly parallel, or an end lies beyond its reach.
std::optional<EdgeCorner> findCorner(const PublishedEdge& one, const PublishedEdge& other,
                                     const CornerParams& params);

/// Moves the confirmed ends of edges that share a corner to the intersection of their lines, the nearest
/// first. Along an edge with its brighter side on the left, the next edge of the same surface begins where
/// this one ends: an end b belongs to an end a. Censored ends have no corner.
void joinAtCorners(std::span<const PublishedEdge> edges, const CornerParams& params,
                   std::pmr::memory_resource* scratch = std::pmr::get_default_resource());

}  // namespace vismem
