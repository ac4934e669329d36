#include "experiments/app/e4_humanoid.h"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

#include "common/config/project_file.h"
#include "common/config/text_format.h"
#include "common/geometry/angles.h"
#include "common/recording/robot_log.h"
#include "common/vision/app/image_file.h"
#include "common/visual_memory/overlay.h"
#include "evaluation/core/recorded_memory_score.h"
#include "experiments/app/look_around_run.h"
#include "replay_server/core/stepped_log.h"

namespace vismem {
namespace {

namespace fs = std::filesystem;

constexpr int kPanel_px = 400;
constexpr std::size_t kSnapshots = 4;
/// From this stamp on the recorded camera pose is wrong (README of the recording).
constexpr StampUs kCameraPoseLost_us = 509'900'000;

/// Annotated images of a run; a figure shows a few of them.
class Snapshots {
 public:
  void add(const cv::Mat& image, const ImageAnalysis& analysis, double time_s) {
    if (!taken_.empty() && time_s - taken_.back().time_s < kEvery_s) return;
    const Eigen::Vector3d axis = analysis.T_robot_camera.linear().col(2);
    taken_.push_back({drawAnalysis(image, analysis, 2), time_s, radToDeg(std::atan2(axis.y(), axis.x())),
                      radToDeg(std::asin(std::clamp(axis.z(), -1.0, 1.0)))});
  }
  /// A few of them, evenly spread.
  std::vector<BoardPanel> panels() const {
    std::vector<BoardPanel> chosen;
    const std::size_t n = std::min(kSnapshots, taken_.size());
    for (std::size_t i = 0; i < n; ++i) {
      const Taken& t = taken_[(2 * i + 1) * taken_.size() / (2 * n)];
      chosen.push_back({formatted("after %.1f s: %.0f deg %s, %.0f deg %s", t.time_s, std::abs(t.pan_deg),
                                  t.pan_deg < 0.0 ? "right" : "left", std::abs(t.tilt_deg),
                                  t.tilt_deg < 0.0 ? "down" : "up"),
                        {},
                        t.picture,
                        {}});
    }
    return chosen;
  }

