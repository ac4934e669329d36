/// @file The segment map of a drawing: the edges between colour pairs of a palette. Pure.
#pragma once

#include <string>
#include <vector>

#include "common/segment_map/segment_map.h"
#include "common/vision/palette.h"
#include "simulator/core/svg_drawing.h"

namespace vismem {

struct SvgMapParams {
  SvgOptions drawing;
  std::string ground;           ///< colour class of the unpainted ground; empty: none
  double side_m = 0.001;        ///< distance from an outline at which its two colours are sampled
  double min_length_m = 0.03;   ///< shorter edges are left out
  double same_place_m = 0.008;  ///< edges of one label nearer than this are joined
};

struct SvgMap {
  SegmentMap map;  ///< possibly without segments
  std::vector<std::string> warnings;
};

/// The edges of a drawing of the floor, seen from above, all at z = 0:
/// - the visible outlines of filled shapes and of strokes of 3 cm or more, if the colours on both sides are
///   a pair of the palette; edges of the palette's stripes become stripes (joinStripes);
/// - thinner strokes: the pair of their own colour and the colour below them (of two, the one whose class
///   comes first in the palette);
/// - elements with `data-label`: their outline or line, of any colour; a stripe of the palette with its name
///   and the width of its stroke.
/// @throws ConfigError as parseSvgDrawing, for labels that are not in the palette, and for an unknown
/// `ground`.
SvgMap buildSvgMap(const std::string& bytes, const std::string& file, const Palette& palette,
                   const SvgMapParams& params = {});

}  // namespace vismem
