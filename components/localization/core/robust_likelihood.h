/// @file Likelihood of a place with bounded influence of every point, its refinement, and its curvature.
/// Pure. SPEC L12, B2; DESIGN 9 parts 1-3.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "common/visual_memory/memory_snapshot.h"
#include "localization/core/map_index.h"
#include "localization/core/params.h"
#include "localization/core/race.h"

namespace vismem {

/// How the map must be indexed for this mode's likelihood.
MapIndex::Params robustIndex(const LocalizerParams& params);

/// A point on a remembered segment, in the robot's frame at the observation's stamp.
struct EvidencePoint {
  Eigen::Vector2d p_robot = Eigen::Vector2d::Zero();  ///< [m]
  double direction_robot = 0.0;                       ///< of its segment [rad]
  int label = 0;
  double sigma_m = 0.0;  ///< across the segment
  double weight = 0.0;   ///< independent points it stands for
  double news = 1.0;     ///< share of it that was not told by images before (ObservationNews)
  /// How a lean of the camera moves the point [m/rad] (see Race::camera_lean); zero for remembered points.
  Eigen::Matrix2d d_lean = Eigen::Matrix2d::Zero();
};

/// A remembered segment that can be matched with segments of the map.
struct EvidenceSegment {
  Segment2 robot;
  int label = 0;
  double weight = 0.0;
};

struct RobustObservation {
  std::vector<EvidencePoint> points;      ///< those of the memory first
  std::size_t remembered = 0;             ///< how many they are
  std::vector<EvidenceSegment> segments;  ///< of the memory and of the image
  /// Corners of remembered parallelograms in the robot's frame, counter-clockwise.
  std::vector<std::array<Eigen::Vector2d, 4>> parallelograms;
  double segment_weight = 0.0;  ///< sum over the segments
  double amount = 0.0;          ///< sum of the points' weights before the cap of `effective_points`
  double news = 1.0;            ///< mean of the points', by weight
  double memory_pull = 1.0;     ///< share of the remembered points' pull that moves a place
};

/// What the memory says, as weighted points (see RobustParams). Labels that the map does not have are left
/// out; segments without extent in plan view too.
RobustObservation observeMemory(const MemorySnapshot& snapshot, const MapIndex& map,
                                const RobustParams& params);

/// What one image says: points on its labelled segments that fall on the floor within `image_range_m`.
RobustObservation observeImage(const ImageAnalysis& analysis, const MapIndex& map,
                               const RobustParams& params);

/// Memory, image or both, as `source` says; both must be of one stamp.
RobustObservation observe(const MemoryUpdate& update, const MapIndex& map, const RobustParams& params);

/// Every n-th point, so that few more than `points` remain, with the weight of all.
RobustObservation thinned(const RobustObservation& observation, std::size_t points);

/// Where the robot and its camera may be when an image was taken.
struct Placement {
  Pose2 T_world_robot;
  Eigen::Vector2d lean_bias =
      Eigen::Vector2d::Zero();  ///< lasting lean of the camera (Race::camera_lean) [rad]
  Eigen::Vector2d lean_sway = Eigen::Vector2d::Zero();  ///< and of this image alone [rad]

  Eigen::Vector2d lean() const { return lean_bias + lean_sway; }
};

struct Rating {
  /// Sum of weight * log((1 - eps) exp(-d^2 / 2 sigma^2) + eps), <= 0; without bounds of weight * -d^2 / 2
  /// sigma^2, d at most the fields' reach.
  double log_likelihood = 0.0;
  double news = 0.0;       ///< the same of the points by their share of news, scaled up to all
  double explained = 0.0;  ///< weighted share of points that agree with the map, 0..1
};

/// Rates places by one observation. *Pure*; keeps references to its arguments.
class RobustLikelihood {
 public:
  RobustLikelihood(const MapIndex& map, const RobustParams& params)
      : map_(map), params_(params), log_outlier_share_(std::log(params.outlier_share)) {}

  /// @param blur widens every sigma (as root sum of squares) [m]: a coarse search must not fall between
  /// narrow peaks.
  Rating rate(const RobustObservation& observation, const Placement& placement, double blur_m = 0.0) const;

  /// Rating::explained alone, for a search that drops places under `least`: one of which every fourth point
  /// says less than half of that is not looked at further, and counts 0.
  double explained(const RobustObservation& observation, const Pose2& T_world_robot, double blur_m,
                   double least) const;

  struct Refined {
    Placement placement;
    /// Curvature of -log L (without the prior) at the result in (x, y, theta, lasting lean), with the lean of
    /// this one image marginalised.
    Matrix5d information = Matrix5d::Zero();
    Rating rating;  ///< there
  };

  /// Gauss-Newton steps on -share * log L + the prior's squared distance.
  /// @param prior_information about the start; zero for none. @param share scales the observation.
  Refined refine(const RobustObservation& observation, const Placement& start,
                 const Matrix5d& prior_information, double share, int steps, double blur_m) const;

 private:
  struct Curvature;
  Curvature curvature(std::span<const EvidencePoint> points, const Placement& placement, double share,
                      double blur_m, Rating* rating) const;
  void soften(Curvature& memory) const;
  void add(Rating& rating, const EvidencePoint& point, const std::optional<FieldSample>& field,
           double blur_m) const;
  /// Squared distance to the map; the truncation's or more where it is too far to explain anything.
  double squareAt(const EvidencePoint& point, const Eigen::Vector2d& p_world, double heading) const;
  void fetch(const RobustObservation& observation, const Placement& placement) const;
  std::optional<FieldSample> sample(const EvidencePoint& point, const Eigen::Vector2d& p_world,
                                    double heading) const;

  const MapIndex& map_;
  const RobustParams& params_;
  double log_outlier_share_;
};

}  // namespace vismem
