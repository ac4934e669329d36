/// @file The peer of E5 and E6: augmented Monte Carlo localization with KLD sampling (Thrun, Burgard, Fox:
/// Probabilistic Robotics, 5.4, 6.4, 8.3; Fox 2003), on the same observations, map and distance fields as
/// ours. Pure. See E5, E6.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/visual_memory/memory_snapshot.h"
#include "localization/core/map/map_index.h"
#include "localization/core/observation/floor_observation.h"
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
  int points = 60;       ///< used of an observation, drawn evenly by weight
  /// > 0: weight = exp(this times the sum of the points' log likelihoods). 0: Nav2's 1 + sum of the cubes.
  double log_likelihood_share = 0.0;
  double tick_s = 0.2;  ///< of stamps between updates
};

/// Nav2's defaults, with the recovery that its documentation suggests (its own default is off).
MonteCarloParams stockMonteCarlo();
/// Tuned on seeds that no table uses.
MonteCarloParams tunedMonteCarlo();

/// Number of particles that keeps the Kullback-Leibler distance between the true distribution and that of the
/// particles below `error`, with the quantile's probability (Fox 2003, equation 7).
/// @param bins occupied bins; 1 particle for fewer than two.
double kldParticleCount(int bins, double error, double quantile);

/// *Single-threaded*. The same updates with the same seed give the same estimates.
class MonteCarlo {
 public:
  MonteCarlo(const MonteCarloParams& params, const SegmentMap& map_edges, std::uint64_t seed);

  const PoseEstimate& update(const MemoryUpdate& update);
  /// Puts all particles around a known pose.
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

  void move(const Pose2& T_before_now);
  /// @return whether there was an observation to weigh by.
  bool weigh(const MemoryUpdate& update);
  void resample();
  void estimate();

  MonteCarloParams params_;
  ObservationParams observation_params_;  ///< of the observation only
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
