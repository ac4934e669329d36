#include "evaluation/app/evaluation.h"

#include <algorithm>
#include <chrono>
#include <iostream>
#include <nlohmann/json.hpp>
#include <utility>

#include "common/config/config_error.h"
#include "common/config/text_file.h"
#include "common/recording/bag_advice.h"
#include "common/routes/route.h"
#include "common/tool/progress_line.h"
#include "evaluation/app/cpu_stages.h"
#include "evaluation/app/evaluation_record.h"
#include "evaluation/app/evaluation_setup.h"
#include "evaluation/app/mirrored_robot.h"
#include "evaluation/app/perturbed_robot.h"
#include "evaluation/app/recorded_robot.h"
#include "evaluation/app/recorded_survey.h"
#include "evaluation/app/still_scene.h"
#include "evaluation/core/lockstep.h"
#include "evaluation/core/memory_score.h"
#include "evaluation/core/moving_edges.h"
#include "evaluation/core/truth_file.h"
#include "replay_server/core/stepped_log.h"

namespace vismem {
namespace {

namespace fs = std::filesystem;

std::optional<StampUs> duration(const EvaluationOptions& options) {
  if (!options.seconds) return std::nullopt;
  return toStampUs(*options.seconds);
}

/// How much of the robot's time is evaluated.
class DriveProgress {
 public:
  DriveProgress(StampUs first_us, StampUs all_us) : first_us_(first_us), all_us_(all_us) {}
  void show(const LockstepFrame& frame) {
    const StampUs done_us = frame.observation.frame.stamp_us - first_us_;
    line_.show(seconds(std::clamp<StampUs>(done_us, 0, all_us_)), seconds(all_us_));
  }

 private:
  static std::size_t seconds(StampUs time_us) { return static_cast<std::size_t>(time_us / kSecondUs); }

  StampUs first_us_;
  StampUs all_us_;
  ProgressLine line_{"seconds of the drive"};
};

/// Sets the known start pose once, after the first frame.
class KnownStart {
 public:
  KnownStart(Localizer& localizer, std::optional<Pose2> start)
      : localizer_(localizer), start_(std::move(start)) {}
  void afterFrame() {
    if (start_) localizer_.setPose(*std::exchange(start_, std::nullopt));
  }

 private:
  Localizer& localizer_;
  std::optional<Pose2> start_;
};

/// Gives a record the true poses of the images' time, and one on either side of it to interpolate with.
class TruthFeed {
 public:
  TruthFeed(EvaluationRecord& record, Trajectory truth) : record_(record), truth_(std::move(truth)) {}

  void upTo(StampUs stamp_us) {
    const auto isBefore = [stamp_us](const StampedPose& pose) { return pose.stamp_us < stamp_us; };
    if (next_ == 0) {
      while (next_ + 1 < truth_.size() && isBefore(truth_[next_ + 1])) ++next_;
    }
    while (next_ < truth_.size() && (next_ == 0 || isBefore(truth_[next_ - 1])))
      record_.addTruth(truth_[next_++]);
  }

