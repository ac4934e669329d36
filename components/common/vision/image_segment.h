/// @file A labelled segment of an image. Pure. See V1, V3.
#pragma once

#include <string>

#include "common/geometry/segment.h"

namespace vismem {

/// Name of the pair of colours on a segment's sides, as the palette defines it ("skirting", "stripe_edge").
/// Short names stay inside the string: no allocation.
using Label = std::string;

/// The label of a segment without a named colour pair; not used for localization.
inline const Label kUnknownLabel = "unknown";
/// A label of map segments only: matches every known label.
inline const Label kAnyLabel = "any";

/// Invariant: finite ends, length > 0. The brighter side lies to the left of a -> b as seen on the screen, at
/// `middle + (d.y, -d.x)` for d = b - a: the direction carries the polarity of the edge. Seen from above the
/// floor, left stays left, so a back-projected segment keeps it.
struct ImageSegment {
  Segment2 px;  ///< ideal (undistorted) pixels
  Label label = kUnknownLabel;
  double strength = 0.0;  ///< mean brightness difference across the segment [grey levels, 0..255]
};

}  // namespace vismem
