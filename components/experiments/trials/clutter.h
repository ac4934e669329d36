/// @file Disturbances of observed segments beside a detector's own errors: objects that the map lacks, and
/// losses. Pure. See E6, L12.
#pragma once

#include <vector>

#include "common/geometry/camera.h"
#include "common/geometry/pose.h"
#include "common/segment_map/segment_map.h"
#include "common/vision/image_segment.h"
#include "localization/core/random_engine.h"

namespace vismem {

struct Disturbance {
  /// Share of labelled segments that belong to unmapped objects: they lie on the floor near the robot for a
  /// while, with labels of the map.
  double false_share = 0.0;
  double lost_share = 0.0;  ///< of all segments, independently
  double clutter_s = 3.0;   ///< mean time for which an unmapped object stays
};

/// Unmapped objects on the floor. *Single-threaded*. The same engine and calls give the same segments.
class Clutter {
 public:
  /// Shorter segments are not observed.
  static constexpr double kLeast_px = 4.0;

  /// @param edges of the map, whose labels on the floor the objects have.
  Clutter(const Disturbance& disturbance, const SegmentMap& edges);

  /// Adds as many false segments as the image's labelled ones ask for.
  void add(double time_s, const CameraIntrinsics& intrinsics, const Pose3& T_world_camera,
           RandomEngine& engine, std::vector<ImageSegment>& image);

 private:
  struct Object {
    Segment3 world;
    Label label;
    double until_s = 0.0;
  };

  Disturbance disturbance_;
  std::vector<Label> labels_;
  std::vector<Object> objects_;
};

/// Removes the share `disturbance.lost_share` of the segments.
void loseSegments(const Disturbance& disturbance, RandomEngine& engine, std::vector<ImageSegment>& image);

}  // namespace vismem
