#include "experiments/app/trial_run.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <utility>

#include "common/config/project_file.h"
#include "common/geometry/angles.h"
#include "common/kinematics/random_stream.h"
#include "common/routes/route_follower.h"
#include "evaluation/app/cpu_stages.h"
#include "experiments/trials/trial_score.h"
#include "localization/core/gaze/gaze_planner.h"
#include "localization/core/localizer.h"

namespace vismem {
namespace {

/// Least displacement or turn of a kidnapping.
constexpr double kLeastMove_m = 2.0;
constexpr double kLeastTurn_rad = 0.5 * std::numbers::pi;
constexpr int kTries = 1000;

EvaluationOptions evaluationOptions(const TrialOptions& options) {
  return inProjectWorld(options.world, options.setup, options.seed, options.camera_rate_hz);
}

/// The estimate of a localization that knows the true place while another race leads. The planner then
/// requests views that distinguish the true place from the estimated ones, until the winner is right.
PoseEstimate withTruth(PoseEstimate estimate, const Pose2& truth) {
  constexpr double kTrueShare = 0.9;
  std::vector<RaceReport> races;
  double rivals = 0.0;
  for (const RaceReport& race : estimate.races) {
    const bool is_true = isRight(race.T_world_robot, truth);
    if (is_true && race.winner) {
      // Unambiguous at once.
      estimate.races = {race};
      estimate.races.front().weight = estimate.races.front().health = estimate.support = 1.0;
      return estimate;
    }
    if (is_true) continue;
    races.push_back(race);
    // The leading race counts as a full rival, whatever it explains now.
    if (race.winner) races.back().weight = std::max(0.5, race.weight);
    if (race.winner) races.back().health = 1.0;
    rivals += races.back().weight;
  }
  for (RaceReport& race : races) race.weight *= (1.0 - kTrueShare) / std::max(rivals, 1e-9);
  RaceReport here;
  here.T_world_robot = truth;
  here.health = 1.0;
  here.weight = kTrueShare;
  races.push_back(here);
  estimate.races = std::move(races);
  return estimate;
}

}  // namespace

/// The robot's own localization, which requests gaze.
struct GazeRequester {
  GazeRequester(const EvaluationParams& params, std::uint64_t seed)
      : localizer(params.localizer, params.map_edges, seed),
        planner(params.gaze, params.localizer.robust.likelihood, params.localizer.map, params.map_edges) {}

  /// @param oracle the true pose at the update's stamp for the oracle policy; else empty.
  void request(const MemoryUpdate& update, const std::optional<Pose2>& oracle, GazeClient& client,
               Trial& trial) {
    PoseEstimate estimate = localizer.update(update);
    if (oracle) estimate = withTruth(std::move(estimate), *oracle);
    const double before_s = CpuStages::now_s();
    const GazePlan plan = planner.plan(estimate, update);
    trial.gaze_plan_ms.push_back(1e3 * (CpuStages::now_s() - before_s));
    trial.gaze_requests += plan.request.has_value();
    if (carryOut(plan, client) > 0) throw std::logic_error("the gaze rejected a request of localization");
  }

  Localizer localizer;
  GazePlanner planner;
};

struct TrialRun::Impl {
  explicit Impl(const TrialOptions& given)
      : options(given),
        params(loadParams(evaluationOptions(given), true)),
        route(loadRoute(projectFile("cfg/worlds/" + given.world + ".route"))),
        memory(params.pipeline, params.palette),
        assembler(params.assembler),
        clutter(given.disturbance, params.map_edges),
        // The streams' names seed their numbers: renaming one changes every published result.
        places(subStream(given.seed, "places")),
        losses(subStream(given.seed, "losses")) {
    SimulationConfig robot = simulationConfig(evaluationOptions(options));
    if (options.change_robot) options.change_robot(robot);
    const RouteStart start = startOnRoute(route, places());
    robot.start = start.T_world_robot;
    simulation = std::make_unique<Simulation>(std::move(robot));
    follow(start);
  }

  void follow(const RouteStart& start) {
    driver.emplace(start.backwards ? reversed(route) : route, RouteFollowerParams{});
  }

  /// Moves the robot elsewhere on the route.
  void kidnap(Trial& trial) {
    const Pose2 here = simulation->truth().T_world_robot;
    for (int i = 0; i < kTries; ++i) {
      const RouteStart place = startOnRoute(route, places());
      const bool far = (place.T_world_robot.position() - here.position()).norm() >= kLeastMove_m ||
                       std::abs(angleDifference(place.T_world_robot.theta, here.theta)) >= kLeastTurn_rad;
      if (!far || !simulation->kidnap(place.T_world_robot).ok()) continue;
      follow(place);
      // The truth of this stamp belongs to the event before.
      trial.events_us.push_back(simulation->now() + 1);
      append(trial.truth, {simulation->now() + 1, simulation->truth().T_world_robot});
      return;
    }
    throw std::runtime_error("world \"" + options.world + "\": no other free place on its route");
  }

