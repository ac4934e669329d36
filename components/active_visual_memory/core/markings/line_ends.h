/// @file The short edges at the ends of line markings. Pure. See M9.
#pragma once

#include <cstdint>
#include <functional>
#include <memory_resource>
#include <span>
#include <vector>

#include "active_visual_memory/core/markings/line_marking.h"

namespace vismem {

/// Adds the end edge, a few pixels long at best, where both edges of a line marking end together and nothing
/// goes on. An observed end edge is put square to its line.
/// @param edges   the segments with their elements.
/// @param widths  that line markings may have.
/// @param id_of   id of the end edge from end b of one edge to end a of another.
void closeLineEnds(std::vector<MemorySegment>& segments, std::span<const PublishedEdge> edges,
                   const LineWidthRange& widths,
                   const std::function<std::uint64_t(std::uint64_t, std::uint64_t)>& id_of,
                   std::pmr::memory_resource* scratch = std::pmr::get_default_resource());

}  // namespace vismem
