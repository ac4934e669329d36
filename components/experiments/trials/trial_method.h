/// @file The interface of a localization method in trials, with ours and Monte Carlo localization. Pure. See
/// E5, E6.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "common/segment_map/segment_map.h"
#include "common/visual_memory/memory_snapshot.h"
#include "experiments/trials/monte_carlo.h"
#include "localization/core/localizer.h"

namespace vismem {

/// *Single-threaded*.
class TrialMethod {
 public:
  virtual ~TrialMethod() = default;
  virtual PoseEstimate step(const MemoryUpdate& update) = 0;
  /// Sets the robot's pose at the stamp of the last update.
  virtual void setPose(const Pose2& T_world_robot) = 0;
};

/// Makes a new method for each run, on a map with stripes expanded.
struct MethodMaker {
  std::string name;  ///< "default", "chapter", "mcl_stock" ...
  std::function<std::unique_ptr<TrialMethod>(const SegmentMap& map_edges, std::uint64_t seed)> make;
};

MethodMaker localizerMethod(std::string name, const LocalizerParams& params);
MethodMaker monteCarloMethod(std::string name, const MonteCarloParams& params);

/// The default mode without one of its parts.
struct Ablation {
  std::string name;
  LocalizerParams params;
};
/// @param base the default mode's parameters.
std::vector<Ablation> ablations(const LocalizerParams& base);

}  // namespace vismem
