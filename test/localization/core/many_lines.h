/// @file A large map of lines, and the parameters of its index.
#pragma once

#include "localization/core/map/map_index.h"
#include "localization/core/random_engine.h"

namespace vismem {

inline MapIndex::Params withFields(bool build_fields) {
  MapIndex::Params params;
  params.build_fields = build_fields;
  return params;
}

/// Lines all over the floor; those of the second label stand among posts, of which only the feet are there.
inline SegmentMap manyLines(RandomEngine& engine) {
  SegmentMap map;
  for (int i = 0; i < 3000; ++i) {
    const Eigen::Vector3d a(uniform(engine, 0, 100), uniform(engine, 0, 100), 0.0);
    const Eigen::Vector3d way(uniform(engine, -4, 4), uniform(engine, -4, 4), 0.0);
    const bool is_post = i % 7 == 0;
    map.segments.push_back({{a, is_post ? Eigen::Vector3d(a + 2.0 * Eigen::Vector3d::UnitZ()) : a + way},
                            is_post || i % 3 == 0 ? "door" : "skirting",
                            0.0});
  }
  return map;
}

}  // namespace vismem
