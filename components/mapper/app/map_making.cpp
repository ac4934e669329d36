#include "mapper/app/map_making.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "common/config/config_error.h"
#include "common/config/text_file.h"
#include "common/config/text_format.h"
#include "common/kinematics/calibrated_ports.h"
#include "common/recording/bag_advice.h"
#include "common/tool/progress_line.h"
#include "evaluation/app/evaluation_setup.h"
#include "evaluation/app/perturbed_robot.h"
#include "evaluation/core/lockstep.h"
#include "mapper/core/drive_collector.h"
#include "mapper/core/drive_record_io.h"
#include "replay_server/core/stepped_log.h"

namespace vismem {
namespace {

constexpr double kSlowest_mps = 0.03;

RecordedDrive emptyDrive(const EvaluationParams& params) {
  RecordedDrive drive;
  drive.palette_file = params.palette_file;
  drive.labels = params.palette->labels();
  drive.stripes = params.palette->stripes();
  drive.params = DriveMapperParams::of(params.pipeline.memory, params.localizer);
  return drive;
}

/// Collects the record of a run in lock-step.
class Collector {
 public:
  Collector(const EvaluationParams& params, const RecordedDrive& drive)
      : collected_(KeyframeParams::of(params.pipeline.memory),
                   drive.params.closing.localizer.robust.observation.range_m),
        memory_(params.pipeline, params.palette) {}

  MemoryPipeline& memory() { return memory_; }
  bool isBroken() const { return collected_.isBroken(); }
  double way_m() const { return collected_.way_m(); }
  void add(const LockstepFrame& frame) {
    collected_.add(frame.observation.frame, frame.memory.update, valuesOf(memory_.memory().elements()));
  }
  void into(RecordedDrive& drive) const {
    drive.broken = collected_.isBroken();
    drive.record = collected_.record();
    drive.updates = collected_.updates();
  }

