/// @file Segments as a detector would see them, made up from the map: what is visible, with a detector's
/// errors. Pure. SPEC E5-E8, L12.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include "common/geometry/pose.h"
#include "common/vision/image_segment.h"
#include "experiments/trials/measured_errors.h"
#include "experiments/trials/visible_pieces.h"
#include "experiments/trials/vision_statistics.h"
#include "localization/core/random_engine.h"

namespace vismem {

/// How a detector errs. The values were fitted to what `experiment E6 --variant vision` measures on rendered
/// images (docs/localization.md).
struct VisionErrors {
  /// A piece of length L is found with probability `found / (1 + exp((half_px - L) / soft_px))`.
  double found = 0.9995;
  double half_px = 10.8;
  double soft_px = 1.7;
  /// Correlation of the luck of one edge from one image to the next 0.1 s later.
  double persistence = 0.9;
  /// What is seen again and again errs alike again and again. Shares of the variance of the normal errors
  /// from which all are made: what is an error of the map and stays, and what lasts for about `lasts_s`; the
  /// rest is new in each image.
  struct Lasting {
    double always = 0.0;
    double lasting = 0.0;
    double lasts_s = 15.0;
  };
  /// Of edges on the floor errors are made up by their quantiles, in the ranges of VisionStatistics. Normal
  /// ones of the same standard deviation, or symmetrical ones, would push a localization that gets over ends
  /// that are short, but not over those that reach too far.
  struct ByRange {
    ErrorsByRange px{};
    Lasting same;
  };
  ByRange across_floor{kMeasuredAcrossFloor, {0.45, 0.28, 1.0}};  ///< `always`: both ends alike
  /// Of an end of the edge itself (positive: too long) ..
  ByRange along_floor{kMeasuredAlongFloor, {0.47, 0.25, 15.0}};
  /// .. and of one where something nearer hides what follows.
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
  double border_px = 2.2;  ///< where the image's border cuts a line, so much is not found
  /// Mean lengths between breaks; 0: never broken.
  double floor_broken_every_px = 70000.0;
  double upright_broken_every_px = 8000.0;
  double gap_px = 6.0;     ///< of a break
  double unknown = 0.004;  ///< share of found pieces without a label
  /// Ends of walls' outlines (visibleOutlines) are new in each image.
  ErrorQuantiles outline_foot{kMeasuredOutlineFoot};
  ErrorQuantiles outline_top{kMeasuredOutlineTop};
  ErrorQuantiles outline_across{kMeasuredOutlineAcross};
  /// Share of those that are long enough to be found. In images it is 0.95 to 0.98; made up so, they pull the
  /// position further than images do, for a reason that is not known, so there are none unless asked for.
  double outlines_found = 0.0;
  double false_on_floor = 0.13;    ///< share of the false ones with a label of the floor's edges
  double false_per_image = 0.165;  ///< labelled segments of nothing, each seen once
  double longest_false_px = 126.0;
  double least_px = 4.0;  ///< shorter ones are not reported
};

/// What is done to the observations beside the detector's own errors.
struct Disturbance {
  /// Of all labelled segments, this share is of things that are not in the map: they lie on the floor near
  /// the robot for a while, with labels of the map.
  double false_share = 0.0;
  double lost_share = 0.0;  ///< of all segments, independently
  double clutter_s = 3.0;   ///< mean time for which a false thing lies there
};

/// *Single-threaded*. The same seed and calls give the same segments.
class SyntheticVision {
 public:
  /// @param edges of the map, stripes expanded.
  /// @param map_seed of the errors that are the map's, and the same in all images.
  SyntheticVision(const SegmentMap& edges, const VisionErrors& errors, const Disturbance& disturbance,
                  std::uint64_t seed, std::uint64_t map_seed);

  /// One image.
  std::vector<ImageSegment> look(double time_s, const CameraIntrinsics& intrinsics,
                                 const Pose3& T_world_camera, const CastRay& cast);

 private:
  /// Values of standard normals that change with time.
  struct EndState {
    double across = 0.0;
    double along = 0.0;
    double hidden = 0.0;
  };
  /// What is remembered of an edge from image to image.
  struct EdgeState {
    double time_s = -1e9;
    double luck = 0.0;
    EndState a;
    EndState b;
  };
  /// What the map errs by at an edge, as values of standard normals.
  struct MapError {
    double across = 0.0;
    double along_a = 0.0;
    double along_b = 0.0;
  };
  struct Clutter {
    Segment3 world;
    Label label;
    double until_s = 0.0;
  };

  void age(double time_s, bool on_floor, EdgeState& state);
  /// By how much an end of a piece that was found lies beside its line and beyond its end [px].
  Eigen::Vector2d endError(const CameraIntrinsics& intrinsics, const VisiblePiece& piece, bool first,
                           bool on_floor, const EndState& state);
  double fresh(const VisionErrors::Lasting& same, double always, double lasting);
  void addPiece(double time_s, const CameraIntrinsics& intrinsics, const VisiblePiece& piece,
                std::vector<ImageSegment>& image);
  void addFalse(const CameraIntrinsics& intrinsics, std::vector<ImageSegment>& image);
  void addClutter(double time_s, const CameraIntrinsics& intrinsics, const Pose3& T_world_camera,
                  std::vector<ImageSegment>& image);
  /// Of one of the map's edges: of what touches the floor, or of what does not.
  const Label& anyLabel(bool on_floor);
  Eigen::Vector2d anyPixel(const CameraIntrinsics& intrinsics);

  SegmentMap edges_;
  VisionErrors errors_;
  Disturbance disturbance_;
  RandomEngine engine_;
  std::vector<Label> floor_labels_;    ///< of what touches the floor
  std::vector<Label> upright_labels_;  ///< of the other edges
  std::map<int, EdgeState> states_;
  std::map<int, EdgeState> outline_states_;
  std::vector<MapError> map_errors_;  ///< of each edge
  std::vector<Clutter> clutter_;
};

/// @param disturbance its lost_share: the disturbance of images that were rendered.
void loseSegments(const Disturbance& disturbance, RandomEngine& engine, std::vector<ImageSegment>& image);

}  // namespace vismem
