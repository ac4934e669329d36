#include "experiments/app/e2_curve.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>

#include "common/geometry/angles.h"
#include "common/kinematics/kinematics.h"
#include "common/vision/app/image_file.h"
#include "evaluation/figures/board.h"
#include "experiments/app/experiment_run.h"
#include "experiments/app/look_around_run.h"
#include "experiments/core/corridor_follower.h"
#include "localization/core/random_engine.h"

namespace vismem {
namespace {

constexpr int kPanel_px = 520;
constexpr double kTilt_rad = -0.30;    ///< of the camera that looks ahead: both walls' feet from 0.6 m on
constexpr double kLookAround_s = 8.0;  ///< standing, before the drive
constexpr double kAtMost_s = 90.0;
constexpr double kPatience_s = 20.0;  ///< a follower that stands for longer has stopped for good
constexpr double kRange_m = 4.0;
constexpr double kRemembered_m = 0.10;  ///< largest distance of a remembered point from an element
/// The curve of the world `curve`: a quarter circle about this point between two walls.
const Eigen::Vector2d kCentre{0.0, 1.75};
constexpr double kMiddle_m = 1.75;
constexpr double kTaken_y_m = 3.2;  ///< behind the curve

bool inCurve(const Eigen::Vector2d& p) {
  return p.x() >= 0.0 && p.y() <= kCentre.y();
}
bool onOuterWall(const Eigen::Vector2d& p) {
  return (p - kCentre).norm() > kMiddle_m;
}

Pose2 startOf(std::uint64_t seed) {
  RandomEngine random(seed * 6151 + 29);
  return {uniform(random, -3.2, -2.4), uniform(random, -0.12, 0.12), uniform(random, -0.12, 0.12)};
}

/// Edges that the follower may use: labelled edges lie where the floor ends.
bool isLabelled(const Label& label) {
  return label != kUnknownLabel;
}

/// Unconfirmed elements may be upright: the outline of the inner wall moves along with the robot.
std::vector<Segment2> rememberedWalls(const ExperimentRun& run, bool confirmed) {
  std::vector<Segment2> walls;
  const Pose2 T_robot_odom = inverse(run.snapshot().T_odom_robot);
  for (const MemorySegment& segment : run.snapshot().segments) {
    if (segment.confirmed != confirmed || !isLabelled(segment.label)) continue;
    walls.push_back(transform(T_robot_odom, segment.odom.floor()));
  }
  return walls;
}

std::vector<Segment2> seenWalls(const ExperimentRun& run) {
  const ImageAnalysis& analysis = run.analysis();
  const GroundProjector projector(run.params().pipeline.memory.projector);
  std::vector<Segment2> walls;
  for (const FloorSegment& segment :
       projector.project(analysis.intrinsics, analysis.T_robot_camera, analysis.observed)) {
    if (isLabelled(segment.label)) walls.push_back(segment.odom());
  }
  return walls;
}

/// Lengths of a wall's edge in the curve [m]: shown by the image, and remembered beyond it.
struct WallKnowledge {
  double in_image_m = 0.0;
  double only_remembered_m = 0.0;
};
struct CurveKnowledge {
  WallKnowledge outer;
  WallKnowledge inner;
};

CurveKnowledge knowledgeOf(ExperimentRun& run) {
  FloorTruth now(run.params().map_edges, {});
  now.addView(run.analysis().intrinsics, run.truePoseOfImage(), run.seesFloor(), 1.0);
  const auto memory = rememberedIn(run.snapshot(), run.trueRobot());
  CurveKnowledge known;
  for (const TrueEdge& edge : now.edges()) {
    double last_along = 0.0;
    for (const TrueEdge::Sample& sample : edge.samples) {
      const double piece = sample.along_m - last_along;
      last_along = sample.along_m;
      const bool near = (sample.p - run.trueRobot().position()).norm() <= kRange_m;
      if (!inCurve(sample.p) || !near) continue;
      WallKnowledge& wall = onOuterWall(sample.p) ? known.outer : known.inner;
      if (sample.seen) {
        wall.in_image_m += piece;
      } else if (std::any_of(memory.begin(), memory.end(), [&](const RememberedEdge& e) {
                   return isLabelled(e.label) && distanceToSegment(sample.p, e.world) <= kRemembered_m;
                 })) {
        wall.only_remembered_m += piece;
      }
    }
  }
  return known;
}

BoardPanel planPanel(const ExperimentRun& run, std::string title, const std::vector<Segment2>& known,
                     const std::vector<Eigen::Vector2d>& way) {
  BoardPanel panel;
  panel.title = std::move(title);
  Plan plan;
  plan.low = {-3.6, -1.1};
  plan.high = {3.0, 4.2};
  for (const TrueEdge& edge : run.truth().edges()) {
    for (const Segment2& piece : edge.pieces) plan.lines.push_back({piece, {205, 208, 214}, 5.0, false});
  }
  for (const Segment2& wall : known) {
    plan.lines.push_back({transform(run.trueRobot(), wall), {20, 150, 70}, 2.0, false});
  }
  plan.paths = {way};
  plan.robot = run.trueRobot();
  plan.view = viewOf(run.trueRobot(), run.analysis(), kRange_m);
  panel.plan = std::move(plan);
  return panel;
}

struct Variant {
  const char* name;
  const char* title;
  bool by_memory;
  bool looks_ahead;  ///< the camera stays where it is instead of attending
};

constexpr Variant kVariants[] = {
    {"memory", "The curve by the memory (figures 14, 15)", true, false},
    {"image", "The curve by single images, the same gaze (figures 14, 15)", false, false},
    {"image_ahead", "The curve by single images, the camera looking ahead", false, true},
};

ExperimentRunOptions runOptions(const ExperimentOptions& options, const Variant& variant) {
  ExperimentRunOptions run_options;
  run_options.world = "curve";
  run_options.mode = options.mode;
  run_options.seed = options.seed;
  run_options.start = startOf(options.seed);
  if (variant.looks_ahead) {
    run_options.change_memory = [](MemoryPipelineParams& memory) {
      memory.memory.gaze.initial_mode = GazeMode::kOff;
    };
  }
  return run_options;
}

/// @param end how the drive ended.
void writeFigure(Board board, const ExperimentOptions& options, const Variant& variant, const char* end) {
  board.title = variant.by_memory ? "The curve by the memory (figures 14, 15)"
                                  : "The curve by single images (figures 14, 15)";
  board.subtitle = "E2, " + options.modeAndSeed() + ": " + end;
  board.legend = {
      {"walls", {205, 208, 214}}, {"known to the follower", {20, 150, 70}}, {"way", colors::kEstimate}};
  writeImageFile(drawBoard(board, kPanel_px), options.out / (std::string(variant.name) + ".png"));
}

nlohmann::json drive(const ExperimentOptions& options, const Variant& variant) {
  const bool by_memory = variant.by_memory;
  ExperimentRun run(runOptions(options, variant));
  const auto obstacles = obstaclesOf(run.simulation().config().world);
  double nearest_m = std::numeric_limits<double>::max();
  std::vector<Eigen::Vector2d> way;
  std::optional<CurveKnowledge> before;
  Board board;
  board.rows.resize(2);
  const auto known = [&] { return by_memory ? rememberedWalls(run, true) : seenWalls(run); };
  const auto show = [&](const char* when) {
    board.rows[0].push_back(imagePanel(run, std::string("the image ") + when));
    board.rows[1].push_back(
        planPanel(run, by_memory ? "walls in the memory" : "walls in the image", known(), way));
  };
  run.onFrame([&](const LockstepFrame&) {
    const Eigen::Vector2d at = run.trueRobot().position();
    if (way.empty() || (at - way.back()).norm() > 0.03) way.push_back(at);
    for (const WorldObstacle& obstacle : obstacles) {
      nearest_m = std::min(nearest_m, distanceToOutline(at, obstacle.outline));
    }
    // At the beginning of the curve.
    if (!before && at.x() >= -0.35) {
      before = knowledgeOf(run);
      show("at the beginning of the curve");
    }
  });
  if (variant.looks_ahead)
    run.simulation().panTilt().command({PanTiltCommand::Kind::kPosition, 0.0, kTilt_rad, 1.0, 1.0});
  run.stand(kLookAround_s);
  CorridorFollower follower({});
  ArcCommand command;
  StampUs thought_us = 0;
  double moved_s = run.now_s();
  const auto driver = [&](MobileBase& base) {
    // Once per image.
    if (run.snapshot().stamp_us != thought_us) {
      thought_us = run.snapshot().stamp_us;
      command = follower.follow(known(), by_memory ? rememberedWalls(run, false) : std::vector<Segment2>());
    }
    if (command.v_mps > 0.0) moved_s = run.now_s();
    base.setVelocity(command.v_mps, command.w_radps);
  };
  const double radius = run.simulation().config().base.radius_m;
  bool touched = false;
  const auto done = [&] {
    touched = touched || nearest_m <= radius + 0.005;
    return touched || run.now_s() - moved_s > kPatience_s || run.trueRobot().y >= kTaken_y_m;
  };
  const double begin_s = run.now_s();
  run.run(driver, done, kAtMost_s);
  const bool taken = !touched && run.trueRobot().y >= kTaken_y_m;
  show("at the end");
  writeFigure(std::move(board), options, variant,
              taken     ? "the curve was taken"
              : touched ? "the robot touched a wall"
                        : "the robot stopped: no corridor known ahead");
  nlohmann::json json{{"taken", taken},
                      {"touched", touched},
                      {"seconds", run.now_s() - begin_s},
                      {"nearest_wall_m", nearest_m}};
  if (before) {
    json["outer_in_image_m"] = before->outer.in_image_m;
    json["outer_only_remembered_m"] = before->outer.only_remembered_m;
    json["inner_in_image_m"] = before->inner.in_image_m;
    json["inner_only_remembered_m"] = before->inner.only_remembered_m;
  }
  return json;
}

}  // namespace

nlohmann::json followCurve(const ExperimentOptions& options) {
  nlohmann::json json;
  for (const Variant& variant : kVariants) {
    if (options.wants(variant.name)) json[variant.name] = drive(options, variant);
  }
  return json;
}

}  // namespace vismem
