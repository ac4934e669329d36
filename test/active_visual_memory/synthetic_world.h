/// @file A world of floor segments and box tops seen by a panning camera on a moving robot: exact geometry,
/// noisy image segments. For tests of the memory without any image processing.
#pragma once

#include <random>
#include <vector>

#include "common/geometry/projection.h"
#include "common/robot/observation.h"
#include "common/vision/image_segment.h"

namespace vismem::testing {

struct WorldSegment {
  Segment3 world;
  bool on_floor = true;
  double seen_from = 1.0;  ///< fractions of the segment that some image showed, from ..
  double seen_to = 0.0;    ///< .. to; empty while from > to
};

struct SyntheticWorld {
  struct Noise {
    double end_along_px = 1.0;
    double end_across_px = 0.35;
    double miss = 0.1;    ///< share of visible segments that the detector drops
    double broken = 0.1;  ///< share that it delivers in two pieces
    double false_per_image = 0.3;
    double tilt_bias_rad = 0.0;  ///< of the real camera against what is reported
  };

  CameraIntrinsics intrinsics;
  CameraMount mount;
  std::vector<WorldSegment> segments;
  Noise noise;
  std::mt19937_64 random{1};
  double min_length_px = 15.0;
  double max_range_m = 3.5;  ///< what a detector still resolves

  /// A 6 x 4 m room: walls' feet, markings on the floor, and box tops when asked for.
  static SyntheticWorld room(std::uint64_t seed, bool boxes);

  RobotObservation observe(StampUs stamp_us, const Pose2& pose, const PanTilt& head) const;
  std::vector<ImageSegment> detect(const RobotObservation& observation);
};

struct MemoryScore {
  int remembered = 0;             ///< elements judged
  int right = 0;                  ///< of them near a true edge
  int truths = 0;                 ///< true floor edges that were seen enough
  int found = 0;                  ///< of them with a right element covering most of what was seen
  double duplicates = 0.0;        ///< right elements per found edge
  double mean_end_error_m = 0.0;  ///< of elements whose both ends are true ends

  double precision() const { return remembered ? static_cast<double>(right) / remembered : 0.0; }
  double recall() const { return truths ? static_cast<double>(found) / truths : 0.0; }
};

}  // namespace vismem::testing