 private:
  EvaluationRecord& record_;
  Trajectory truth_;
  std::size_t next_ = 0;
};

nlohmann::json evaluateBag(const EvaluationOptions& options) {
  RobotLogOptions log;
  if (const std::string wrong = applyTopics(options.topics, log); !wrong.empty()) {
    throw ConfigError({"--topics " + wrong});
  }
  // The log looks up the camera's pose at the late stamp, so it makes the stamps late itself.
  Perturbation perturbation = options.perturbation;
  log.late_s = std::exchange(perturbation.late_s, 0.0);
  SteppedLog robot(RobotLog::open(options.bag.string(), log));
  for (const std::string& note : robot.log().notes()) std::cerr << "note: " << note << "\n";
  const EvaluationParams params = loadParams(options, !robot.log().knowsCameraPose());
  Trajectory truth;
  if (!options.truth.empty()) {
    truth =
        parseTruth(readTextFile(options.truth, "true poses: t_s,x_m,y_m,theta_rad"), options.truth.string());
  } else {
    for (const TruePose& pose : robot.log().truth()) append(truth, {pose.stamp_us, pose.T_world_robot});
  }
  if (!options.survey.edges.empty() && truth.empty()) {
    throw ConfigError(
        {options.bag.string() + ": no true poses, which --survey needs (expected --truth FILE)"});
  }
  std::optional<RecordedSurvey> survey;
  if (!options.survey.edges.empty()) survey.emplace(options.survey, params.map_edges, truth);
  EvaluationRecord record(options, params);
  TruthFeed feed(record, truth);
  MemoryPipeline memory(params.pipeline, params.palette);
  Localizer localizer(params.localizer, params.map_edges, options.seed);
  KnownStart start(localizer, options.start);
  CalibratedRobot calibrated(robot, params.joints, params.wheels);
  PerturbedRobot perturbed(calibrated, perturbation);
  Lockstep run(perturbed, params.assembler, memory, &localizer);
  const std::vector<StampUs>& stamps = robot.log().frameStamps();
  const StampUs whole_us = stamps.empty() ? 0 : stamps.back() - stamps.front();
  DriveProgress progress(stamps.empty() ? 0 : stamps.front(),
                         std::min(whole_us, duration(options).value_or(whole_us)));
  std::shared_ptr<const MemorySnapshot> last_memory;
  run.run(
      [&](const LockstepFrame& frame) {
        start.afterFrame();
        feed.upTo(frame.observation.frame.stamp_us);
        const std::uint64_t image = frame.observation.frame.seq;
        progress.show(frame);
        record.add(frame, image >= options.judge_first && image <= options.judge_last);
        const ImageAnalysis* analysis = frame.memory.update.analysis.get();
        const bool is_new = analysis && analysis->stamp_us == frame.observation.frame.stamp_us;
        if (survey) survey->add(frame.observation, is_new ? analysis : nullptr);
        if (frame.memory.update.snapshot) last_memory = frame.memory.update.snapshot;
      },
      duration(options));
  nlohmann::json json = record.finish(run, memory, options.bag.string());
  if (survey) json["labels"] = survey->labels();
  if (survey && last_memory) json["memory"] = survey->score(*last_memory);
  return json;
}

std::optional<Route> findRoute(const EvaluationOptions& options) {
  fs::path file = options.route;
  if (file.empty()) {
    file = options.world;
    file.replace_extension(".route");
    if (!fs::exists(file)) return std::nullopt;
  }
  return loadRoute(file);
}

void addProfile(nlohmann::json& json, CpuStages& stages, double wall_s, double robot_s) {
  json["real_time_factor"] = robot_s / wall_s;
  const double frames = json.at("frames").get<double>();
  double sum_s = 0.0;
  for (const auto& [stage, seconds] : stages.seconds()) {
    json["cpu_ms_per_frame"][stage] = 1e3 * seconds / frames;
    sum_s += seconds;
  }
  json["cpu_ms_per_frame"]["all"] = 1e3 * sum_s / frames;
  json["real_time_factor_of_cpu"] = robot_s / sum_s;
}

/// A simulated robot, and its recording where the options want one.
class RecordedSimulation {
 public:
  RecordedSimulation(const EvaluationOptions& options, const std::optional<Route>& route,
                     const std::optional<Pose2>& start)
      : simulation_(makeSimulation(options, route, start)) {
    if (options.record.empty()) return;
    recorded_ = std::make_unique<RecordedRobot>(*simulation_, options.record);
    copyConfiguration(options);
  }

  Simulation& simulation() { return *simulation_; }
  SteppedRobot& robot() { return recorded_ ? static_cast<SteppedRobot&>(*recorded_) : *simulation_; }
  void recordTruth() {
    if (recorded_) recorded_->addTruth(simulation_->truth());
  }
  void finish() {
    if (recorded_) recorded_->finish();
  }

