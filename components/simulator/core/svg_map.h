/// @file The segment map of a drawing: the edges between colours that a palette names. Pure. DESIGN 9,
/// 11, 14.
#pragma once

#include <string>
#include <vector>

#include "common/segment_map/segment_map.h"
#include "common/vision/palette.h"
#include "simulator/core/svg_drawing.h"

namespace vismem {

struct SvgMapParams {
  SvgOptions drawing;
  std::string ground;           ///< colour class of where nothing is painted; empty: none
  double side_m = 0.001;        ///< how far beside an outline its two colours are taken
  double min_length_m = 0.03;   ///< shorter edges are left out
  double same_place_m = 0.008;  ///< edges of one label nearer than this are one
};

struct SvgMap {
  SegmentMap map;  ///< possibly without segments
  std::vector<std::string> warnings;
};

/// What a drawing of the floor, seen from above, has in edges, all at z = 0:
/// - the outlines of filled shapes and of strokes of 3 cm or more, where they are not covered and the colours
/// on both
///   sides are a pair of the palette; edges of the palette's stripes become stripes (joinStripes);
/// - thinner strokes: the pair of their own colour with what they lie upon (of two, the one whose class the
/// palette
///   names first);
/// - elements with `data-label`: their outline or line, whatever its colours; a stripe of the palette by its
/// name,
///   with the width of its stroke.
/// @throws ConfigError as parseSvgDrawing, for labels that the palette does not have, and for an unknown
/// `ground`.
SvgMap buildSvgMap(const std::string& bytes, const std::string& file, const Palette& palette,
                   const SvgMapParams& params = {});

}  // namespace vismem
