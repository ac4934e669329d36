#include "experiments/trials/trial_method.h"

#include <utility>

namespace vismem {
namespace {

class LocalizerMethod : public TrialMethod {
 public:
  LocalizerMethod(const LocalizerParams& params, const SegmentMap& map_edges, std::uint64_t seed)
      : localizer_(params, map_edges, seed) {}
  PoseEstimate step(const MemoryUpdate& update) override { return localizer_.update(update); }
  void setPose(const Pose2& T_world_robot) override { localizer_.setPose(T_world_robot); }

 private:
  Localizer localizer_;
};

class MonteCarloMethod : public TrialMethod {
 public:
  MonteCarloMethod(const MonteCarloParams& params, const SegmentMap& map_edges, std::uint64_t seed)
      : monte_carlo_(params, map_edges, seed) {}
  PoseEstimate step(const MemoryUpdate& update) override { return monte_carlo_.step(update); }
  void setPose(const Pose2& T_world_robot) override { monte_carlo_.setPose(T_world_robot); }

 private:
  MonteCarlo monte_carlo_;
};

}  // namespace

MethodMaker localizerMethod(std::string name, const LocalizerParams& params) {
  return {std::move(name), [params](const SegmentMap& map_edges, std::uint64_t seed) {
            return std::make_unique<LocalizerMethod>(params, map_edges, seed);
          }};
}

MethodMaker monteCarloMethod(std::string name, const MonteCarloParams& params) {
  return {std::move(name), [params](const SegmentMap& map_edges, std::uint64_t seed) {
            return std::make_unique<MonteCarloMethod>(params, map_edges, seed);
          }};
}

std::vector<Ablation> ablations(const LocalizerParams& base) {
  std::vector<Ablation> all;
  const auto without = [&](const char* name, const std::function<void(LocalizerParams&)>& change) {
    all.push_back({name, base});
    change(all.back().params);
  };
  without("no_direction_gate", [](auto& p) { p.robust.likelihood.direction_gate = false; });
  without("no_bound", [](auto& p) { p.robust.likelihood.bounded = false; });
  without("no_ends", [](auto& p) { p.robust.observation.end_metres = 0.0; });
  without("no_odometry_calibration", [](auto& p) { p.robust.filter.odometry_bias.setZero(); });
  without("no_score_history", [](auto& p) { p.robust.history.forgetting = 0.0; });
  without("no_hysteresis", [](auto& p) { p.robust.evidence.lead = 0.0; });
  without("no_constructed", [](auto& p) { p.robust.explorers.constructed_share = 0.0; });
  without("no_age_weight", [](auto& p) { p.robust.observation.half_life_s = 0.0; });
  without("no_camera_tilt",
          [](auto& p) { p.robust.likelihood.tilt_bias_rad = p.robust.likelihood.frame_tilt_rad = 0.0; });
  without("image_only", [](auto& p) { p.robust.observation.source = ObservationSource::kImage; });
  without("memory_only", [](auto& p) { p.robust.observation.source = ObservationSource::kMemory; });
  return all;
}

}  // namespace vismem
