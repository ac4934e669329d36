/// @file The segment map of a world: its edges between colour pairs of a palette. Pure.
#pragma once

#include <cstddef>
#include <functional>

#include "common/segment_map/segment_map.h"
#include "common/vision/palette.h"
#include "simulator/core/world.h"

namespace vismem {

struct MapBuilderParams {
  double step_m = 0.01;        ///< spacing of the sampled places along an edge
  double side_m = 0.003;       ///< distance from the edge at which its two colours are sampled
  double eye_height_m = 0.45;  ///< height of the viewing camera
  double crease_rad =
      0.35;  ///< smallest angle between faces that makes an edge (round bodies have smaller ones)
  double contact_m = 0.02;     ///< both sides must lie this near: edges seen before a far background are not
                               ///< tied to a place of the map
  double min_length_m = 0.03;  ///< shorter pieces are left out
  double same_place_m =
      0.008;  ///< edges of one label nearer than this are joined (both borders of a thin panel)
  bool join_stripes = true;  ///< false: the single edges of painted lines, cut at junctions
};

/// Views every crease and border of every body from all around, at the height of the robot's camera. Keeps
/// the pieces whose two sides touch and have a named pair of colour classes. Colours are as lit: walls in the
/// sun and in the shade may be two classes. Vertical pieces keep their height; edges within 5 mm of the floor
/// are moved onto it. Only floor segments have z = 0 at both ends. With `join_stripes`, edges of the
/// palette's stripes become stripes (joinStripes). Order: by body, then along the edge.
/// @param progress called after each edge of all; may be empty.
/// @return possibly without segments: then no pair of the palette occurs in the world.
SegmentMap buildSegmentMap(const World& world, const Palette& palette, const MapBuilderParams& params = {},
                           const std::function<void(std::size_t done, std::size_t all)>& progress = {});

}  // namespace vismem
