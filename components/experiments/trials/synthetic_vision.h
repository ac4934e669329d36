/// @file Segments as a detector would see them, made up from the map: what is visible, with a detector's
/// errors. Pure. SPEC E5-E8, L12.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include "common/geometry/pose.h"
#include "common/vision/image_segment.h"
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
  /// Standard deviations of an end's error [px]: the part that stays while the edge is seen, and changes
  /// over about `lasting_s`, and the part that is new in each image.
  struct Spread {
    double lasting_px = 0.0;
    double fresh_px = 0.0;
  };
  double lasting_s = 15.0;
  Spread across_floor{0.075, 0.075};  ///< across the line; edges on the floor ..
  Spread across_upright{0.12, 0.28};  ///< .. and others
  /// Along an edge on the floor most ends are found to a third of a pixel and a few are pixels off: Student's
  /// t of two degrees of freedom. (Normal errors of the same standard deviation err twice as far half of the
  /// time, and a robust localization as much further.)
  struct HeavySpread {
    /// By range, in the bins of VisionStatistics: half of the errors are less than 0.82 of it.
    std::array<double, VisionStatistics::kRanges_m.size()> scale_px{};
    double lasting_share = 0.0;  ///< of the variance of the normal error that it is made from
    double most_px = 0.0;
  };
  HeavySpread along_floor{{0.68, 0.44, 0.35, 0.38, 0.42, 0.84}, 0.7, 8.0};
  Spread along_upright{0.85, 0.64};
  double along_floor_median_px = -0.12;  ///< an end lies beyond the true one by this
  double along_upright_mean_px = -1.0;
  double border_px = 2.2;  ///< where the image's border cuts a line, so much is not found
  /// Mean lengths between breaks; 0: never broken.
  double floor_broken_every_px = 70000.0;
  double upright_broken_every_px = 8000.0;
  double gap_px = 6.0;            ///< of a break
  double unknown = 0.004;         ///< share of found pieces without a label
  double false_per_image = 0.39;  ///< labelled segments of nothing, each seen once
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
  SyntheticVision(const SegmentMap& edges, const VisionErrors& errors, const Disturbance& disturbance,
                  std::uint64_t seed);

  /// One image.
  std::vector<ImageSegment> look(double time_s, const CameraIntrinsics& intrinsics,
                                 const Pose3& T_world_camera, const CastRay& cast);

 private:
  /// What is remembered of an edge from image to image; values of standard normals.
  struct EdgeState {
    double time_s = -1e9;
    double luck = 0.0;
    double across = 0.0;
    double along_a = 0.0;
    double along_b = 0.0;
  };
  struct Clutter {
    Segment3 world;
    Label label;
    double until_s = 0.0;
  };

  void addPiece(double time_s, const CameraIntrinsics& intrinsics, const VisiblePiece& piece,
                std::vector<ImageSegment>& image);
  void addFalse(const CameraIntrinsics& intrinsics, std::vector<ImageSegment>& image);
  void addClutter(double time_s, const CameraIntrinsics& intrinsics, const Pose3& T_world_camera,
                  std::vector<ImageSegment>& image);
  const Label& anyLabel();
  Eigen::Vector2d anyPixel(const CameraIntrinsics& intrinsics);

  SegmentMap edges_;
  VisionErrors errors_;
  Disturbance disturbance_;
  RandomEngine engine_;
  std::vector<Label> floor_labels_;  ///< of what touches the floor
  std::map<int, EdgeState> states_;
  std::vector<Clutter> clutter_;
};

/// @param disturbance its lost_share: the disturbance of images that were rendered.
void loseSegments(const Disturbance& disturbance, RandomEngine& engine, std::vector<ImageSegment>& image);

}  // namespace vismem
