/// @file Parameters of SegmentMemory, divided by its steps. Pure. See M1-M6.
#pragma once

#include <numbers>

#include "active_visual_memory/core/estimation/dominant_direction.h"
#include "active_visual_memory/core/estimation/map_filter.h"
#include "active_visual_memory/core/ground/camera_tilt.h"
#include "active_visual_memory/core/ground/floor_evidence.h"
#include "active_visual_memory/core/ground/floor_line.h"
#include "active_visual_memory/core/memory/data_association.h"
#include "active_visual_memory/core/memory/life.h"
#include "active_visual_memory/core/memory/parallax.h"
#include "active_visual_memory/core/memory/published_edge.h"
#include "common/config/parameter_visitor.h"

namespace vismem {

/// Which elements an image can show, and how far they may lie from what it shows.
struct MemoryGateParams {
  double cache_radius_m = 4.0;          ///< M5
  double max_range_m = 4.0;             ///< as of the projector
  double max_absence_turn_radps = 0.6;  ///< turn rate of the camera up to which absence is evidence
  double near_distance_m = 0.06;        ///< gate on the floor (M3; M2 multiplies it by kDuplicateGateShare)
  double slack_m = 0.005;               ///< sigma of a match on the floor that the covariances do not model
  double drift_per_m = 0.01;            ///< odometry drift per metre driven while an element was not seen
  double drift_per_rad = 0.003;         ///< heading drift per radian turned [rad]

  void visit(ParameterVisitor& v);
};

/// Odometry drift, camera tilt and lines in one filter (M6).
struct MemoryEstimationParams {
  bool enabled = true;
  TiltPrior tilt_prior;                        ///< of the camera tilt, estimated with the drift
  DominantDirectionParams dominant_direction;  ///< of long lines, which measure the camera tilt
  /// Lines also measure the heading against the dominant direction of the memory. For odometry whose heading
  /// errs more than the directions of lines: legs.
  bool use_dominant_direction = false;
  /// A per-frame tilt of at least this makes the robot legged: association and update are iterated once. A
  /// tilt of 1 degree moves a line 3 m away half way to another one 0.6 m behind it.
  double min_legged_tilt_rad = 0.25 * std::numbers::pi / 180.0;
  MapFilter::Params map_filter;  ///< `together_rad` is taken from dominant_direction

  void visit(ParameterVisitor& v);
};

/// Which elements are published as lying on the floor (M1).
struct MemoryConfirmationParams {
  bool by_parallax = true;  ///< false: all is confirmed at once, as in the chapter
  bool unlabelled = true;   ///< false: elements without label (a shadow, a pattern) are never confirmed
  /// Publishes lines that deviate from the dominant direction by at most a pixel at their ends with that
  /// direction. Others are confirmed from 0.1 m: the outline of a smaller spot has no straight edges.
  bool snap_to_dominant_direction = false;
  ParallaxEstimate::Params parallax;
  CornerParams corners;  ///< of confirmed edges, which confirm the edges between them
};

/// How long elements stay (M4).
struct MemoryRetentionParams {
  LifeParams life;
  int min_sightings = 3;  ///< an element seen in fewer images is tentative: not published
  int max_elements = 1000;
  double unverified_decay = 4.0;  ///< factor of the decay out of view of elements that may be vertical edges
};

struct SegmentMemoryParams {
  enum class Fusion { kChapter, kCovariance };

  Fusion fusion = Fusion::kCovariance;
  MemoryGateParams gates;
  AssociationParams association;
  MemoryEstimationParams estimation;
  MemoryConfirmationParams confirmation;
  MemoryRetentionParams retention;
  FloorLine::Params line;
  FloorEvidence::Params evidence;
  int gap_votes = 0;  ///< images that must see a gap in a line to split it; 0: lines are not split

  void visit(ParameterVisitor& v);
  /// Newest orientation, every absence alike, no confirmation, life in ticks of 200 ms.
  static SegmentMemoryParams chapter();
};

}  // namespace vismem