 private:
  DriveCollector collected_;
  MemoryPipeline memory_;
};

RecordedDrive recordBag(const MapMakingOptions& options) {
  RobotLogOptions log;
  if (const std::string wrong = applyTopics(options.drive.topics, log); !wrong.empty()) {
    throw ConfigError({"--topics " + wrong});
  }
  SteppedLog robot(RobotLog::open(options.drive.bag.string(), log));
  const EvaluationParams params = loadParams(options.drive, !robot.log().knowsCameraPose());
  RecordedDrive drive = emptyDrive(params);
  for (const TruePose& pose : robot.log().truth()) append(drive.truth, {pose.stamp_us, pose.T_world_robot});
  Collector collector(params, drive);
  CalibratedRobot calibrated(robot, params.joints, params.wheels);
  PerturbedRobot perturbed(calibrated, options.drive.perturbation);
  Lockstep run(perturbed, params.assembler, collector.memory());
  std::optional<StampUs> duration;
  if (options.drive.seconds) duration = toStampUs(*options.drive.seconds);
  run.run([&](const LockstepFrame& frame) { collector.add(frame); }, duration);
  collector.into(drive);
  return drive;
}

RecordedDrive recordWorld(const MapMakingOptions& options) {
  const EvaluationParams params = loadParams(options.drive, true);
  std::filesystem::path file = options.drive.route;
  if (file.empty()) file = std::filesystem::path(options.drive.world).replace_extension(".route");
  Route route = loadRoute(file);
  Pose2 place;
  if (options.drive.start) {
    place = *options.drive.start;
  } else {
    const RouteStart drawn = startOnRoute(route, options.drive.seed);
    place = drawn.T_world_robot;
    if (drawn.backwards) route = reversed(route);
  }
  const auto robot = makeSimulation(options.drive, route, place);
  RecordedDrive drive = emptyDrive(params);
  Collector collector(params, drive);
  CalibratedRobot calibrated(*robot, params.joints, params.wheels);
  PerturbedRobot perturbed(calibrated, options.drive.perturbation);
  Lockstep run(perturbed, params.assembler, collector.memory());
  const double length_m = options.laps * route.length() + options.overlap_m;
  const double seconds = options.drive.seconds.value_or(length_m / kSlowest_mps);
  ProgressLine progress("cm driven");
  const auto visit = [&](const LockstepFrame& frame) {
    const TruthSample truth = robot->truth();
    append(drive.truth, {truth.stamp_us, truth.T_world_robot});
    collector.add(frame);
    progress.show(static_cast<std::size_t>(100.0 * collector.way_m()),
                  static_cast<std::size_t>(100.0 * length_m));
  };
  while (toSeconds(robot->now()) < seconds && !collector.isBroken()) {
    if (!options.drive.seconds && collector.way_m() >= length_m) break;
    if (!run.step(visit)) break;
  }
  collector.into(drive);
  return drive;
}

RecordedDrive readSavedDrive(const MapMakingOptions& options) {
  SavedDrive saved = parseDriveRecord(readTextFile(options.saved_drive, "the record of a drive, NAME.drive"),
                                      options.saved_drive.string());
  MapMakingOptions with_palette = options;
  const std::filesystem::path beside =
      std::filesystem::path(options.saved_drive).replace_extension(".palette");
  if (with_palette.drive.palette.empty() && std::filesystem::exists(beside))
    with_palette.drive.palette = beside;
  const EvaluationParams params = loadParams(with_palette.drive, true);
  RecordedDrive drive = emptyDrive(params);
  drive.record = std::move(saved.record);
  drive.closings = std::move(saved.closings);
  return drive;
}

/// @throws ConfigError for an edit's label that no image gives an edge.
void checkLabels(const RecordedDrive& drive) {
  std::vector<std::string> problems;
  for (const MapEdit& edit : drive.params.edits) {
    const auto& labels = drive.labels;
    if (edit.kind != MapEdit::Kind::kRelabel ||
        std::find(labels.begin(), labels.end(), edit.label) != labels.end()) {
      continue;
    }
    problems.push_back(edit.where + ": label \"" + edit.label + "\" (must be one of " +
                       drive.palette_file.string() + ": " + joined(labels, ", ") + ")");
  }
  if (!problems.empty()) throw ConfigError(problems);
}

MapFilesOptions filesOf(const MapMakingOptions& options) {
  std::filesystem::path source = options.drive.bag.empty() ? options.drive.world : options.drive.bag;
  if (!options.saved_drive.empty()) source = options.saved_drive;
  MapFilesOptions files = options.files;
  files.out = options.drive.out;
  files.seed = options.drive.seed;
  files.source = source.filename().string();
  return files;
}

}  // namespace

RecordedDrive recordDrive(const MapMakingOptions& options) {
  if (!options.saved_drive.empty()) return readSavedDrive(options);
  return options.drive.bag.empty() ? recordWorld(options) : recordBag(options);
}

nlohmann::json makeMapFromDrive(const MapMakingOptions& options) {
  RecordedDrive drive = recordDrive(options);
  drive.params.close = options.close;
  drive.params.right_angles = options.right_angles;
  drive.params.seed = options.drive.seed;
  if (!options.edits.empty()) {
    drive.params.edits = parseMapEdits(readTextFile(options.edits, "edits of a map"), options.edits.string());
    checkLabels(drive);
  }
  const MapFilesOptions files = filesOf(options);
  if (!options.saved_drive.empty()) {
    return writeMapFiles(drive, mapDriveAgain(drive.record, drive.closings, drive.params), files);
  }
  ProgressLine progress("cm of the drive searched for places seen before");
  const DriveMap map = mapDrive(drive.record, drive.updates, drive.params, [&](double done_m, double all_m) {
    progress.show(static_cast<std::size_t>(100.0 * done_m), static_cast<std::size_t>(100.0 * all_m));
  });
  return writeMapFiles(drive, map, files);
}

}  // namespace vismem
