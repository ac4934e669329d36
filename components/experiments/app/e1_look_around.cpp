#include "experiments/app/e1_look_around.h"

#include <nlohmann/json.hpp>

#include "common/config/text_format.h"
#include "common/geometry/angles.h"
#include "common/vision/app/image_file.h"
#include "common/visual_memory/overlay.h"
#include "evaluation/figures/board.h"
#include "experiments/app/experiment_run.h"
#include "experiments/app/look_around_run.h"
#include "simulator/app/render_view.h"

namespace vismem {
namespace {

constexpr int kPanel_px = 520;

struct Variant {
  const char* name;
  const char* world;
  const char* title;
  double noise;  ///< grey levels; below 0: the setup's
  double tilt_error_deg;
};

constexpr Variant kVariants[] = {
    {"room", "room", "the room, as the setup `sim` is configured", -1.0, 0.0},
    {"room_noise", "room", "camera noise of 6 grey levels", 6.0, 0.0},
    {"room_tilt", "room", "the camera looks 0.5 degrees higher than the robot believes", -1.0, 0.5},
    {"texture", "texture", "the room with a carpet full of lines", -1.0, 0.0},
};

void drawFigure13(ExperimentRun& run, const MemoryScore& score, const ExperimentOptions& options) {
  const World& world = run.simulation().config().world;
  Renderer renderer(world);
  const View above = topView(world, 2 * kPanel_px);
  Board board;
  board.title = "One image against the memory (figure 13)";
  board.subtitle = "E1, " + options.modeAndSeed() + ": the robot turned, drove one metre and turned again";
  BoardPanel scene{"the scene from above", {}, renderer.render(above.intrinsics, above.T_world_camera), {}};
  const ImageAnalysis& analysis = run.analysis();
  BoardPanel image{"the current image", {}, drawAnalysis(run.lastImage()->image, analysis, 3), {}};
  image.caption = {formatted("%zu segments; %.1f true edges an image on average, %d at most",
                             analysis.observed.size(), run.meanEdgesPerImage(), run.mostEdgesInAnImage()),
                   "green: remembered and seen; red: only remembered; blue: only seen"};
  BoardPanel plan = scorePanel(run, score, "the memory over the true edges");
  plan.columns = 2;
  board.rows = {{scene, image}, {std::move(plan)}};
  board.legend = legendOfScore();
  writeImageFile(drawBoard(board, kPanel_px), options.out / "figure13.png");
}

nlohmann::json runVariant(const Variant& variant, const ExperimentOptions& options, JudgementFiles& files) {
  ExperimentRunOptions run_options;
  run_options.world = variant.world;
  run_options.mode = options.mode;
  run_options.seed = options.seed;
  run_options.change_robot = [&](SimulationConfig& robot) {
    robot.start = startNearMiddle(robot.world, options.seed);
    SimulatedCameraParams& camera = robot.cameras.front();
    if (variant.noise >= 0.0) camera.errors.gaussian = variant.noise;
    camera.T_believed_true =
        poseFromXyzRpy(0.0, 0.0, 0.0, 0.0, -degToRad(variant.tilt_error_deg), 0.0) * camera.T_believed_true;
  };
  ExperimentRun run(run_options);
  nlohmann::json json;
  const MemoryScore score = lookAroundTwice(run, variant.name, LookAroundWay{}, files, json);
  if (std::string(variant.name) == "room") drawFigure13(run, score, options);
  Board plan{std::string("E1: ") + variant.title,
             options.modeAndSeed(),
             {{scorePanel(run, score, "the memory over the true edges")}},
             legendOfScore()};
  writeImageFile(drawBoard(plan, 2 * kPanel_px),
                 options.out / (std::string("plan_") + variant.name + ".png"));
  return json;
}

}  // namespace

nlohmann::json lookAround(const ExperimentOptions& options) {
  JudgementFiles files(options.out);
  nlohmann::json json;
  for (const Variant& variant : kVariants) {
    if (options.wants(variant.name)) json[variant.name] = runVariant(variant, options, files);
  }
  files.close();
  return json;
}

}  // namespace vismem
