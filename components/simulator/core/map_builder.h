/// @file The segment map of a world: its edges between colours that a palette names. Pure. DESIGN 14.
#pragma once

#include "common/segment_map/segment_map.h"
#include "common/vision/palette.h"
#include "simulator/core/world.h"

namespace vismem {

struct MapBuilderParams {
  double step_m = 0.01;         ///< between the places where an edge is looked at
  double side_m = 0.003;        ///< how far beside the edge its two colours are taken
  double eye_height_m = 0.45;   ///< of the camera that looks at the edges
  double crease_rad = 0.35;     ///< faces that meet at a smaller angle make no edge (round bodies)
  double contact_m = 0.02;      ///< both sides must lie this near: edges seen before a far background are not
                                ///< tied to a place of the map
  double min_length_m = 0.03;   ///< shorter pieces are left out
  double same_place_m = 0.008;  ///< edges of one label nearer than this are one (both rims of a thin panel)
  bool join_stripes = true;     ///< false: the edges of painted lines as they are, parted where lines meet
};

/// Looks at every crease and rim of every body from all around, at the height of the robot's camera, and
/// keeps the pieces whose two sides touch and show a pair of colour classes that the palette names (as lit:
/// walls in the sun and in the shade may be two classes). Vertical pieces keep their height; edges within 5
/// mm of the floor are put onto it: what has z = 0 at both ends lies on the floor, and nothing else does.
/// Edges of the palette's stripes become stripes (joinStripes), unless told otherwise. Order: by body, then
/// along the edge.
/// @return possibly without segments: then no pair of the palette occurs in the world.
SegmentMap buildSegmentMap(const World& world, const Palette& palette, const MapBuilderParams& params = {});

}  // namespace vismem
