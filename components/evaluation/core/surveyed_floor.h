/// @file A memory against a survey of the floor: true edges, edges too weak to judge, and boxes that hide floor.
/// For recordings of real or path-traced rooms. Pure. See E1.
#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

#include "evaluation/core/floor_truth.h"
#include "evaluation/core/memory_score.h"

namespace vismem {

/// Reads rows `x1_m,y1_m,z1_m,x2_m,y2_m,z2_m[,name]` after a header line; `#` starts a comment. A row is an edge,
/// or a box by two opposite corners.
/// @throws ConfigError with every problem: FILE:LINE, what was found, what was expected.
std::vector<Segment3> parseSurvey(std::string_view text, const std::string& file_name);

/// @param boxes opposite corners [m]; their sides are parallel to the axes.
/// @return whether a box stands between two points [m]. A box that only touches the second point hides nothing.
bool isHidden(const Eigen::Vector3d& from, const Eigen::Vector3d& to, const std::vector<Segment3>& boxes);

/// Agreement of the confirmed elements with the surveyed edges.
struct SurveyScore {
  int judged = 0;  ///< confirmed elements, those on neutral edges left out
  int right = 0;   ///< of those, with both ends where the edge was last visible
  int shown = 0;   ///< surveyed edges of which one image showed all
  int found = 0;   ///< of those
  double elements_per_edge = 0.0;
  double line_rms_m = 0.0;  ///< distance of the ends of elements from the lines of their edges

  double precision() const { return judged > 0 ? static_cast<double>(right) / judged : 0.0; }
  double recall() const { return shown > 0 ? static_cast<double>(found) / shown : 0.0; }
};

/// *Single-threaded*.
class SurveyedFloor {
 public:
  /// @param edges      of the floor, stripes expanded; edges above the floor are left out.
  /// @param neutral    edges that count neither as found nor as false, such as joints of tiles.
  /// @param obstacles  boxes that hide floor.
  SurveyedFloor(const SegmentMap& edges, std::vector<Segment3> neutral, std::vector<Segment3> obstacles);

  /// Adds what one image shows. @param T_world_camera true pose of the camera.
  void addView(const CameraIntrinsics& intrinsics, const Pose3& T_world_camera);

  /// @param memory in world.
  SurveyScore score(const std::vector<RememberedEdge>& memory, const MemoryScoreParams& params = {}) const;

 private:
  FloorTruth edges_;
  std::vector<Segment3> neutral_;
  std::vector<Segment3> obstacles_;
};

}  // namespace vismem
