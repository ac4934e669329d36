/// @file What an attention pool and a gaze controller publish. See A1.
#pragma once

#include <cstdint>
#include <vector>

#include "active_visual_memory/core/gaze/attention.h"
#include "active_visual_memory/core/gaze/gaze_controller.h"

namespace vismem {

/// 0 for what has no point.
inline double salienceOf(const AttentionPool& pool, AttentionKind kind, std::uint64_t id) {
  std::vector<MemorySegment> segments(1);
  std::vector<Primitive> primitives(1);
  segments[0].id = primitives[0].id = id;
  pool.publishSalience(segments, primitives);
  return kind == AttentionKind::kSegment ? segments[0].salience : primitives[0].salience;
}

inline std::vector<AttentionPoint> pointsOf(const AttentionPool& pool) {
  std::vector<AttentionPoint> points;
  pool.listPoints(points);
  return points;
}

inline GazeStatus statusOf(const GazeController& gaze, StampUs now_us, const AttentionPool& pool) {
  GazeStatus status;
  gaze.report(now_us, pool, status);
  return status;
}

}  // namespace vismem
