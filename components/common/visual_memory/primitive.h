/// @file Shapes on the floor that several remembered segments make up. Pure. See M8, M9.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "common/memory/bounded_vector.h"
#include "common/robot/samples.h"

namespace vismem {

/// kStripe: two parallel edges of opposite polarity, the borders of a painted line.
enum class PrimitiveKind { kStripe, kParallelogram, kTriangle, kArrow, kCircle };

/// A shape in odom, plan view [m].
struct Primitive {
  std::uint64_t id = 0;  ///< never used twice; 0 in what a finder returns
  PrimitiveKind kind = PrimitiveKind::kParallelogram;
  /// kStripe: both ends of the middle line. kParallelogram, kTriangle: the corners in turn,
  /// counter-clockwise. kArrow: tip, tail, ends of the heads (left and right of the pointing direction).
  /// kCircle: none.
  BoundedVector<Eigen::Vector2d, 4> vertices;
  /// Mean of the corners, middle of the stripe or circle, middle between tip and tail.
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  /// [rad] in odom: direction of the stripe or of the parallelogram's longer side (in [0, pi)), or of the
  /// arrow.
  double heading_rad = 0.0;
  double length_m = 0.0;  ///< of a stripe or an arrow; longer side of a parallelogram
  double width_m = 0.0;  ///< of a stripe or of a painted circle's line (0: an edge); shorter side; arrow head
  double radius_m = 0.0;  ///< of a circle, of its line's middle
  /// A parallelogram's corner that was inferred from the other three, as index into `vertices`; -1: all seen.
  int hidden_vertex = -1;
  double quality = 0.0;  ///< 0..1, how well the segments fit the shape
  /// Ids of the remembered segments it is made of, sorted. A circle of 2 m radius has 66 chords.
  BoundedVector<std::uint64_t, 80> segments;
  double life = 0.0;
  double salience = 0.0;
  StampUs first_seen_us = 0;
  StampUs last_seen_us = 0;
};

/// A corner that was inferred and not seen yet: a tentative focus of attention (M9).
struct VertexHypothesis {
  std::uint64_t primitive_id = 0;
  Eigen::Vector2d p_odom = Eigen::Vector2d::Zero();  ///< on the floor [m]
};

}  // namespace vismem
