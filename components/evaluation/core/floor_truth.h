/// @file The true edges on the floor and the parts of them that images showed. Pure. See E1, E2, E3, E4.
/// The truth comes from the map of the world's geometry and from rays in the world, never from the memory.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "common/geometry/camera.h"
#include "common/geometry/pose.h"
#include "common/geometry/segment.h"
#include "common/segment_map/segment_map.h"

namespace vismem {

/// An edge with samples along it: `samples[i]` describes the point at i * step.
struct TrueEdge {
  struct Sample {
    Eigen::Vector2d p = Eigen::Vector2d::Zero();  ///< in world [m]
    double along_m = 0.0;                         ///< from the edge's beginning
    bool seen = false;
    double nearest_m = 1e9;                            ///< distance of the nearest view, along the floor
    Eigen::Vector2d camera = Eigen::Vector2d::Zero();  ///< the floor point below that view's camera
    double camera_height_m = 0.0;
  };

  Label label;
  /// One piece, or the chain of short pieces of a round outline (a curve).
  std::vector<Segment2> pieces;
  bool curve = false;
  bool closed = false;
  double length_m = 0.0;
  std::vector<Sample> samples;
  bool shown_in_full = false;    ///< at least one image showed all of it
  double longest_view_px = 0.0;  ///< its longest projection among those images
};

/// Floor length along the viewing ray that one pixel covers, in the nearest view of a seen point [m].
double floorFootprint(const TrueEdge::Sample& sample, double focal_px);

struct FloorTruthParams {
  double range_m = 4.0;          ///< along the floor; farther parts do not count as shown
  double step_m = 0.02;          ///< between samples
  double border_px = 2.0;        ///< points nearer to the image's border do not count as shown
  double curve_piece_m = 0.10;   ///< longest piece of a curve
  double curve_turn_rad = 0.35;  ///< largest angle between neighbouring pieces of a curve
  double touching_m = 1e-2;      ///< largest gap between them (chords of a wide line's outer edge leave gaps)
  int curve_pieces = 8;          ///< fewest pieces of a curve
};

/// @return whether the floor point [m] is visible from the camera [m], with all objects in between.
using SeesFloor = std::function<bool(const Eigen::Vector3d& camera, const Eigen::Vector3d& floor)>;

/// *Single-threaded*.
class FloorTruth {
 public:
  using Params = FloorTruthParams;

  /// @param edges of the map, stripes expanded; edges above the floor are left out.
  explicit FloorTruth(const SegmentMap& edges, const Params& params = {});

  /// Adds the visible parts of one image.
  /// @return the number of edges of which this image shows `least_px` or more.
  int addView(const CameraIntrinsics& intrinsics, const Pose3& T_world_camera, const SeesFloor& sees,
              double least_px);

  const std::vector<TrueEdge>& edges() const { return edges_; }

 private:
  Params params_;
  std::vector<TrueEdge> edges_;
};

}  // namespace vismem
