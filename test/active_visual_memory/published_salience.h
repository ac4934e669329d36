/// @file The salience that an attention pool publishes. See A1.
#pragma once

#include <cstdint>
#include <vector>

#include "active_visual_memory/core/gaze/attention.h"

namespace vismem {

/// 0 for what has no point.
inline double salienceOf(const AttentionPool& pool, AttentionKind kind, std::uint64_t id) {
  std::vector<MemorySegment> segments(1);
  std::vector<Primitive> primitives(1);
  segments[0].id = primitives[0].id = id;
  pool.publishSalience(segments, primitives);
  return kind == AttentionKind::kSegment ? segments[0].salience : primitives[0].salience;
}

}  // namespace vismem
