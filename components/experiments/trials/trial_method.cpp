#include "experiments/trials/trial_method.h"

#include <utility>

namespace vismem {
namespace {

/// Localizer or MonteCarlo as a method.
template <typename Localization>
class MethodOf : public TrialMethod {
 public:
  explicit MethodOf(Localization localization) : localization_(std::move(localization)) {}
  PoseEstimate step(const MemoryUpdate& update) override { return localization_.update(update); }
  void setPose(const Pose2& T_world_robot) override { localization_.setPose(T_world_robot); }

 private:
  Localization localization_;
};

template <typename Localization, typename Params>
MethodMaker makerOf(std::string name, const Params& params) {
  return {std::move(name), [params](const SegmentMap& map_edges, std::uint64_t seed) {
            return std::make_unique<MethodOf<Localization>>(Localization(params, map_edges, seed));
          }};
}

}  // namespace

MethodMaker localizerMethod(std::string name, const LocalizerParams& params) {
  return makerOf<Localizer>(std::move(name), params);
}

MethodMaker monteCarloMethod(std::string name, const MonteCarloParams& params) {
  return makerOf<MonteCarlo>(std::move(name), params);
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
