/// @file Edges that lie on the floor because confirmed edges meet them. Pure. See M1, M9.
#pragma once

#include <memory_resource>
#include <span>

#include "active_visual_memory/core/memory/published_edge.h"

namespace vismem {

/// Publishes as confirmed an edge that continues a confirmed edge in its line, or meets its end at a corner.
/// An edge at height h, seen from one place, is projected further from the camera by h / (H - h) of its
/// distance, so it would be in line with the other one, or end where that one ends, only by chance. Confirmed
/// edges confirm further ones. Needed: a label, both true ends, a view across the viewing ray, and no
/// parallax that contradicts the floor.
/// @param limit  largest h / (H - h) of what counts as lying on the floor
/// (ParallaxEstimate::Params::slopeLimit).
void confirmContinuations(std::span<MemoryElement> elements, double limit, const CornerParams& params,
                          std::pmr::memory_resource* scratch = std::pmr::get_default_resource());

}  // namespace vismem
