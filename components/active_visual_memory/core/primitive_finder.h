/// @file All shapes that a set of remembered segments makes up. Pure. SPEC M8.
#pragma once

#include <span>
#include <vector>

#include "active_visual_memory/core/circle_finder.h"
#include "active_visual_memory/core/polygon_finder.h"
#include "active_visual_memory/core/stripe_finder.h"
#include "common/visual_memory/memory_snapshot.h"
#include "common/visual_memory/primitive.h"

namespace vismem {

struct PrimitiveParams {
  bool confirmed_only = true;    ///< segments that may stand up make no shape by themselves ..
  double confirmed_share = 0.5;  ///< .. but close one of which so much (of its length) lies on the floor
  double same_place_m = 0.12;    ///< two findings of one kind this near are one, if their sizes agree
  double same_size_share = 0.3;  ///< of the larger
  StripeParams stripes;
  CircleParams circles;
  PolygonParams polygons;
};

/// Shapes without id, life and stamps: circles, then arrows, polygons and stripes of the segments that are
/// left. Of two readings of the same segments the better one stays. What is confirmed comes first; then
/// labelled segments that are not confirmed may complete what it leaves open.
std::vector<Primitive> findPrimitives(std::span<const MemorySegment> segments, const PrimitiveParams& params);

/// One place and size, of one kind: two findings of one shape.
bool sameShape(const Primitive& a, const Primitive& b, const PrimitiveParams& params);

}  // namespace vismem
