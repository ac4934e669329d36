#include "evaluation/app/evaluation.h"

#include <chrono>
#include <nlohmann/json.hpp>
#include <sstream>
#include <utility>
#include <vector>

#include "common/config/config_error.h"
#include "common/geometry/angles.h"
#include "common/recording/bag_advice.h"
#include "common/routes/route.h"
#include "common/segment_map/symmetry.h"
#include "evaluation/app/cpu_stages.h"
#include "evaluation/app/evaluation_setup.h"
#include "evaluation/app/perturbed_robot.h"
#include "evaluation/app/recorded_robot.h"
#include "evaluation/core/lockstep.h"
#include "evaluation/core/map_projection.h"
#include "evaluation/core/metrics.h"
#include "evaluation/core/trajectory_io.h"
#include "replay_server/core/stepped_log.h"

namespace vismem {
namespace {

namespace fs = std::filesystem;

/// Everything that a run adds up to its files and its summary.
struct Record {
  std::vector<PublishedPose> published;
  std::vector<PoseEstimate> estimates;
  Trajectory estimate;  // world -> robot
  Trajectory odometry;
  Trajectory truth;
  std::vector<JudgedImage> judged;
  MemoryUpdate last;
  GazeStatus gaze;
  double run_s = 0.0;  // of computing

