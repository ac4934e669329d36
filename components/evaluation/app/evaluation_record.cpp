#include "evaluation/app/evaluation_record.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "common/geometry/angles.h"
#include "evaluation/report/run_pictures.h"
#include "localization/core/likelihood/camera_calibration.h"

namespace vismem {
namespace {

template <typename Value>
nlohmann::json orNull(const std::optional<Value>& value) {
  return value ? nlohmann::json(*value) : nlohmann::json();
}

nlohmann::json inDegrees(const std::optional<double>& value_rad) {
  return value_rad ? nlohmann::json(radToDeg(*value_rad)) : nlohmann::json();
}

/// The lasting camera tilt and odometry errors that were estimated, each with its standard deviation, and the
/// light at the end.
nlohmann::json calibrationOf(const MemoryPipeline& pipeline, const PoseEstimate& estimate) {
  static constexpr const char* kTilts[] = {"mount_roll", "mount_pitch", "camera_pitch", "camera_roll"};
  nlohmann::json json = nlohmann::json::object();
  const CameraTilt tilt = pipeline.memory().cameraTilt();
  const CameraTiltCovariance P = pipeline.memory().cameraTiltCovariance();
  for (int i = 0; i < 4; ++i) {
    if (P(i, i) <= 0.0) continue;
    json["camera_tilt"][std::string(kTilts[i]) + "_deg"] = radToDeg(tilt[i]);
    json["camera_tilt"][std::string(kTilts[i]) + "_sigma_deg"] = radToDeg(std::sqrt(P(i, i)));
  }
  if (const LightEstimator* estimator = pipeline.light()) {
    const ImageLight& light = estimator->light();
    json["light"] = {{"gain", {light.gain[0], light.gain[1], light.gain[2]}},
                     {"gamma", light.gamma},
                     {"vignette", light.vignette},
                     {"named_share", estimator->namedShare()}};
  }
  if (estimate.camera) {
    for (std::size_t i = 0; i < kCameraErrorTexts.size(); ++i) {
      const CameraErrorText& is = kCameraErrorTexts[i];
      const auto row = static_cast<int>(i);
      json["camera"][is.name] = {{"error", is.scale * estimate.camera->errors[row]},
                                 {"sigma", is.scale * estimate.camera->sigmas[row]},
                                 {"unit", is.unit},
                                 {"is_found", estimate.camera->isFound(row)}};
    }
  }
  if (!estimate.odometry) return json;
  const Eigen::Vector3d& errors = estimate.odometry->errors;
  const Eigen::Vector3d sigmas = estimate.odometry->P.diagonal().cwiseMax(0.0).cwiseSqrt();
  json["odometry"] = {{"yaw_bias_degpm", radToDeg(errors[0])}, {"yaw_bias_sigma_degpm", radToDeg(sigmas[0])},
                      {"yaw_scale_error", errors[1]},          {"yaw_scale_error_sigma", sigmas[1]},
                      {"distance_scale_error", errors[2]},     {"distance_scale_error_sigma", sigmas[2]}};
  return json;
}

void addScore(nlohmann::json& json, const RunSummary& summary) {
  const LocalizationScore& score = summary.score;
  json["map_symmetries"] = summary.map_symmetries;
  json["is_twin"] = score.is_twin;
  json["settled_after_s"] = orNull(score.settled_after_s);
  json["position_error_m"] = orNull(score.position_error_m);
  json["heading_error_deg"] = inDegrees(score.heading_error_rad);
  json["recovered"] = score.recovered;
  json["right_share"] = orNull(score.right_share);
  json["median_position_error_m"] = orNull(score.median_position_error_m);
  json["median_heading_error_deg"] = inDegrees(score.median_heading_error_rad);
  json["images_with_truth"] = score.errors.size();
}

}  // namespace

EvaluationRecord::EvaluationRecord(const EvaluationOptions& options, const EvaluationParams& params)
    : options_(options), params_(params), files_(options.out, options.snapshots) {}

void EvaluationRecord::addTruth(const StampedPose& T_world_robot) {
  recorder_.addTruth(T_world_robot);
  files_.addTruth(T_world_robot);
}

void EvaluationRecord::add(const LockstepFrame& frame, bool judge) {
  const RobotObservation& observation = frame.observation;
  const StampUs stamp_us = observation.frame.stamp_us;
  const MemoryUpdate& update = frame.memory.update;
  const PoseEstimate& estimate = frame.estimate;
  RunRecord& record = recorder_.record();
  gaze_ = frame.memory.gaze;
  recorder_.addOdometry({stamp_us, observation.T_odom_robot});
  files_.addOdometry({stamp_us, observation.T_odom_robot});
  // The estimate holds at its own image's stamp; odometry predicts it to this image.
  std::optional<Pose2> pose;
  if (estimate.T_world_robot) {
    pose = *estimate.T_world_robot * inverse(estimate.T_odom_robot) * observation.T_odom_robot;
    files_.addPose({stamp_us, *pose});
  }
  recorder_.addPublished({stamp_us, pose, estimate.reliability});
  if (record.estimates.empty() || record.estimates.back().revision != estimate.revision) {
    recorder_.addEstimate(estimate);
    files_.addEstimate(estimate);
    ++estimates_;
    race_lived_ = race_lived_ || !estimate.races.empty();
  }
  if (!update.snapshot) return;
  record.memory = record.shown_memory = update.snapshot;
  files_.addMemory(*update.snapshot);
  if (!update.analysis || update.analysis->stamp_us != stamp_us) return;
  record.last_analysis = update.analysis;
  record.last_image = observation.frame;
  segments_ += update.analysis->observed.size();
  labelled_ += static_cast<std::uint64_t>(
      std::count_if(update.analysis->observed.begin(), update.analysis->observed.end(),
                    [](const ImageSegment& segment) { return segment.label != kUnknownLabel; }));
  if (judge) {
    recorder_.addJudged(update.analysis);
    ++judged_;
  }
}

std::vector<std::string> EvaluationRecord::failures() const {
  std::vector<std::string> found = files_.problems();
  if (labelled_ == 0) {
    found.push_back("no label was found: " + std::to_string(segments_) +
                    " segments in the images, none with a " + "label of " + params_.palette_file.string() +
                    " (label_palette IMAGE --palette FILE shows what a palette makes of an image)");
  } else if (!race_lived_) {
    found.push_back("no race ever lived: " + std::to_string(labelled_) +
                    " labelled segments were seen, and none of them fits " + options_.map.string() +
                    " anywhere (expected segments of the map within range; look at last_image.png)");
  }
  return found;
}

nlohmann::json EvaluationRecord::summarise(const Lockstep& run, const MemoryPipeline& memory,
                                           const RunSummary& summary) const {
  const RunRecord& record = recorder_.record();
  const PoseEstimate& last = record.estimates.back();
  nlohmann::json json;
  json["mode"] = params_.localizer.mode == LocalizationMode::kChapter ? "chapter" : "default";
  json["seed"] = options_.seed;
  json["frames"] = run.framesProcessed();
  json["frames_dropped"] = run.framesDropped();
  json["memory_segments"] = summary.memory_segments;
  json["gaze_visits"] = gaze_.visits;
  json["races"] = last.races.size();
  json["reliability"] = last.reliability;
  const double robot_s = toSeconds(record.odometry.back().stamp_us - record.odometry.front().stamp_us);
  json["robot_s"] = robot_s;
  json["path_m"] = pathLength(record.odometry);
  json["memory_hz"] = robot_s > 0.0 ? static_cast<double>(estimates_) / robot_s : 0.0;
  json["calibration"] = calibrationOf(memory, last);
  if (!record.truth.empty()) addScore(json, summary);
  if (summary.projection) {
    json["map_projection_px"] = orNull(summary.projection->detected_to_map_px);
    json["map_to_detected_px"] = orNull(summary.projection->map_to_detected_px);
    json["images_judged"] = summary.projection->images;
    json["images_without_lines"] = summary.projection->images_without_lines;
    json["images_without_pose"] = summary.projection->images_without_pose;
  }
  return json;
}

nlohmann::json EvaluationRecord::finish(const Lockstep& run, const MemoryPipeline& memory,
                                        const std::string& input) {
  const RunRecord& record = recorder_.record();
  if (!record.memory) {
    throw std::runtime_error(input + ": no frame could be used: odometry or camera poses cover none of them");
  }
  files_.finish(record.memory.get());
  const RunSummary summary = summarize(record, params_.map_edges, judged_ > 0);
  const auto& source = options_.bag.empty() ? options_.world : options_.bag;
  const std::string title = (options_.bag.empty() ? "world " : "recording ") + source.stem().string() +
                            ", seed " + std::to_string(options_.seed);
  const auto unwritten =
      writePictures(options_.out, record, summary, {params_.map, params_.map_edges}, title);
  nlohmann::json json = summarise(run, memory, summary);
  std::vector<std::string> problems = failures();
  problems.insert(problems.end(), unwritten.begin(), unwritten.end());
  if (!problems.empty()) json["problems"] = problems;
  return json;
}

}  // namespace vismem
