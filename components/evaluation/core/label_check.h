/// @file Labels of detected segments against the map's edges that they lie on, seen from true poses. Pure.
/// See V3.
#pragma once

#include <map>
#include <vector>

#include "common/geometry/camera.h"
#include "common/segment_map/segment_map.h"
#include "common/vision/image_segment.h"

namespace vismem {

struct LabelCheckParams {
  double angle_rad = 0.09;     ///< between a detected segment and its edge
  double distance_px = 2.5;    ///< of both ends from the edge's line
  double ambiguous_px = 1.5;   ///< another label's edge so little further away leaves the segment out
  double least_overlap = 0.7;  ///< share of the detected segment that lies beside the edge
  double max_range_m = 6.0;    ///< in plan view
};

/// Detected lengths on edges of one true label.
struct LabelLengths {
  std::map<Label, double> found_px;  ///< by the label that was found

  double total_px() const;
  /// @return share of the length that has this label; 0 without a length.
  double share(const Label& label) const;
};

/// *Single-threaded*.
class LabelCheck {
 public:
  /// @param edges     stripes expanded; rows of the label `any` are left out.
  /// @param obstacles boxes that hide edges.
  LabelCheck(const SegmentMap& edges, std::vector<Segment3> obstacles, const LabelCheckParams& params = {});

  /// Adds one image. @param T_world_camera true pose of the camera.
  void add(const std::vector<ImageSegment>& observed, const CameraIntrinsics& intrinsics,
           const Pose3& T_world_camera);

  /// By true label.
  const std::map<Label, LabelLengths>& lengths() const { return lengths_; }

 private:
  std::vector<MapSegment> edges_;
  std::vector<Segment3> obstacles_;
  LabelCheckParams params_;
  std::map<Label, LabelLengths> lengths_;
};

}  // namespace vismem
