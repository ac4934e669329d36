/// @file The peer to measure against: augmented Monte Carlo localization with KLD sampling, as in the
/// textbook (Thrun, Burgard, Fox: Probabilistic Robotics, 5.4, 6.4, 8.3), on the same observations, map and
/// distance fields as ours. Pure. SPEC E5, E6.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/visual_memory/memory_snapshot.h"
#include "localization/core/map_index.h"
#include "localization/core/params.h"
#include "localization/core/pose_estimate.h"
#include "localization/core/random_engine.h"

namespace vismem {

struct MonteCarloParams {
  int least_particles = 500;
  int most_particles = 2000;
  double kld_error = 0.05;
  double kld_quantile = 2.326;  ///< of a standard normal: 99 %
  double bin_m = 0.5;           ///< of the histogram that KLD counts in, and clusters are made of
  double bin_rad = 10.0 * std::numbers::pi / 180.0;
  /// alpha1..alpha4: turn by turn, turn by travel, travel by travel, travel by turn, as factors of variances.
  std::array<double, 4> motion{0.2, 0.2, 0.2, 0.2};
  double alpha_slow = 0.001;
  double alpha_fast = 0.1;
  /// Nav2 forgets its averages whenever it has injected random particles; the textbook does not.
  bool restart_averages = true;
  /// Weights are updated when the robot has moved this far; 0: every time it is asked.
  double gate_m = 0.25;
  double gate_rad = 0.2;
  double sigma_m = 0.2;  ///< of the likelihood field
  double hit = 0.5;      ///< share of points that lie on the map; the rest may be anywhere
  int points = 60;       ///< of an observation that are used, drawn evenly by what they are worth
  /// > 0: weight = exp(this times the sum of the points' log likelihoods). 0: Nav2's 1 + sum of the cubes.
  double log_likelihood_share = 0.0;
  double tick_s = 0.2;  ///< of stamps between updates
};

/// Nav2's defaults, with the recovery that its documentation suggests (its own default is off).
MonteCarloParams stockMonteCarlo();
/// The better of what was tried on other seeds.
MonteCarloParams tunedMonteCarlo();

/// How many particles make the Kullback-Leibler distance between the true distribution and that of the
/// particles stay below `error`, with the certainty of the quantile, when `bins` bins are occupied. 1 for
/// less than two bins. (Fox 2003, equation 7.)
double kldParticleCount(int bins, double error, double quantile);

/// *Single-threaded*. The same updates with the same seed give the same estimates.
class MonteCarlo {
 public:
  MonteCarlo(const MonteCarloParams& params, const SegmentMap& map_edges, std::uint64_t seed);

  PoseEstimate step(const MemoryUpdate& update);
  /// All particles around a known place.
  void setPose(const Pose2& T_world_robot);

  std::size_t particleCount() const { return particles_.size(); }

 private:
  struct Particle {
    Pose2 T_world_robot;
    double weight = 0.0;
  };
  struct Point {
    Eigen::Vector2d p_robot;
    double direction_robot;
    int label;
  };

  Pose2 anywhere();
  void move(const Pose2& T_before_now);
  /// @return whether there was something to weigh by.
  bool weigh(const MemoryUpdate& update);
  void resample();
  void estimate();

  MonteCarloParams params_;
  RobustParams observation_params_;  ///< of what is observed, not of how it is rated
  MapIndex map_;
  RandomEngine engine_;
  std::vector<Particle> particles_;
  double slow_ = 0.0;
  double fast_ = 0.0;
  PoseEstimate estimate_;
  bool has_last_ = false;
  StampUs last_stamp_us_ = 0;
  StampUs last_tick_us_ = 0;
  Pose2 last_T_odom_robot_;
  Pose2 weighed_T_odom_robot_;
  bool weighed_once_ = false;
};

}  // namespace vismem
