/// @file The true edges on the floor and which parts of them were ever shown by an image. Pure. SPEC E1-E4.
/// What is true comes from the map of the world's geometry and from rays in the world itself, never from what
/// is being judged.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "common/geometry/camera.h"
#include "common/geometry/pose.h"
#include "common/geometry/segment.h"
#include "common/segment_map/segment_map.h"

namespace vismem {

/// Everything is sampled along the edge: `samples[i]` is what is known of the point at i * step.
struct TrueEdge {
  struct Sample {
    Eigen::Vector2d p = Eigen::Vector2d::Zero();  ///< in world [m]
    double along_m = 0.0;                         ///< from the edge's beginning
    bool seen = false;
    double nearest_m = 1e9;                            ///< of the views that showed it, along the floor
    Eigen::Vector2d camera = Eigen::Vector2d::Zero();  ///< the floor point below the camera of that view
    double camera_height_m = 0.0;
  };

  Label label;
  /// One piece; or the chain of short pieces that a round outline is drawn with (a curve).
  std::vector<Segment2> pieces;
  bool curve = false;
  bool closed = false;
  double length_m = 0.0;
  std::vector<Sample> samples;
  bool shown_in_full = false;    ///< some image showed all of it
  double longest_view_px = 0.0;  ///< the length of the image of it in the best of those views
};

/// The floor along the ray that one pixel covers in the nearest view of a point that was seen [m].
double floorFootprint(const TrueEdge::Sample& sample, double focal_px);

struct FloorTruthParams {
  double range_m = 4.0;          ///< farther parts do not count as shown (along the floor)
  double step_m = 0.02;          ///< between samples
  double border_px = 2.0;        ///< nearer to the image's border nothing counts as shown
  double curve_piece_m = 0.10;   ///< longer pieces of the map are no part of a curve ..
  double curve_turn_rad = 0.35;  ///< .. nor are those that meet at a larger angle ..
  double touching_m = 1e-2;      ///< .. nor those whose ends are further apart than this (a wide line's
                                 ///< outer rim gapes between its chords)
  int curve_pieces = 8;          ///< of fewer pieces there is no curve
};

/// Is the floor point [m] seen from the place of the camera [m], through everything that stands there?
using SeesFloor = std::function<bool(const Eigen::Vector3d& camera, const Eigen::Vector3d& floor)>;

/// *Single-threaded*.
class FloorTruth {
 public:
  using Params = FloorTruthParams;

  /// @param edges of the map, stripes expanded; what does not lie on the floor is left out.
  explicit FloorTruth(const SegmentMap& edges, const Params& params = {});

  /// Takes note of what an image shows.
  /// @return the edges of which this image shows `least_px` or more.
  int look(const CameraIntrinsics& intrinsics, const Pose3& T_world_camera, const SeesFloor& sees,
           double least_px);

  const std::vector<TrueEdge>& edges() const { return edges_; }

 private:
  Params params_;
  std::vector<TrueEdge> edges_;
};

}  // namespace vismem