  void add(const LockstepFrame& frame, bool judge) {
    const RobotObservation& observation = frame.observation;
    const StampUs stamp_us = observation.frame.stamp_us;
    last = frame.memory.update;
    gaze = frame.memory.gaze;
    append(odometry, {stamp_us, observation.T_odom_robot});
    // The estimate holds at its own image's stamp; odometry predicts it to this image.
    std::optional<Pose2> pose;
    if (frame.estimate.T_world_robot) {
      pose = *frame.estimate.T_world_robot * inverse(frame.estimate.T_odom_robot) * observation.T_odom_robot;
      append(estimate, {stamp_us, *pose});
    }
    published.push_back({stamp_us, pose, frame.estimate.reliability});
    if (estimates.empty() || estimates.back().revision != frame.estimate.revision) {
      estimates.push_back(frame.estimate);
    }
    if (judge && last.analysis && last.analysis->stamp_us == stamp_us) {
      judged.push_back(
          {last.analysis->observed, last.analysis->intrinsics, observation.T_robot_camera, pose});
    }
  }
};

template <typename Write>
void writeWith(const fs::path& file, Write write) {
  std::ostringstream text;
  write(text);
  writeTextFile(file, text.str());
}

void writeFiles(const Record& record, const fs::path& out) {
  fs::create_directories(out);
  writeWith(out / "trajectory.tum", [&](std::ostream& text) { writeTum(record.estimate, text); });
  writeWith(out / "odometry.tum", [&](std::ostream& text) { writeTum(record.odometry, text); });
  if (!record.truth.empty()) {
    writeWith(out / "truth.tum", [&](std::ostream& text) { writeTum(record.truth, text); });
  }
  writeWith(out / "races.csv", [&](std::ostream& text) { writeRacesCsv(record.estimates, text); });
  writeWith(out / "primitives.csv",
            [&](std::ostream& text) { writePrimitivesCsv(*record.last.snapshot, text); });
  writeWith(out / "memory.csv", [&](std::ostream& text) { writeMemoryCsv(*record.last.snapshot, text); });
}

template <typename Value>
nlohmann::json orNull(const std::optional<Value>& value) {
  return value ? nlohmann::json(*value) : nlohmann::json();
}

nlohmann::json summarise(const Record& record, const Lockstep& run, const EvaluationOptions& options,
                         const EvaluationParams& params) {
  nlohmann::json json;
  json["mode"] = params.localizer.mode == LocalizationMode::kChapter ? "chapter" : "default";
  json["seed"] = options.seed;
  json["frames"] = run.framesProcessed();
  json["frames_dropped"] = run.framesDropped();
  json["memory_segments"] = record.last.snapshot->segments.size();
  json["gaze_visits"] = record.gaze.visits;
  json["races"] = record.estimates.back().races.size();
  json["reliability"] = record.estimates.back().reliability;
  const double robot_s = toSeconds(record.odometry.back().stamp_us - record.odometry.front().stamp_us);
  json["robot_s"] = robot_s;
  json["path_m"] = pathLength(record.odometry);
  const auto estimates = static_cast<double>(record.estimates.size());
  json["memory_hz"] = robot_s > 0.0 ? estimates / robot_s : 0.0;
  if (!record.truth.empty()) {
    ScoreParams judge;
    judge.symmetries = symmetriesOf(params.map_edges);
    const LocalizationScore score = scoreLocalization(record.published, record.truth, {}, judge);
    json["map_symmetries"] = judge.symmetries.size();
    json["is_twin"] = score.is_twin;
    json["settled_after_s"] = orNull(score.settled_after_s);
    json["position_error_m"] = orNull(score.position_error_m);
    json["heading_error_deg"] =
        score.heading_error_rad ? nlohmann::json(radToDeg(*score.heading_error_rad)) : nlohmann::json();
    json["recovered"] = score.recovered;
  }
  if (!record.judged.empty()) {
    const MapProjectionScore score = scoreMapProjection(record.judged, params.map_edges);
    json["map_projection_px"] = orNull(score.detected_to_map_px);
    json["map_to_detected_px"] = orNull(score.map_to_detected_px);
    json["images_judged"] = score.images;
    json["images_without_lines"] = score.images_without_lines;
    json["images_without_pose"] = score.images_without_pose;
  }
  return json;
}

std::optional<StampUs> duration(const EvaluationOptions& options) {
  if (!options.seconds) return std::nullopt;
  return toStampUs(*options.seconds);
}

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

nlohmann::json finish(Record& record, const Lockstep& run, const EvaluationOptions& options,
                      const EvaluationParams& params, const std::string& input) {
  if (!record.last.snapshot) {
    throw std::runtime_error(input + ": no frame could be used: odometry or camera poses cover none of them");
  }
  writeFiles(record, options.out);
  return summarise(record, run, options, params);
}

nlohmann::json evaluateBag(const EvaluationOptions& options) {
  RobotLogOptions log;
  if (const std::string wrong = applyTopics(options.topics, log); !wrong.empty()) {
    throw ConfigError({"--topics " + wrong});
  }
  SteppedLog robot(RobotLog::open(options.bag.string(), log));
  const EvaluationParams params = loadParams(options, !robot.log().knowsCameraPose());
  Record record;
  if (!options.truth.empty()) {
    record.truth = loadTruth(options.truth);
  } else {
    for (const TruePose& truth : robot.log().truth())
      append(record.truth, {truth.stamp_us, truth.T_world_robot});
  }
  MemoryPipeline memory(params.pipeline, params.palette);
  Localizer localizer(params.localizer, params.map_edges, options.seed);
  KnownStart start(localizer, options.start);
  PerturbedRobot perturbed(robot, options.perturbation);
  Lockstep run(perturbed, params.assembler, memory, localizer);
  run.run(
      [&](const LockstepFrame& frame) {
        start.afterFrame();
        const std::uint64_t image = frame.observation.frame.seq;
        record.add(frame, image >= options.judge_first && image <= options.judge_last);
      },
      duration(options));
  return finish(record, run, options, params, options.bag.string());
}

std::optional<Route> findRoute(const EvaluationOptions& options) {
  fs::path file = options.route;
  if (file.empty()) {
    file = options.world;
    file.replace_extension(".route");
    if (!fs::exists(file)) return std::nullopt;
  }
  return routeFromFile(file);
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

nlohmann::json evaluateWorld(const EvaluationOptions& options) {
  const EvaluationParams params = loadParams(options, true);
  std::optional<Route> route = findRoute(options);
  std::optional<Pose2> place = options.start;
  if (route && !place) {
    const RouteStart drawn = startOnRoute(*route, options.seed);
    place = drawn.T_world_robot;
    if (drawn.backwards) route = reversed(*route);
  }
  const auto robot = makeSimulation(options, route, place);
  std::unique_ptr<RecordedRobot> recorded;
  if (!options.record.empty()) {
    recorded = std::make_unique<RecordedRobot>(*robot, options.record);
    copyConfiguration(options);
  }
  PerturbedRobot stepped(recorded ? static_cast<SteppedRobot&>(*recorded) : *robot, options.perturbation);
  Record record;
  MemoryPipeline memory(params.pipeline, params.palette);
  Localizer localizer(params.localizer, params.map_edges, options.seed);
  KnownStart start(localizer, options.start);
  Lockstep run(stepped, params.assembler, memory, localizer);
  CpuStages stages;
  if (options.profile) run.setProbe(&stages);
  const auto began = std::chrono::steady_clock::now();
  run.run(
      [&](const LockstepFrame& frame) {
        start.afterFrame();
        const TruthSample truth = robot->truth();
        append(record.truth, {truth.stamp_us, truth.T_world_robot});
        if (recorded) recorded->addTruth(truth);
        record.add(frame, false);
      },
      duration(options));
  if (recorded) recorded->finish();
  const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - began;
  nlohmann::json json = finish(record, run, options, params, options.world.string());
  for (const auto& problem : robot->takeScenarioProblems()) json["scenario_problems"].push_back(problem);
  if (options.profile) addProfile(json, stages, spent.count(), toSeconds(robot->now()));
  return json;
}

}  // namespace

nlohmann::json evaluate(const EvaluationOptions& options) {
  return options.bag.empty() ? evaluateWorld(options) : evaluateBag(options);
}

}  // namespace vismem
