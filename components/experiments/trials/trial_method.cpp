#include "experiments/trials/trial_method.h"

#include <utility>

namespace vismem {
namespace {

class LocalizerMethod : public TrialMethod {
 public:
  LocalizerMethod(const LocalizerParams& params, const SegmentMap& map_edges, std::uint64_t seed)
      : localizer_(params, map_edges, seed) {}
  PoseEstimate step(const MemoryUpdate& update, const Pose2& T_odom_robot_now) override {
    return localizer_.step(update, T_odom_robot_now);
  }
  void setPose(const Pose2& T_world_robot) override { localizer_.setPose(T_world_robot); }

 private:
  Localizer localizer_;
};

class MonteCarloMethod : public TrialMethod {
 public:
  MonteCarloMethod(const MonteCarloParams& params, const SegmentMap& map_edges, std::uint64_t seed)
      : monte_carlo_(params, map_edges, seed) {}
  PoseEstimate step(const MemoryUpdate& update, const Pose2&) override { return monte_carlo_.step(update); }
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
  without("no_direction_gate", [](auto& p) { p.robust.direction_gate = false; });
  without("no_bound", [](auto& p) { p.robust.bounded = false; });
  without("no_negative_information", [](auto& p) { p.robust.negative_information = false; });
  without("no_refinement", [](auto& p) { p.robust.refinement_steps = 0; });
  without("no_ends", [](auto& p) { p.robust.end_metres = 0.0; });
  without("no_kalman", [](auto& p) { p.robust.kalman = false; });
  without("no_learnt_odometry", [](auto& p) { p.odometry.enabled = false; });
  without("no_past_evidence", [](auto& p) { p.robust.forgetting = 0.0; });
  without("no_news", [](auto& p) { p.robust.repeats = 0.0; });
  without("no_hysteresis", [](auto& p) { p.robust.lead = 0.0; });
  without("no_validity", [](auto& p) { p.robust.validity = false; });
  without("no_constructed", [](auto& p) { p.robust.constructed_share = 0.0; });
  without("no_landmarks", [](auto& p) { p.robust.landmark_share = 0.0; });
  without("no_kld", [](auto& p) { p.robust.kld_error = 0.0; });
  without("no_age_weight", [](auto& p) { p.robust.half_life_s = 0.0; });
  without("no_lean", [](auto& p) { p.robust.lean_bias_rad = p.robust.lean_sway_rad = 0.0; });
  without("rated_on_arrival", [](auto& p) { p.robust.rate_at_image_stamp = false; });
  without("image_only", [](auto& p) { p.robust.source = HealthSource::kImage; });
  without("memory_only", [](auto& p) { p.robust.source = HealthSource::kMemory; });
  return all;
}

}  // namespace vismem
