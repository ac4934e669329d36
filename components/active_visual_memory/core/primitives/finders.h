/// @file Finders of shapes among edges on the floor: circles, stripes, arrows, polygons. Their results and
/// work lie in scratch memory. Pure. See M8, M9.
#pragma once

#include <memory_resource>
#include <span>
#include <vector>

#include "active_visual_memory/core/primitives/floor_edge.h"
#include "common/visual_memory/primitive.h"

namespace vismem {

using Shapes = std::pmr::vector<Primitive>;

struct CircleParams {
  double min_radius_m = 0.10;
  double max_radius_m = 2.0;
  double tolerance_m = 0.03;      ///< of a chord's points from the circle
  double max_turn_rad = 1.2;      ///< between neighbouring chords; a hexagon has 1.05
  double max_chord_gap_m = 0.25;  ///< between the ends of neighbouring chords
  double min_coverage = 0.4;      ///< share of the circumference that chords cover
  int min_chords = 5;
  double max_line_width_m = 0.15;  ///< two concentric circles this far apart are both edges of a line
};

/// Circles, by falling coverage. Each edge belongs to at most one of them; a painted circle, whose line has
/// an inner and an outer edge, is one circle.
Shapes findCircles(std::span<const FloorEdge> edges, const CircleParams& params,
                   std::pmr::memory_resource* scratch);

struct StripeParams {
  double min_width_m = 0.008;  ///< distant lines are remembered narrower than they are
  double max_width_m = 0.13;
  double max_angle_rad = 0.10;   ///< between the edges
  double min_overlap = 0.5;      ///< of the shorter edge
  double min_slenderness = 2.5;  ///< length to width: shorter things are patches
  double max_gap_m = 0.25;       ///< pieces of one painted line this far apart are joined
  double max_offset_m = 0.03;    ///< of their middle lines
};

/// The middle lines of stripes with their width, longest first. Their `segments` are those of both edges; an
/// edge broken on one side only still makes one stripe.
FloorEdges findStripes(std::span<const FloorEdge> edges, const StripeParams& params,
                       std::pmr::memory_resource* scratch);

Primitive stripePrimitive(const FloorEdge& stripe);

struct ArrowParams {
  double gap_m = 0.12;         ///< from the tip to the ends of shaft and heads, plus half their widths
  double min_head_rad = 0.35;  ///< between head and shaft, 20 degrees
  double max_head_rad = 1.22;  ///< 70 degrees
  double symmetry_rad = 0.21;  ///< difference between the angles of both heads
  double head_ratio = 0.65;    ///< of the shorter head to the longer
  double shaft_ratio = 1.2;    ///< least of the shaft to the heads
  double min_head_m = 0.08;
};

/// Arrows among strokes (edges or stripes).
/// @param max_shaft_m  longer strokes are no shafts.
Shapes findArrows(std::span<const FloorEdge> strokes, const ArrowParams& params, double max_shaft_m,
                  std::pmr::memory_resource* scratch);

struct PolygonParams {
  double min_side_m = 0.12;
  double max_side_m = 2.5;
  double corner_gap_m = 0.08;   ///< from an edge's end to the corner, plus half a stripe's width
  double corner_share = 0.05;   ///< of the edge's length, added
  double min_corner_rad = 0.4;  ///< 23 degrees
  double parallel_rad = 0.14;   ///< 8 degrees
  double closing_m = 0.06;      ///< of the fourth corner from where the other three put it
  double closing_share = 0.06;  ///< of the longest side, added
  double broken_gap_m = 0.6;    ///< two collinear pieces this far apart may be one broken side
  double broken_offset_m = 0.025;
  double broken_angle_rad = 0.08;
};

/// Parallelograms and triangles, complete ones and parallelograms of which three corners are seen. The sides
/// of one shape turn the same side to its inside (brighter or darker); two collinear pieces may be one side.
/// Every edge belongs to any number of them: the caller chooses.
Shapes findPolygons(std::span<const FloorEdge> edges, const PolygonParams& params,
                    std::pmr::memory_resource* scratch);

}  // namespace vismem
