/// @file Synthetic segments: the visible edges of the map with the errors of a detector. Pure. See E5, E6,
/// E7, E8, L12.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include "common/geometry/pose.h"
#include "common/vision/image_segment.h"
#include "experiments/trials/clutter.h"
#include "experiments/trials/measured_errors.h"
#include "experiments/trials/visible_pieces.h"
#include "experiments/trials/vision_statistics.h"
#include "localization/core/random_engine.h"

namespace vismem {

/// The error model of a detector. The values were fitted to the measurements of `experiment E6 --variant
/// vision` on rendered images.
struct VisionErrors {
  /// A piece of length L is found with probability `found / (1 + exp((half_px - L) / soft_px))`.
  double found = 0.9995;
  double half_px = 10.8;
  double soft_px = 1.7;
  /// Correlation of the detection of one edge between images 0.1 s apart.
  double persistence = 0.9;
  /// Errors of neighbouring images are correlated. Shares of the variance of the underlying normal errors:
  /// `always` is constant (an error of the map), `lasting` has the time constant `lasts_s`, the rest is new
  /// in each image.
  struct Lasting {
    double always = 0.0;
    double lasting = 0.0;
    double lasts_s = 15.0;
  };
  /// Errors of floor edges follow measured quantiles, by the ranges of VisionStatistics. They are not
  /// symmetric: ends beyond the true end bias localization, ends short of it do not.
  struct ByRange {
    ErrorsByRange px{};
    Lasting same;
  };
  ByRange across_floor{kMeasuredAcrossFloor, {0.45, 0.28, 1.0}};  ///< `always`: both ends alike
  /// At an end of the edge itself (positive: too long).
  ByRange along_floor{kMeasuredAlongFloor, {0.47, 0.25, 15.0}};
  /// At an end where a nearer object occludes the edge.
  ErrorQuantiles hidden_end{kMeasuredHidden};
  Lasting hidden_end_same{0.0, 0.4, 15.0};
  /// Standard deviations of other edges' errors: the part that lasts, and the part that is new in each image.
  struct Spread {
    double lasting_px = 0.0;
    double fresh_px = 0.0;
  };
  double upright_lasts_s = 15.0;
  Spread across_upright{0.12, 0.28};
  Spread along_upright{0.85, 0.64};
  double along_upright_mean_px = -1.0;
  double border_px = 2.2;  ///< undetected length where the image's border cuts a line
  /// Mean lengths between breaks; 0: never broken.
  double floor_broken_every_px = 70000.0;
  double upright_broken_every_px = 8000.0;
  double gap_px = 6.0;     ///< of a break
  double unknown = 0.004;  ///< share of found pieces without a label
  /// Ends of walls' outlines (visibleOutlines) are new in each image.
  ErrorQuantiles outline_foot{kMeasuredOutlineFoot};
  ErrorQuantiles outline_top{kMeasuredOutlineTop};
  ErrorQuantiles outline_across{kMeasuredOutlineAcross};
  /// Share of sufficiently long outlines that are found. Images have 0.95 to 0.98. Synthetic outlines of this
  /// share bias the position more than images do, for an unknown reason, so the default is none.
  double outlines_found = 0.0;
  double false_on_floor = 0.13;    ///< share of the false ones with a label of the floor's edges
  double false_per_image = 0.165;  ///< false labelled segments, each seen once
  double longest_false_px = 126.0;
  double least_px = Clutter::kLeast_px;  ///< shorter ones are not reported
};

/// *Single-threaded*. The same seed and calls give the same segments.
class SyntheticVision {
 public:
  /// @param edges of the map, stripes expanded.
  /// @param map_seed of the map's errors, equal in all images.
  SyntheticVision(const SegmentMap& edges, const VisionErrors& errors, const Disturbance& disturbance,
                  std::uint64_t seed, std::uint64_t map_seed);

  /// The segments of one image.
  std::vector<ImageSegment> observe(double time_s, const CameraIntrinsics& intrinsics,
                                    const Pose3& T_world_camera, const CastRay& cast);

 private:
  /// Values of standard normals that change with time.
  struct EndState {
    double across = 0.0;
    double along = 0.0;
    double hidden = 0.0;
  };
  /// The state of an edge between images.
  struct EdgeState {
    double time_s = -1e9;
    double luck = 0.0;
    EndState a;
    EndState b;
  };
  /// The map's errors at an edge, as values of standard normals.
  struct MapError {
    double across = 0.0;
    double along_a = 0.0;
    double along_b = 0.0;
  };

  void age(double time_s, bool on_floor, EdgeState& state);
  /// Distances of the end of a found piece beside its line and beyond its end [px].
  Eigen::Vector2d endError(const CameraIntrinsics& intrinsics, const VisiblePiece& piece, bool first,
                           bool on_floor, const EndState& state);
  double fresh(const VisionErrors::Lasting& same, double always, double lasting);
  void addPiece(double time_s, const CameraIntrinsics& intrinsics, const VisiblePiece& piece,
                std::vector<ImageSegment>& image);
  void addFalse(const CameraIntrinsics& intrinsics, std::vector<ImageSegment>& image);
  /// The label of a random edge of the map, on the floor or above it.
  const Label& anyLabel(bool on_floor);

  SegmentMap edges_;
  VisionErrors errors_;
  Disturbance disturbance_;
  RandomEngine engine_;
  std::vector<Label> floor_labels_;    ///< of edges on the floor
  std::vector<Label> upright_labels_;  ///< of the other edges
  std::map<int, EdgeState> states_;
  std::map<int, EdgeState> outline_states_;
  std::vector<MapError> map_errors_;  ///< of each edge
  Clutter clutter_;
};

}  // namespace vismem
