#include "experiments/app/e1_look_around.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <random>
#include <stdexcept>

#include "active_visual_memory/core/overlay.h"
#include "common/geometry/angles.h"
#include "common/kinematics/kinematics.h"
#include "common/vision/app/image_file.h"
#include "experiments/app/experiment_files.h"
#include "experiments/app/experiment_run.h"
#include "experiments/app/score_json.h"
#include "experiments/core/board.h"
#include "simulator/app/render_view.h"

namespace vismem {
namespace {

constexpr double kTurnRate_radps = 0.35;  // 20 degrees per second
constexpr double kSpeed_mps = 0.3;
constexpr double kWay_m = 1.0;
constexpr double kClearance_m = 0.3;
constexpr int kPanel_px = 520;

struct Variant {
  const char* name;
  const char* world;
  const char* title;
  double noise;  ///< grey levels; below 0: as the setup says
  double tilt_error_deg;
};

constexpr Variant kVariants[] = {
    {"room", "room", "the room, as the setup `sim` is configured", -1.0, 0.0},
    {"room_noise", "room", "camera noise of 6 grey levels", 6.0, 0.0},
    {"room_tilt", "room", "the camera looks 0.5 degrees higher than the robot believes", -1.0, 0.5},
    {"texture", "texture", "the room with a carpet full of lines", -1.0, 0.0},
};

/// Near the middle, at a place with a metre of free way ahead.
Pose2 startOf(const World& world, std::uint64_t seed) {
  std::mt19937_64 random(seed * 7919 + 17);
  const auto draw = [&](double low, double high) {
    return low + (high - low) * (static_cast<double>(random() >> 11) * 0x1.0p-53);
  };
  const auto obstacles = obstaclesOf(world);
  constexpr int kTries = 1000;
  for (int i = 0; i < kTries; ++i) {
    const Pose2 start{draw(-0.6, 0.6), draw(-0.3, 0.3), draw(-std::numbers::pi, std::numbers::pi)};
    bool free = true;
    for (double way = 0.0; way <= kWay_m + 0.05 && free; way += 0.05) {
      const Eigen::Vector2d at = (start * Pose2{way, 0.0, 0.0}).position();
      free = std::all_of(obstacles.begin(), obstacles.end(), [&](const WorldObstacle& obstacle) {
        return distanceToOutline(at, obstacle.outline) > kClearance_m;
      });
    }
    if (free) return start;
  }
  throw std::runtime_error(world.name + ": nowhere in the middle is a metre of free way");
}

class Elements {
 public:
  explicit Elements(const std::filesystem::path& file)
      : csv_(file, "variant,after,id,x1_m,y1_m,x2_m,y2_m,label,verdict,true_edge") {}
  void add(const char* variant, const char* after, const MemoryScore& score,
           const std::vector<RememberedEdge>& memory) {
    const auto row = [&](const RememberedEdge& e, const char* verdict, int edge) {
      csv_.row(text("%s,%s,%llu,%.4f,%.4f,%.4f,%.4f,%s,%s,%d", variant, after,
                    static_cast<unsigned long long>(e.id), e.world.a.x(), e.world.a.y(), e.world.b.x(),
                    e.world.b.y(), e.label.c_str(), verdict, edge));
    };
    for (const auto& judged : score.judged) {
      constexpr const char* kNames[] = {"right", "partial", "false"};
      row(judged.edge, kNames[static_cast<int>(judged.verdict)], judged.true_edge);
    }
    for (const RememberedEdge& e : memory) {
      if (!e.confirmed) row(e, "unconfirmed", -1);
    }
  }
  void close() { csv_.close(); }

 private:
  CsvFile csv_;
};

/// What became of each true edge.
class Edges {
 public:
  explicit Edges(const std::filesystem::path& file)
      : csv_(file, "variant,after,edge,x1_m,y1_m,x2_m,y2_m,label,curve,longest_view_px,state") {}
  void add(const char* variant, const char* after, const MemoryScore& score,
           const std::vector<TrueEdge>& edges) {
    for (std::size_t i = 0; i < edges.size(); ++i) {
      const TrueEdge& edge = edges[i];
      const bool missed = std::count(score.missed.begin(), score.missed.end(), static_cast<int>(i)) > 0;
      const Eigen::Vector2d a = edge.pieces.front().a;
      const Eigen::Vector2d b = edge.pieces.back().b;
      csv_.row(text("%s,%s,%zu,%.3f,%.3f,%.3f,%.3f,%s,%d,%.1f,%s", variant, after, i, a.x(), a.y(), b.x(),
                    b.y(), edge.label.c_str(), edge.curve ? 1 : 0, edge.longest_view_px,
                    !edge.shown_in_full ? "not shown in full"
                    : missed            ? "missed"
                                        : "found"));
    }
  }
  void close() { csv_.close(); }

