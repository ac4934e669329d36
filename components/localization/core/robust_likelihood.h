/// @file Likelihood of a place with bounded influence of every point, its refinement, and its curvature.
/// Pure. SPEC L12, B2; DESIGN 9 parts 1-3.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/visual_memory/memory_snapshot.h"
#include "localization/core/map_index.h"
#include "localization/core/params.h"

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
};

/// A remembered segment that can be matched with segments of the map.
struct EvidenceSegment {
  Segment2 robot;
  int label = 0;
  double weight = 0.0;
};

struct RobustObservation {
  std::vector<EvidencePoint> points;
  std::vector<EvidenceSegment> segments;  ///< of the memory
  double segment_weight = 0.0;            ///< sum over the segments
  double amount = 0.0;                    ///< sum of the points' weights before the cap of `effective_points`
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

struct Rating {
  double log_likelihood = 0.0;  ///< sum of weight * log((1 - eps) exp(-d^2 / 2 sigma^2) + eps), <= 0
  double explained = 0.0;       ///< weighted share of points that agree with the map, 0..1
};

/// Rates places by one observation. *Pure*; keeps references to its arguments.
class RobustLikelihood {
 public:
  RobustLikelihood(const MapIndex& map, const RobustParams& params) : map_(map), params_(params) {}

  /// @param blur widens every sigma (as root sum of squares) [m]: a coarse search must not fall between
  /// narrow peaks. @param stride only every n-th point is used.
  Rating rate(const RobustObservation& observation, const Pose2& T_world_robot, double blur_m = 0.0,
              std::size_t stride = 1) const;

  struct Refined {
    Pose2 T_world_robot;
    /// Curvature of -log L (without the prior) at the result, in (x, y, theta).
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  };

  /// Gauss-Newton steps on -share * log L + the prior's squared distance.
  /// @param prior_information about the start pose; zero for none. @param share scales the observation.
  Refined refine(const RobustObservation& observation, const Pose2& start,
                 const Eigen::Matrix3d& prior_information, double share, int steps, double blur_m) const;

 private:
  std::optional<FieldSample> sample(const EvidencePoint& point, const Eigen::Vector2d& p_world,
                                    double heading) const;

  const MapIndex& map_;
  const RobustParams& params_;
};

}  // namespace vismem
