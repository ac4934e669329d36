/// @file Likelihood of a place with bounded influence of every point, its refinement, and its curvature.
/// Pure. SPEC L12, B2; DESIGN 9 parts 1-3.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <optional>
#include <span>

#include "localization/core/map_index.h"
#include "localization/core/params.h"
#include "localization/core/race.h"
#include "localization/core/robust_observation.h"

namespace vismem {

/// How the map must be indexed for this mode's likelihood.
MapIndex::Params robustIndex(const LocalizerParams& params);

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
  double news = 0.0;  ///< the same of the points by their share of news, scaled up to all
  /// Weighted share of points that agree with the map, 0..1: each by exp(-d^2 / 2 sigma^2), with a sigma of
  /// at least `explained_sigma_m`.
  double explained = 0.0;
};

/// Rates places by one observation. *Pure*; keeps references to its arguments.
class RobustLikelihood {
 public:
  RobustLikelihood(const MapIndex& map, const RobustParams& params)
      : map_(map), params_(params), log_outlier_share_(std::log(params.outlier_share)) {}

  /// @param blur widens every sigma (as root sum of squares) [m]: a coarse search must not fall between
  /// narrow peaks.
  Rating rate(const RobustObservation& observation, const Placement& placement, double blur_m = 0.0) const;

  /// Rating::explained alone, as the health of many places, for a search that drops those under `least`: one
  /// of which every fourth point says less than half of that is not looked at further, and counts 0.
  void explain(const RobustObservation& observation, std::span<Individual> places, double blur_m,
               double least) const;

  struct Refined {
    Placement placement;
    /// Curvature of -log L (without the prior) at the result in (x, y, theta, lasting lean), with the lean of
    /// this one image marginalised.
    Matrix5d information = Matrix5d::Zero();
    Matrix5d image_information = Matrix5d::Zero();  ///< the same of the image's points alone
    Rating rating;                                  ///< there
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
  double explainedVariance(const EvidencePoint& point, double blur_m) const;
  /// @param distance_m to the map; the truncation's or more: too far to explain anything.
  void add(Rating& rating, const EvidencePoint& point, double distance_m, double blur_m) const;
  /// Squared distances to the map; the truncation's or more where it is too far to explain anything.
  void askSquares(std::span<const SegmentGrid::Question> questions, std::span<double> squares) const;
  /// The same with the way to what is nearest; empty where it is too far.
  void askSamples(std::span<const SegmentGrid::Question> questions,
                  std::span<std::optional<FieldSample>> samples) const;

  const MapIndex& map_;
  const RobustParams& params_;
  double log_outlier_share_;
};

}  // namespace vismem