 private:
  CsvFile csv_;
};

BoardPanel planPanel(const ExperimentRun& run, const MemoryScore& score, std::string title) {
  BoardPanel panel;
  panel.title = std::move(title);
  panel.plan = planOfScore(score, rememberedIn(run.snapshot(), run.trueRobot()), run.truth().edges());
  panel.plan->robot = run.trueRobot();
  const ImageAnalysis& analysis = run.analysis();
  const Eigen::Vector3d axis = analysis.T_robot_camera.linear().col(2);
  panel.plan->view = ViewCone{run.trueRobot().theta + std::atan2(axis.y(), axis.x()),
                              2.0 * std::atan(0.5 * analysis.intrinsics.width / analysis.intrinsics.fx), 4.0};
  panel.caption = {
      text("%d right, %d on an edge with a wrong end, %d false; %d not confirmed", score.right, score.partial,
           score.wrong, score.unconfirmed),
      text("precision %.3f, recall %.3f (of edges of 10 px or more %.3f), %.2f elements per edge",
           score.precision(), score.recall(), score.recallResolved(), score.duplicates())};
  return panel;
}

void drawFigure13(ExperimentRun& run, const MemoryScore& score, const ExperimentOptions& options) {
  const World& world = run.simulation().config().world;
  Renderer renderer(world);
  const View above = topView(world, 2 * kPanel_px);
  Board board;
  board.title = "One image against the memory (figure 13)";
  board.subtitle = text("E1, %s mode, seed %llu: the robot turned, drove one metre and turned again",
                        options.mode.c_str(), static_cast<unsigned long long>(options.seed));
  BoardPanel scene{"the scene from above", {}, renderer.render(above.intrinsics, above.T_world_camera), {}};
  const ImageAnalysis& analysis = run.analysis();
  BoardPanel image{"the current image", {}, drawAnalysis(run.lastImage()->image, analysis, 3), {}};
  image.caption = {text("%zu segments; %.1f true edges an image on average, %d at most",
                        analysis.observed.size(), run.meanEdgesPerImage(), run.mostEdgesInAnImage()),
                   "green: remembered and seen; red: only remembered; blue: only seen"};
  board.rows = {{scene, image}, {planPanel(run, score, "the memory over the true edges")}};
  board.legend = legendOfScore();
  writeImageFile(drawBoard(board, kPanel_px), options.out / "figure13.png");
}

nlohmann::json runVariant(const Variant& variant, const ExperimentOptions& options, Elements& elements,
                          Edges& edges) {
  ExperimentRunOptions run_options;
  run_options.world = variant.world;
  run_options.mode = options.mode;
  run_options.seed = options.seed;
  run_options.change_robot = [&](SimulationConfig& robot) {
    robot.start = startOf(robot.world, options.seed);
    SimulatedCameraParams& camera = robot.cameras.front();
    if (variant.noise >= 0.0) camera.errors.gaussian = variant.noise;
    camera.T_believed_true =
        poseFromXyzRpy(0.0, 0.0, 0.0, 0.0, -degToRad(variant.tilt_error_deg), 0.0) * camera.T_believed_true;
  };
  ExperimentRun run(run_options);
  nlohmann::json json;
  const auto judge = [&](const char* after) {
    const MemoryScore score = run.score();
    elements.add(variant.name, after, score, rememberedIn(run.snapshot(), run.trueRobot()));
    edges.add(variant.name, after, score, run.truth().edges());
    json[after] = toJson(score);
    json[after]["edges_per_image_mean"] = run.meanEdgesPerImage();
    json[after]["edges_per_image_most"] = run.mostEdgesInAnImage();
    json[after]["memory_over_image"] = score.right / std::max(1.0, run.meanEdgesPerImage());
    return score;
  };
  run.turn(2.0 * std::numbers::pi, kTurnRate_radps);
  judge("turn");
  run.drive(kWay_m, kSpeed_mps);
  run.turn(2.0 * std::numbers::pi, kTurnRate_radps);
  const MemoryScore score = judge("drive");
  json["seconds"] = run.now_s();
  if (std::string(variant.name) == "room") drawFigure13(run, score, options);
  Board plan{std::string("E1: ") + variant.title,
             text("%s mode, seed %llu", options.mode.c_str(), static_cast<unsigned long long>(options.seed)),
             {{planPanel(run, score, "the memory over the true edges")}},
             legendOfScore()};
  writeImageFile(drawBoard(plan, 2 * kPanel_px),
                 options.out / (std::string("plan_") + variant.name + ".png"));
  return json;
}

}  // namespace

nlohmann::json lookAround(const ExperimentOptions& options) {
  Elements elements(options.out / "elements.csv");
  Edges edges(options.out / "edges.csv");
  nlohmann::json json;
  for (const Variant& variant : kVariants) {
    if (!options.variant.empty() && options.variant != variant.name) continue;
    json[variant.name] = runVariant(variant, options, elements, edges);
  }
  elements.close();
  edges.close();
  if (json.empty()) throw std::invalid_argument("E1 has no variant \"" + options.variant + "\"");
  return json;
}

}  // namespace vismem
