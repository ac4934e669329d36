/// @file Painted circles told in regular chords on their rims. Pure. SPEC M9.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "active_visual_memory/core/line_sides.h"
#include "common/visual_memory/memory_snapshot.h"
#include "common/visual_memory/primitive.h"

namespace vismem {

/// Chords of views from afar are long and lie beside the rim, and the line of a far circle seems as thin as
/// the blur of the image lets it.
struct CircleRimParams {
  double rim_m = 0.06;              ///< distance of a chord from the rim that it belongs to
  double rim_angle_rad = 0.35;      ///< between a chord and the rim
  double most_chord_share = 1.415;  ///< of the radius: a quarter of the circle in one chord
  double sagitta_m = 0.01;          ///< of the chords that a circle is told in
  double confirmed_share = 0.3;     ///< of the circumference that confirmed chords must cover
  double rim_share = 0.3;      ///< of a rim that must be seen to tell it also where only the other one was
  double most_gap_rad = 1.05;  ///< a rim goes on over a stretch up to this long that nobody saw
};

/// Tells a circle in regular chords instead of those found, on both rims of its line. Where lines of its
/// label have a known width and chords of both rims were seen, so has this one, and a chord belongs to the
/// rim that its polarity says; else both are as they were found. Nothing changes when too little of it is
/// confirmed.
/// @param circle then names the chords that it is told in, with the radius and width that they have.
/// @param widths of painted lines. @param id_of the id of the n-th chord of a rim.
void tellCircle(std::vector<MemorySegment>& segments, Primitive& circle, const LineWidths& widths,
                const CircleRimParams& params, const std::function<std::uint64_t(int, int)>& id_of);

}  // namespace vismem
