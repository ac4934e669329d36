/// @file Races of the default mode: bounded likelihood, an extended Kalman filter per race, and evidence.
/// Pure. Implements B2. See L12.
#pragma once

#include <Eigen/Core>
#include <memory>

#include "common/config/parameter_visitor.h"
#include "common/geometry/angles.h"
#include "common/segment_map/segment_map.h"
#include "localization/core/hypotheses/explorers.h"
#include "localization/core/hypotheses/race_strategy.h"
#include "localization/core/hypotheses/score_history.h"
#include "localization/core/likelihood/odometry_noise.h"
#include "localization/core/likelihood/robust_likelihood.h"
#include "localization/core/map/map_index.h"
#include "localization/core/observation/floor_observation.h"

namespace vismem {

/// The filter of each race: motion noise and measurement update.
struct RaceFilterParams {
  OdometryNoise odometry;
  /// Prior standard deviations of the lasting errors of odometry, states of each race: yaw bias [rad/m], yaw
  /// scale error, distance scale error; 0: none.
  Eigen::Vector3d odometry_bias{0.05, 0.03, 0.1};
  double walk_m = 0.004;           ///< random walk of the position per square root of an iteration
  double walk_rad = 0.01;          ///< the same of the heading
  double information_share = 1.0;  ///< share of an observation that is new since the last iteration

  void visit(ParameterVisitor& v);
};

/// Comparison of the races.
struct EvidenceParams {
  /// Evidence is a mean over about 1 / (1 - forgetting) observations, of which this share is independent.
  /// Shares of belief multiply it by independent_share / (1 - forgetting), at least 1.
  double independent_share = 0.15;
  /// Lead in evidence [nats] that a new race needs to win; an old race needs a third. Races that are less
  /// behind the best are not pruned.
  double lead = 1.5;
};

/// L6 in the default mode.
struct RobustExplorerParams {
  double constructed_share = 0.5;  ///< share of explorers placed by matching observed segments to the map
  /// Uniform explorers are reduced in proportion in a map larger than this. An explorer finds a place from
  /// about 0.3 m and 15 degrees; 250 per iteration cover this area in half a minute. 0: never reduced.
  double uniform_area_m2 = 1000.0;
  int refined_explorers = 24;  ///< best explorers that are refined before candidates are chosen
};

struct RobustParams {
  ObservationParams observation;
  LikelihoodParams likelihood;
  ScoreHistoryParams history;
  RaceFilterParams filter;
  EvidenceParams evidence;
  RobustExplorerParams explorers;

  void visit(ParameterVisitor& v);
};

/// @param explorers both modes' parameters of the search.
std::unique_ptr<RaceStrategy> makeRobustRaces(const SegmentMap& map_edges, const MapParams& map,
                                              const ExplorerParams& explorers, const RobustParams& params);

}  // namespace vismem