 private:
  static constexpr double kEvery_s = 1.0;
  struct Taken {
    cv::Mat picture;
    double time_s;
    double pan_deg;
    double tilt_deg;
  };
  std::vector<Taken> taken_;
};

void writeFigure(const std::string& title, const std::string& subtitle, const Snapshots& snapshots,
                 BoardPanel plan, const fs::path& file) {
  auto images = snapshots.panels();
  Board board{title, subtitle, {}, legendOfScore()};
  for (std::size_t i = 0; i < images.size(); i += 2) {
    const auto first = images.begin() + static_cast<std::ptrdiff_t>(i);
    board.rows.emplace_back(first,
                            first + static_cast<std::ptrdiff_t>(std::min<std::size_t>(2, images.size() - i)));
  }
  plan.columns = 2;
  board.rows.push_back({std::move(plan)});
  writeImageFile(drawBoard(board, kPanel_px), file);
}

nlohmann::json simulated(const std::string& world, const ExperimentOptions& options, JudgementFiles& files) {
  LookAroundWay way;
  way.speed_mps = 0.2;
  const Route route = loadRoute(projectFile("cfg/worlds/" + world + ".route"));
  ExperimentRunOptions run_options;
  run_options.world = world;
  run_options.setup = "humanoid";
  run_options.mode = options.mode;
  run_options.seed = options.seed;
  run_options.change_robot = [&](SimulationConfig& robot) {
    std::uint64_t draw = 0;
    robot.start = placeWithFreeWay(robot.world, way.way_m, [&] {
      return startOnRoute(route, options.seed * 1000 + draw++).T_world_robot;
    });
  };
  ExperimentRun run(run_options);
  Snapshots snapshots;
  run.onFrame([&](const LockstepFrame& frame) {
    snapshots.add(frame.observation.frame.image, run.analysis(), run.now_s());
  });
  nlohmann::json json;
  const MemoryScore score = lookAroundTwice(run, world, way, files, json);
  writeFigure("The memory of a walking humanoid that turns its neck (figure 19): " + world,
              "E4, " + options.modeAndSeed() +
                  ": it turned, walked a metre, turned again; its kinematics do not model body sway",
              snapshots, scorePanel(run, score, "the memory over the true edges"),
              options.out / ("figure19_" + world + ".png"));
  return json;
}

nlohmann::json spread(const RecordedMemoryScore::Spread& s) {
  return {{"median", s.median}, {"least", s.least}, {"most", s.most}};
}

nlohmann::json toJson(const RecordedMemoryScore& score) {
  nlohmann::json json{{"images", score.moments},
                      {"images_without_pose", score.moments_without_pose},
                      {"images_with_circle", score.moments_with_circle},
                      {"images_with_circle_shape", score.moments_with_circle_shape},
                      {"elements", spread(score.confirmed)},
                      {"elements_per_edge", spread(score.elements_per_edge)},
                      {"elements_per_edge_with_unconfirmed", spread(score.elements_per_edge_all)}};
  if (score.circle_radius_m) json["circle_radius_m"] = spread(*score.circle_radius_m);
  if (score.circle_shape_radius_m) json["circle_shape_radius_m"] = spread(*score.circle_shape_radius_m);
  if (score.distance_m) json["distance_to_map_m"] = *score.distance_m;
  if (score.distance_with_unconfirmed_m) {
    json["distance_to_map_with_unconfirmed_m"] = *score.distance_with_unconfirmed_m;
  }
  for (const auto& window : score.windows) {
    nlohmann::json one{{"from_s", toSeconds(window.from_us)}};
    if (window.distance_m) one["distance_to_map_m"] = *window.distance_m;
    json["windows"].push_back(std::move(one));
  }
  return json;
}

nlohmann::json recorded(const fs::path& folder, const ExperimentOptions& options, JudgementFiles& files) {
  EvaluationOptions evaluation;
  evaluation.bag = folder / "nao_field_2009.bag";
  evaluation.setup = "nao";
  evaluation.map = folder / "map.csv";
  evaluation.mode = options.mode;
  evaluation.seed = options.seed;
  SteppedLog robot(RobotLog::open(evaluation.bag.string()));
  const EvaluationParams params = loadParams(evaluation, !robot.log().knowsCameraPose());
  MemoryPipeline memory(params.pipeline, params.palette);
  Localizer localizer(params.localizer, params.map_edges, options.seed);
  Lockstep run(robot, params.assembler, memory, &localizer);
  std::vector<RecordedMoment> moments;
  Snapshots snapshots;
  bool over = false;
  std::optional<StampUs> first_us;
  const auto visit = [&](const LockstepFrame& frame) {
    const RobotObservation& o = frame.observation;
    over = over || o.frame.stamp_us >= kCameraPoseLost_us;
    if (over) return;
    if (!first_us) first_us = o.frame.stamp_us;
    RecordedMoment moment{frame.memory.update.snapshot, o.frame.intrinsics, o.T_robot_camera, std::nullopt};
    if (const auto& pose = frame.estimate.T_world_robot) {
      moment.T_world_robot = *pose * inverse(frame.estimate.T_odom_robot) * o.T_odom_robot;
    }
    moments.push_back(std::move(moment));
    snapshots.add(o.frame.image, *frame.memory.update.analysis, toSeconds(o.frame.stamp_us - *first_us));
  };
  while (!over && run.step(visit)) {
  }
  const RecordedMemoryScore score = scoreRecordedMemory(moments, params.map_edges);
  if (!score.last) throw std::runtime_error(evaluation.bag.string() + ": the robot was never localized");
  files.add("nao", "end", *score.last, score.last_memory, score.edges);
  BoardPanel plan{"the memory at the end over the field's map",
                  {},
                  {},
                  planOfScore(*score.last, score.last_memory, score.edges)};
  plan.plan->robot = score.windows.back().T_world_odom * moments.back().memory->T_odom_robot;
  plan.caption = {
      formatted("distance to the map's edges %.3f m (median, within 2.5 m, one alignment each 5 s)",
                score.distance_m.value_or(0.0)),
      formatted("circle %.3f m (%.3f to %.3f), %.2f elements per edge",
                score.circle_radius_m ? score.circle_radius_m->median : 0.0,
                score.circle_radius_m ? score.circle_radius_m->least : 0.0,
                score.circle_radius_m ? score.circle_radius_m->most : 0.0, score.elements_per_edge.median)};
  writeFigure(
      "The memory of a real Nao on a football field (figure 19)",
      formatted("E4, %s mode: the recording nao_field_2009, %d images", options.mode.c_str(), score.moments),
      snapshots, std::move(plan), options.out / "figure19_nao.png");
  return toJson(score);
}

}  // namespace

nlohmann::json humanoid(const ExperimentOptions& options) {
  JudgementFiles files(options.out);
  nlohmann::json json;
  const auto wanted = [&](const char* name) {
    if (!options.wants(name)) return false;
    std::cerr << "E4, seed " << options.seed << ": " << name << std::endl;
    return true;
  };
  for (const char* world : {"corridor", "field_6x4"}) {
    if (wanted(world)) json[world] = simulated(world, options, files);
  }
  if (wanted("nao")) {
    const fs::path folder = options.data / "nao_field_2009";
    if (fs::exists(folder)) {
      json["nao"] = recorded(folder, options, files);
    } else {
      json["absent"] = {folder.string() + ": not there"};
    }
  }
  files.close();
  return json;
}

}  // namespace vismem
