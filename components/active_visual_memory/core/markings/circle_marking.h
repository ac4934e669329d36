/// @file Painted circles, published as regular chords of both edges of their line. Pure. See M9.
#pragma once

#include <cstdint>
#include <functional>
#include <memory_resource>
#include <vector>

#include "active_visual_memory/core/markings/line_marking.h"
#include "common/visual_memory/memory_snapshot.h"
#include "common/visual_memory/primitive.h"

namespace vismem {

/// Chords of distant views are long and lie beside the edge, and the line of a distant circle is measured as
/// narrow as the blur of the image.
struct CircleMarkingParams {
  double edge_distance_m = 0.06;   ///< of a chord from the edge of the line that it belongs to
  double edge_angle_rad = 0.35;    ///< between chord and edge
  double max_chord_share = 1.415;  ///< of the radius: a quarter of the circle in one chord
  double sagitta_m = 0.01;         ///< of the published chords
  double confirmed_share = 0.3;    ///< of the circumference that confirmed chords must cover
  double edge_share = 0.3;         ///< of an edge that must be observed to complete it from the other one
  double max_gap_rad = 1.05;       ///< an edge is continued over unobserved intervals up to this
};

/// Replaces the chords of a circle by regular ones on both edges of its line. If lines of its label have a
/// known width and chords of both edges were observed, the circle has that width, and the polarity of a chord
/// names its edge. Nothing changes below the confirmed share.
/// @param circle  then names the published chords, with their radius and width.
/// @param widths  of line markings by label.
/// @param id_of   id of the n-th chord of an edge (0: inner, 1: outer).
void regularizeCircle(std::vector<MemorySegment>& segments, Primitive& circle, const LineWidths& widths,
                      const CircleMarkingParams& params, const std::function<std::uint64_t(int, int)>& id_of,
                      std::pmr::memory_resource* scratch = std::pmr::get_default_resource());

}  // namespace vismem
