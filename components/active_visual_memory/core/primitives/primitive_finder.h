/// @file All shapes that a set of remembered segments makes up.
/// Pure. Implements M8.
#pragma once

#include <memory_resource>
#include <span>

#include "active_visual_memory/core/primitives/finders.h"
#include "common/visual_memory/memory_snapshot.h"
#include "common/visual_memory/primitive.h"

namespace vismem {

struct PrimitiveParams {
  bool confirmed_only = true;    ///< unconfirmed segments make no shape
  double same_place_m = 0.12;    ///< two findings of one kind this near are one, if their sizes agree
  double same_size_share = 0.3;  ///< of the larger
  StripeParams stripes;
  CircleParams circles;
  PolygonParams polygons;
  ArrowParams arrows;
};

/// Shapes without id, life and stamps: circles, then arrows, polygons and stripes of the remaining segments.
/// Of two readings of the same segments the better one is kept.
Shapes findPrimitives(std::span<const MemorySegment> segments, const PrimitiveParams& params,
                      std::pmr::memory_resource* scratch);

/// Whether two findings are one shape: of one kind, at one place, of one size.
bool sameShape(const Primitive& a, const Primitive& b, const PrimitiveParams& params);

}  // namespace vismem
