/// @file Floor observation: memory and image as weighted, labelled points on the floor. Pure. See L3, L12.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "common/config/parameter_visitor.h"
#include "common/visual_memory/memory_snapshot.h"
#include "localization/core/map/map_index.h"

namespace vismem {

/// What an observation is made of: the memory (L5), the analysed image (L4), or both.
enum class ObservationSource { kMemory, kImage, kBoth };

/// Weight per metre of a fresh, confirmed segment.
inline constexpr double kPointsPerMetre = 5.0;
/// Points per observation; more are thinned to every n-th.
inline constexpr std::size_t kMaximumPoints = 100;
/// Height of the highest edges that count, as a share of the camera's.
inline constexpr double kHighestOfCamera = 0.8;
/// Largest standard deviation of any point [m].
inline constexpr double kMaximumSigma_m = 0.25;

/// Points of the default mode's observation.
struct ObservationParams {
  ObservationSource source = ObservationSource::kBoth;
  /// Share of the effective points that the image has where both provide some: the memory contains the
  /// odometry error since its images.
  double image_share = 0.85;
  /// Below this many effective points of the image the memory is added, with a share that grows linearly as
  /// the image provides less.
  double memory_below_points = 6.0;
  double image_range_m = 4.0;       ///< largest range of floor points of the image
  double camera_sigma_rad = 0.003;  ///< standard deviation of the camera's direction, per floor point
  double range_m = 5.0;             ///< largest range of remembered points
  double half_life_s = 4.0;         ///< weight is halved per this time unseen; 0: never
  double effective_points = 30.0;   ///< upper bound of an observation's sum of weights
  /// Weight, in metres of segment, of an image segment's end that the image border does not cut. Ends fix the
  /// position along a wall. 0: ends are not used.
  double end_metres = 0.2;
  double sigma_m = 0.012;             ///< smallest standard deviation across the line, seen now
  double remembered_sigma_m = 0.033;  ///< the same of remembered points, including odometry error
  double drift_sigma_mps = 0.01;      ///< growth of the standard deviation with time unseen

  void visit(ParameterVisitor& v);
};

/// A point on an observed segment, in the robot's frame at the observation's stamp.
struct FloorPoint {
  Eigen::Vector2d p_robot = Eigen::Vector2d::Zero();  ///< [m]
  double direction_robot = 0.0;                       ///< direction of its segment [rad]
  int label = 0;
  double sigma_m = 0.0;  ///< standard deviation across the segment
  double weight = 0.0;   ///< number of independent points it stands for
  /// Derivative of p_robot by the camera tilt error [m/rad] (see Placement); zero for remembered points.
  Eigen::Matrix2d d_tilt = Eigen::Matrix2d::Zero();
  Eigen::Vector2d camera_robot = Eigen::Vector2d::Zero();  ///< foot point of the camera [m]
  double per_camera_height = 0.0;                          ///< [1/m]; zero for remembered points
  bool off_floor = false;  ///< the memory knows its segment to be off the floor

  /// Whether it may show something at a height: a ray of the image passes it clearly below the camera.
  bool mayLieAt(double height_m) const {
    return height_m == 0.0 ? !off_floor
                           : per_camera_height > 0.0 && height_m * per_camera_height <= kHighestOfCamera;
  }
  /// Share of the way from the camera to the floor at which its ray passes a height.
  double shareAt(double height_m) const { return 1.0 - height_m * per_camera_height; }
};

/// An observed segment that can be matched with segments of the map.
struct ObservedSegment {
  Segment2 robot;
  int label = 0;
  double weight = 0.0;
};

struct FloorObservation {
  std::vector<FloorPoint> points;         ///< remembered points first
  std::size_t remembered = 0;             ///< number of remembered points
  std::vector<ObservedSegment> segments;  ///< of the memory and of the image
  double segment_weight = 0.0;            ///< sum over the segments
  double amount = 0.0;                    ///< sum of the points' weights before the bound `effective_points`
  double memory_influence = 1.0;          ///< factor on the remembered points' gradient in refinement
};

/// The memory as weighted points. Labels without a map segment and segments without extent in plan view are
/// left out.
FloorObservation observeMemory(const MemorySnapshot& snapshot, const MapIndex& map,
                               const ObservationParams& params);

/// Intrinsics and pose of the camera for one image.
struct CameraModel {
  CameraIntrinsics intrinsics;
  Pose3 T_robot_camera = Pose3::Identity();
};

/// One image as weighted points: its labelled segments projected to the floor within `image_range_m`.
/// @param view corrected camera; null: the one of the analysis.
/// @param reused gives its memory to the result.
FloorObservation observeImage(const ImageAnalysis& analysis, const MapIndex& map,
                              const ObservationParams& params, const CameraModel* view = nullptr,
                              FloorObservation reused = {});

/// Memory, image or both, as configured.
/// @param update snapshot and analysis of one stamp.
/// @param view as of observeImage.
/// @param reused gives its memory to the result.
FloorObservation observe(const MemoryUpdate& update, const MapIndex& map, const ObservationParams& params,
                         const CameraModel* view = nullptr, FloorObservation reused = {});

/// Every n-th point with the weight of all, without segments; at most `points` (> 0) remain.
/// @param reused gives its memory to the result.
FloorObservation thinned(const FloorObservation& observation, std::size_t points,
                         FloorObservation reused = {});

/// Sum of the points' weights.
double weightOf(const FloorObservation& observation);

}  // namespace vismem