 private:
  std::unique_ptr<Simulation> simulation_;
  std::unique_ptr<RecordedRobot> recorded_;
};

/// Confirmed elements of the memory that show things that walk, in world.
nlohmann::json movingOf(const MovingEdges& edges, const MemorySnapshot& memory, const Pose2& T_world_robot) {
  nlohmann::json json{
      {"confirmed", std::count_if(memory.segments.begin(), memory.segments.end(),
                                  [](const MemorySegment& segment) { return segment.confirmed; })},
      {"longest_after_s", edges.longestAfter_s()},
      {"of_moving", nlohmann::json::array()}};
  int seen = 0;
  int ever = 0;
  for (const auto& [id, history] : edges.histories()) {
    seen += history.isOfMoving();
    ever += history.isOfMoving() && history.confirmed_us > 0;
  }
  json["seen_of_moving"] = seen;
  json["ever_of_moving"] = ever;
  MemorySnapshot theirs = memory;
  theirs.segments = edges.confirmedOf(memory);
  for (const RememberedEdge& edge : rememberedIn(theirs, T_world_robot)) {
    const ElementHistory& history = edges.histories().at(edge.id);
    json["of_moving"].push_back(
        {{"id", edge.id},
         {"label", edge.label},
         {"world_m", {edge.world.a.x(), edge.world.a.y(), edge.world.b.x(), edge.world.b.y()}},
         {"first_s", toSeconds(history.first_us)},
         {"last_s", toSeconds(history.last_us)},
         {"images_still", history.still},
         {"images_moving", history.moving}});
  }
  return json;
}

EvaluationOptions inSecondWorld(EvaluationOptions options) {
  options.world = options.second_world;
  options.record = options.second_record;
  return options;
}

nlohmann::json evaluateWorld(const EvaluationOptions& options) {
  const EvaluationParams params = loadParams(options, true);
  std::optional<Route> route = findRoute(options);
  std::optional<Pose2> place = options.start;
  if (route && !place) {
    const RouteStart drawn = startOnRoute(*route, options.seed);
    place = drawn.T_world_robot;
    if (drawn.backwards) route = reversed(*route);
  }
  RecordedSimulation world(options, route, place);
  std::optional<RecordedSimulation> second;
  std::optional<MirroredRobot> mirrored;
  if (!options.second_world.empty()) {
    second.emplace(inSecondWorld(options), route, place);
    mirrored.emplace(world.robot(), second->robot());
  }
  CalibratedRobot calibrated(mirrored ? static_cast<SteppedRobot&>(*mirrored) : world.robot(), params.joints,
                             params.wheels);
  PerturbedRobot stepped(calibrated, options.perturbation);
  EvaluationRecord record(options, params);
  MemoryPipeline memory(params.pipeline, params.palette);
  Localizer localizer(params.localizer, params.map_edges, options.seed);
  KnownStart start(localizer, options.start);
  Lockstep run(stepped, params.assembler, memory, &localizer);
  std::optional<StillScene> still;
  if (!options.scenario.empty()) still.emplace(world.simulation());
  std::shared_ptr<const MemorySnapshot> last_memory;
  CpuStages stages;
  if (options.profile) run.setProbe(&stages);
  const auto began = std::chrono::steady_clock::now();
  DriveProgress progress(world.simulation().now(), duration(options).value_or(0));
  run.run(
      [&](const LockstepFrame& frame) {
        progress.show(frame);
        start.afterFrame();
        const TruthSample truth = world.simulation().truth();
        record.addTruth({truth.stamp_us, truth.T_world_robot});
        world.recordTruth();
        if (second) second->recordTruth();
        record.add(frame, false);
        if (still) still->add(frame);
        if (frame.memory.update.snapshot) last_memory = frame.memory.update.snapshot;
      },
      duration(options));
  world.finish();
  if (second) second->finish();
  const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - began;
  nlohmann::json json = record.finish(run, memory, options.world.string());
  for (const auto& problem : world.simulation().takeScenarioProblems())
    json["scenario_problems"].push_back(problem);
  if (still && !still->edges().histories().empty())
    json["moving"] = movingOf(still->edges(), *last_memory, world.simulation().truth().T_world_robot);
  if (options.profile) addProfile(json, stages, spent.count(), toSeconds(world.simulation().now()));
  return json;
}

}  // namespace

nlohmann::json evaluate(const EvaluationOptions& options) {
  return options.bag.empty() ? evaluateWorld(options) : evaluateBag(options);
}

}  // namespace vismem