  bool isDark(StampUs stamp_us, const Trial& trial) const {
    if (!(options.blackout_s > 0.0)) return false;
    const double since_s = toSeconds(stamp_us - trial.events_us.back());
    return since_s >= options.blackout_from_s && since_s < options.blackout_from_s + options.blackout_s;
  }

  /// Updates the memory with one image.
  Step process(const RobotObservation& observation, const Trial& trial) {
    const auto exposed = exposures.find(observation.frame.seq);
    if (exposed == exposures.end()) throw std::logic_error("a frame without its exposure");
    const Pose3 T_world_camera = exposed->second;
    exposures.erase(exposures.begin(), std::next(exposed));
    AttentiveVisualMemory& attentive = memory.memory();
    if (!attentive.wants(observation)) return attentive.predict(observation);
    std::vector<ImageSegment> observed;
    if (!isDark(observation.frame.stamp_us, trial)) {
      observed = memory.extractor().extract(observation.frame.image, observation.frame.intrinsics, nullptr);
      clutter.add(toSeconds(observation.frame.stamp_us), observation.frame.intrinsics, T_world_camera, losses,
                  observed);
      loseSegments(options.disturbance, losses, observed);
    }
    return attentive.update(observation, observed);
  }

  /// With the true camera pose of its exposure.
  std::optional<Frame> takeFrame() {
    auto frame = simulation->takeFrame();
    if (frame) exposures[frame->seq] = simulation->lastExposure()->T_world_camera;
    return frame;
  }

  Trial record(const Visitor& visit) {
    constexpr std::chrono::milliseconds kNoWait{0};
    Trial trial;
    trial.seed = options.seed;
    trial.events_us.push_back(0);
    append(trial.truth, {0, simulation->truth().T_world_robot});
    std::optional<GazeRequester> requester;
    if (options.gaze != TrialGaze::kSalience) requester.emplace(params, options.seed);
    StampUs newest_pan_tilt_us = -1;
    StampUs newest_odometry_us = -1;
    const StampUs end_us = toStampUs(options.events * options.event_s);
    while (simulation->now() < end_us) {
      const auto drive = driver->drive(simulation->truth().T_world_robot);
      simulation->base().setVelocity(drive.v_mps, drive.w_radps);
      simulation->advanceToNextFrame();
      append(trial.truth, {simulation->now(), simulation->truth().T_world_robot});
      for (const auto& sample : simulation->panTilt().samplesSince(newest_pan_tilt_us, kNoWait).samples) {
        newest_pan_tilt_us = sample.stamp_us;
        assembler.add(sample);
      }
      for (const auto& sample : simulation->base().samplesSince(newest_odometry_us, kNoWait).samples) {
        newest_odometry_us = sample.stamp_us;
        assembler.add(sample);
      }
      if (auto frame = takeFrame()) assembler.add(std::move(*frame));
      while (const auto observation = assembler.take(/*every_frame=*/true)) {
        const Step step = process(*observation, trial);
        if (step.command) simulation->panTilt().command(*step.command);
        if (trial.updates.empty() || trial.updates.back().snapshot != step.update.snapshot) {
          trial.updates.push_back(step.update);
          if (requester) {
            const StampUs stamp_us = step.update.analysis->stamp_us;
            const auto oracle =
                options.gaze == TrialGaze::kOracle ? poseAt(trial.truth, stamp_us) : std::nullopt;
            requester->request(step.update, oracle, memory.memory().gazeClient(), trial);
            if (const auto command = memory.memory().preempt()) simulation->panTilt().command(*command);
          }
        }
        if (visit) visit(step, memory.memory().gazeClient());
      }
      const auto due = static_cast<int>(toSeconds(simulation->now()) / options.event_s);
      if (due >= static_cast<int>(trial.events_us.size()) && simulation->now() < end_us) kidnap(trial);
    }
    return trial;
  }

  TrialOptions options;
  EvaluationParams params;
  Route route;
  MemoryPipeline memory;
  ObservationAssembler assembler;
  Clutter clutter;
  RandomEngine places;
  RandomEngine losses;
  std::unique_ptr<Simulation> simulation;
  std::optional<SimulatedOperator> driver;
  std::map<std::uint64_t, Pose3> exposures;  ///< true poses of the camera by the frame's number
};

TrialRun::TrialRun(const TrialOptions& options) : impl_(std::make_unique<Impl>(options)) {}
TrialRun::~TrialRun() = default;

const EvaluationParams& TrialRun::params() const {
  return impl_->params;
}
Simulation& TrialRun::simulation() {
  return *impl_->simulation;
}
Trial TrialRun::record(const Visitor& visit) {
  return impl_->record(visit);
}

}  // namespace vismem
