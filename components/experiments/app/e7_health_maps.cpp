#include "experiments/app/e7_health_maps.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <numbers>
#include <stdexcept>

#include "common/config/text_format.h"
#include "common/geometry/angles.h"
#include "common/vision/app/image_file.h"
#include "common/visual_memory/overlay.h"
#include "evaluation/figures/board.h"
#include "experiments/app/experiment_run.h"
#include "experiments/app/health_picture.h"
#include "localization/core/random_engine.h"

namespace vismem {
namespace {

constexpr const char* kWorld = "corridor";
/// The chapter's health is smooth and slow to compute; our likelihood has peaks of a few centimetres.
constexpr double kCell_m = 0.1;
constexpr int kHeadings = 36;
constexpr double kFineCell_m = 0.05;
constexpr int kFineHeadings = 180;
constexpr int kPanel_px = 520;
constexpr double kOtherRobotAhead_m = 1.0;
/// Share of false segments among those that localization gets.
constexpr double kFalseShare = 0.5;

enum class SceneDisturbance { kNone, kOcclusion, kFalseSegments };

struct Scene {
  const char* name;
  const char* title;
  Pose2 start;
  SceneDisturbance disturbance;
};

const Scene kScenes[] = {
    {"normal", "a corner (figures 22, 23)", {-4.25, 2.25, -0.4}, SceneDisturbance::kNone},
    {"door",
     "a door, with similar doors elsewhere (figure 24)",
     {0.4, 2.1, 0.5 * std::numbers::pi},
     SceneDisturbance::kNone},
    {"occlusion", "another robot in the view (figure 25)", {-4.25, 2.25, -0.4}, SceneDisturbance::kOcclusion},
    {"false",
     "half of the segments false (figure 26)",
     {-4.25, 2.25, -0.4},
     SceneDisturbance::kFalseSegments},
};

ExperimentRunOptions runOptions(const ExperimentOptions& options, const Pose2& start) {
  ExperimentRunOptions run;
  run.world = kWorld;
  run.mode = options.mode;
  run.seed = options.seed;
  run.start = start;
  return run;
}

void addOtherRobot(ExperimentRun& run) {
  const PropShape shape{PropShape::Kind::kRobot, {0.5, 0.5, 0.8}, {0.2, 0.3, 0.7}};
  const Pose2 at = run.simulation().truth().T_world_robot * Pose2{kOtherRobotAhead_m, 0.0, 0.0};
  const PortReply reply = run.simulation().scene().add("other_robot", shape, toPose3(at));
  if (!reply.ok()) throw std::runtime_error("other_robot: " + reply.message);
}

/// The analysis with as many synthetic segments as it has labelled ones, anywhere in the lower half.
ImageAnalysis withFalse(const ImageAnalysis& analysis, std::uint64_t seed) {
  ImageAnalysis result = analysis;
  RandomEngine engine(seed);
  std::vector<Label> labels;
  for (const ImageSegment& segment : analysis.observed) {
    if (segment.label != kUnknownLabel) labels.push_back(segment.label);
  }
  const auto count =
      static_cast<int>(std::lround(kFalseShare / (1.0 - kFalseShare) * static_cast<double>(labels.size())));
  const double width = analysis.intrinsics.width;
  const double height = analysis.intrinsics.height;
  for (int i = 0; i < count; ++i) {
    const double u = uniform(engine, 0.0, width);
    const double v = uniform(engine, 0.5 * height, height);
    const double direction = uniform(engine, -std::numbers::pi, std::numbers::pi);
    const double length = uniform(engine, 20.0, 90.0);
    const Eigen::Vector2d a(u, v);
    const auto px = clipToBox({a, a + length * Eigen::Vector2d(std::cos(direction), std::sin(direction))},
                              Eigen::Vector2d::Zero(), Eigen::Vector2d(width - 1.0, height - 1.0));
    if (px) result.observed.push_back({*px, labels[pick(engine, labels.size())], 40.0});
  }
  return result;
}

nlohmann::json toJson(const HealthMapReading& reading) {
  return {{"best", reading.best},
          {"at_truth", reading.at_truth},
          {"best_off_m", reading.off_m},
          {"places_as_good_share", reading.rivals}};
}

/// Panel and figures of one measure over all places, the best of all headings at each.
BoardPanel panelOf(const std::string& title, const MemoryUpdate& update, const LocalizerParams& params,
                   const SegmentMap& map_edges, PlaceRating rating, const Pose2& truth,
                   nlohmann::json& json) {
  HealthMapRequest request;
  request.rating = rating;
  const bool is_chapter = rating == PlaceRating::kImage || rating == PlaceRating::kMemory;
  request.headings = is_chapter ? kHeadings : kFineHeadings;
  request.cell_m = is_chapter ? kCell_m : kFineCell_m;
  const auto map = HealthMapper(healthMapParams(params), map_edges).map(update, request);
  if (!map) throw std::runtime_error(title + ": nothing was seen that could be rated");
  const HealthMapReading reading = readHealthMap(*map, truth);
  json = toJson(reading);
  BoardPanel panel{
      title,
      {},
      drawHealthMap(*map, map_edges, truth, kPanel_px,
                    rating == PlaceRating::kLikelihood ? HealthScale::kLogarithmic : HealthScale::kLinear),
      {}};
  panel.caption = {formatted("at the true place %.2f, best %.2f, %.2f m from the truth", reading.at_truth,
                             reading.best, reading.off_m),
                   formatted("%.2f %% of the places are as good as the true one", 100.0 * reading.rivals)};
  return panel;
}

}  // namespace

nlohmann::json healthFromImages(const ExperimentOptions& options) {
  nlohmann::json json;
  Board board;
  board.title = "How well every place fits one image (figures 22 to 26)";
  board.subtitle = "E7, seed " + std::to_string(options.seed) +
                   ": the best heading at every place; green: the truth, blue: the best place";
  for (const Scene& scene : kScenes) {
    if (!options.wants(scene.name)) continue;
    ExperimentRun run(runOptions(options, scene.start));
    if (scene.disturbance == SceneDisturbance::kOcclusion) addOtherRobot(run);
    // The gaze stays where it looks first, ahead and a little down.
    const Pose2 T_odom_robot;
    run.pipeline().memory().gazeClient().fixate(
        {(T_odom_robot * Pose2{1.6, 0.0, 0.0}).x, (T_odom_robot * Pose2{1.6, 0.0, 0.0}).y, 0.0});
    run.stand(1.5);
    MemoryUpdate update{std::make_shared<MemorySnapshot>(run.snapshot()),
                        std::make_shared<ImageAnalysis>(run.analysis())};
    if (scene.disturbance == SceneDisturbance::kFalseSegments) {
      update.analysis = std::make_shared<ImageAnalysis>(withFalse(run.analysis(), options.seed));
    }
    LocalizerParams params = run.params().localizer;
    params.robust.observation.source = ObservationSource::kImage;
    const SegmentMap& edges = run.params().map_edges;
    BoardPanel image{scene.title, {}, drawAnalysis(run.lastImage()->image, *update.analysis, 2), {}};
    image.caption = {formatted("%zu segments", update.analysis->observed.size())};
    nlohmann::json& numbers = json[scene.name];
    board.rows.push_back({image,
                          panelOf("the chapter's health (L4)", update, params, edges, PlaceRating::kImage,
                                  run.trueRobot(), numbers["chapter"]),
                          panelOf("our likelihood, logarithmic", update, params, edges,
                                  PlaceRating::kLikelihood, run.trueRobot(), numbers["likelihood"]),
                          panelOf("share explained", update, params, edges, PlaceRating::kExplained,
                                  run.trueRobot(), numbers["explained"])});
  }
  if (json.empty()) return json;
  writeImageFile(drawBoard(board, kPanel_px), options.out / "figure22_26.png");
  return json;
}

nlohmann::json healthFromMemory(const ExperimentOptions& options) {
  Board board;
  board.title = "How well every place fits the memory (figure 27)";
  board.subtitle = "E8, seed " + std::to_string(options.seed) +
                   ": after looking about and half a metre of way; beside it the last image alone";
  nlohmann::json json;
  for (const bool occluded : {false, true}) {
    const char* variant = occluded ? "occlusion" : "normal";
    if (!options.wants(variant)) continue;
    ExperimentRun run(runOptions(options, {-2.6, 2.25, std::numbers::pi}));
    run.drive(0.5, 0.2);
    run.stand(10.0);
    if (occluded) {
      addOtherRobot(run);
      const Pose2 T_odom_ahead = run.snapshot().T_odom_robot * Pose2{1.6, 0.0, 0.0};
      run.pipeline().memory().gazeClient().fixate({T_odom_ahead.x, T_odom_ahead.y, 0.0});
      run.stand(2.0);
    }
    const MemoryUpdate update{std::make_shared<MemorySnapshot>(run.snapshot()),
                              std::make_shared<ImageAnalysis>(run.analysis())};
    LocalizerParams params = run.params().localizer;
    params.robust.observation.source = ObservationSource::kMemory;
    const SegmentMap& edges = run.params().map_edges;
    nlohmann::json& numbers = json[variant];
    BoardPanel image{occluded ? "another robot in the view" : "the last image",
                     {},
                     drawAnalysis(run.lastImage()->image, *update.analysis, 2),
                     {}};
    image.caption = {formatted("%zu elements in memory", update.snapshot->segments.size())};
    board.rows.push_back({image,
                          panelOf("the last image, the chapter's health (L4)", update, params, edges,
                                  PlaceRating::kImage, run.trueRobot(), numbers["image_chapter"]),
                          panelOf("the memory, the chapter's health (L5)", update, params, edges,
                                  PlaceRating::kMemory, run.trueRobot(), numbers["memory_chapter"]),
                          panelOf("the memory, our likelihood, logarithmic", update, params, edges,
                                  PlaceRating::kLikelihood, run.trueRobot(), numbers["memory_likelihood"])});
  }
  if (json.empty()) return json;
  writeImageFile(drawBoard(board, kPanel_px), options.out / "figure27.png");
  return json;
}

}  // namespace vismem
