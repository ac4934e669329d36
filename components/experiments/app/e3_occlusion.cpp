#include "experiments/app/e3_occlusion.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <opencv2/core.hpp>
#include <stdexcept>

#include "common/config/text_format.h"
#include "common/geometry/angles.h"
#include "common/vision/app/image_file.h"
#include "evaluation/figures/board.h"
#include "experiments/app/experiment_run.h"
#include "experiments/app/look_around_run.h"
#include "experiments/app/score_json.h"
#include "localization/core/random_engine.h"

namespace vismem {
namespace {

constexpr double kOccluded_s = 10.0;
constexpr double kSpeed_mps = 0.13;
constexpr double kAhead_m = 0.72;  ///< of the other robot's middle: it occludes most of the view
constexpr int kPanel_px = 420;
constexpr const char* kOtherRobot = "other_robot";
constexpr const char* kRemoved = "rectangle";

ExperimentRunOptions runOptions(const ExperimentOptions& options) {
  RandomEngine random(options.seed * 104'729 + 5);
  ExperimentRunOptions run;
  run.mode = options.mode;
  run.seed = options.seed;
  // Along the room's middle, the rectangle ahead to the right.
  run.start = {uniform(random, 0.9, 1.1), uniform(random, -0.1, 0.1), uniform(random, 3.04, 3.24)};
  return run;
}

/// Builds the memory: a short drive, and time to look about.
void buildMemory(ExperimentRun& run) {
  run.drive(0.4, 0.2);
  run.stand(14.0);
}

void lookAhead(ExperimentRun& run) {
  const Pose2 T_odom_robot = run.snapshot().T_odom_robot;
  const Eigen::Vector2d ahead = (T_odom_robot * Pose2{20.0, 0.0, 0.0}).position();
  run.pipeline().memory().gazeClient().fixate({ahead.x(), ahead.y(), -4.5});
}

/// The remembered edges in world.
struct Remembered {
  std::vector<RememberedEdge> edges;
  const RememberedEdge* find(std::uint64_t id) const {
    const auto found = std::find_if(edges.begin(), edges.end(), [&](const auto& e) { return e.id == id; });
    return found == edges.end() ? nullptr : &*found;
  }
};

Remembered memoryOf(const ExperimentRun& run) {
  return {rememberedIn(run.snapshot(), run.trueRobot())};
}

/// The element with the same id, or one at the same place.
const RememberedEdge* survivorOf(const RememberedEdge& before, const Remembered& after) {
  if (const RememberedEdge* same = after.find(before.id)) return same;
  for (const RememberedEdge& e : after.edges) {
    const bool along = lineAngleDifference(e.world.direction(), before.world.direction()) < degToRad(5.0);
    if (along && distanceToSegment(before.world.a, e.world) < 0.08 &&
        distanceToSegment(before.world.b, e.world) < 0.08) {
      return &e;
    }
  }
  return nullptr;
}

/// The elements before an occlusion that are still there after it.
struct Survival {
  int known = 0;  ///< confirmed elements before it
  int known_with_unconfirmed = 0;
  int survived = 0;  ///< of the confirmed ones
  int survived_with_unconfirmed = 0;
  int in_place = 0;      ///< of the survivors
  double worst_m = 0.0;  ///< largest shift of a survivor

  double share(int count) const { return known > 0 ? static_cast<double>(count) / known : 0.0; }
};

/// @param T_world_odom_before, T_world_odom_after true poses of odom: odometry drift may shift elements.
Survival survivalOf(const Remembered& before, const Remembered& after, const Pose2& T_world_odom_before,
                    const Pose2& T_world_odom_after) {
  constexpr double kInPlace_m = 0.05;  // beside the drift
  Survival survival;
  for (const RememberedEdge& e : before.edges) {
    const RememberedEdge* now = survivorOf(e, after);
    ++survival.known_with_unconfirmed;
    survival.survived_with_unconfirmed += now != nullptr;
    if (!e.confirmed) continue;
    ++survival.known;
    if (!now) continue;
    ++survival.survived;
    const Eigen::Vector2d p = transform(inverse(T_world_odom_before), e.world.middle());
    const double drift = (transform(T_world_odom_after, p) - e.world.middle()).norm();
    const double moved = distanceToLine(e.world.middle(), now->world);
    survival.worst_m = std::max(survival.worst_m, moved);
    survival.in_place += moved <= drift + kInPlace_m;
  }
  return survival;
}

BoardPanel planOf(ExperimentRun& run, const MemoryScore& score, const std::string& title) {
  BoardPanel panel{title, {}, {}, planOfScore(score, memoryOf(run).edges, run.truth().edges())};
  panel.plan->robot = run.trueRobot();
  const auto model = run.simulation().scene().find(kOtherRobot);
  for (const ModelStatus& status : run.simulation().scene().status()) {
    if (!model || status.name != kOtherRobot || !status.present) continue;
    const Eigen::Vector2d at = status.T_world_model.translation().head<2>();
    constexpr int kSides = 12;
    for (int i = 0; i < kSides; ++i) {
      const auto corner = [&](int k) {
        const double a = 2.0 * std::numbers::pi * k / kSides;
        return Eigen::Vector2d(at + 0.35 * Eigen::Vector2d(std::cos(a), std::sin(a)));
      };
      panel.plan->lines.push_back({{corner(i), corner(i + 1)}, colors::kLost, 3.0, false});
    }
  }
  panel.caption = {formatted("%zu elements in memory", memoryOf(run).edges.size())};
  return panel;
}

void place(ExperimentRun& run, double ahead_m) {
  const Pose2 at = run.simulation().truth().T_world_robot * Pose2{ahead_m, 0.0, 0.0};
  const PortReply reply = run.simulation().scene().place(kOtherRobot, toPose3(at));
  if (!reply.ok()) throw std::runtime_error(std::string(kOtherRobot) + ": " + reply.message);
}

/// Stands or drives while another robot is close in front.
nlohmann::json bridge(const ExperimentOptions& options, bool drives) {
  ExperimentRun run(runOptions(options));
  buildMemory(run);
  lookAhead(run);
  run.stand(1.5);
  const Remembered before = memoryOf(run);
  const Pose2 T_world_odom_before = run.trueRobot() * inverse(run.snapshot().T_odom_robot);
  const MemoryScore score_before = run.score();
  Board board;
  board.title = drives ? "A second robot in front of the driving robot (figures 16 to 18)"
                       : "A second robot in front of the standing robot (figures 16 to 18)";
  board.subtitle = "E3, " + options.modeAndSeed();
  board.rows.resize(2);
  const auto show = [&](const char* title, const MemoryScore& score) {
    board.rows[0].push_back(imagePanel(run, title));
    board.rows[1].push_back(planOf(run, score, title));
  };
  show("before", score_before);

  const PropShape shape{PropShape::Kind::kRobot, {0.7, 0.7, 1.0}, {0.2, 0.3, 0.7}};
  const PortReply added = run.simulation().scene().add(
      kOtherRobot, shape, toPose3(run.simulation().truth().T_world_robot * Pose2{kAhead_m, 0.0, 0.0}));
  if (!added.ok()) throw std::runtime_error(std::string(kOtherRobot) + ": " + added.message);
  double occluded = 0.0;
  int images = 0;
  run.onFrame([&](const LockstepFrame& frame) {
    // The share of the view that the other robot takes, from the true object image.
    const auto truth = run.simulation().truthImages();
    const auto model = run.simulation().scene().find(kOtherRobot);
    if (!truth || !model || frame.observation.frame.image.empty()) return;
    occluded += static_cast<double>(cv::countNonZero(truth->model == *model)) /
                static_cast<double>(truth->model.total());
    ++images;
  });
  const StampUs end = run.simulation().now() + toStampUs(kOccluded_s);
  run.run(
      [&](MobileBase& base) {
        place(run, kAhead_m);
        base.setVelocity(drives ? kSpeed_mps : 0.0, 0.0);
      },
      [&] { return run.simulation().now() >= end; }, kOccluded_s + 1.0);
  const MemoryScore score_occluded = run.score();
  show("occluded for 10 s", score_occluded);
  const Remembered occluded_memory = memoryOf(run);
  const Pose2 T_world_odom_after = run.trueRobot() * inverse(run.snapshot().T_odom_robot);
  run.onFrame({});
  run.simulation().scene().remove(kOtherRobot);

  const Survival survival = survivalOf(before, occluded_memory, T_world_odom_before, T_world_odom_after);
  run.pipeline().memory().gazeClient().setMode(GazeMode::kAttend);
  run.stand(10.0);
  const MemoryScore score_after = run.score();
  show("10 s after it left", score_after);
  board.legend = legendOfScore();
  writeImageFile(drawBoard(board, kPanel_px),
                 options.out / (drives ? "figure16_18_drive.png" : "figure16_18_stand.png"));
  const double known_all = survival.known_with_unconfirmed;
  return {{"known_before", survival.known},
          {"view_occluded_share", images > 0 ? occluded / images : 0.0},
          {"survived", survival.share(survival.survived)},
          {"survived_with_unconfirmed", known_all > 0 ? survival.survived_with_unconfirmed / known_all : 0.0},
          {"survived_in_place", survival.share(survival.in_place)},
          {"worst_shift_m", survival.worst_m},
          {"before", toJson(score_before)},
          {"occluded", toJson(score_occluded)},
          {"after", toJson(score_after)}};
}

/// Elements on the sides of the model that is removed.
std::vector<RememberedEdge> onModel(const ExperimentRun& run) {
  // The rectangle of room.world.
  const Eigen::Vector2d corners[] = {{-1.8, 0.9}, {-1.2, 0.9}, {-1.2, 1.3}, {-1.8, 1.3}};
  std::vector<RememberedEdge> found;
  for (const RememberedEdge& e : memoryOf(run).edges) {
    for (int i = 0; i < 4; ++i) {
      const Segment2 side{corners[i], corners[(i + 1) % 4]};
      if (lineAngleDifference(e.world.direction(), side.direction()) < degToRad(10.0) &&
          distanceToLine(side.middle(), e.world) < 0.1 && distanceToSegment(e.world.middle(), side) < 0.1) {
        found.push_back(e);
        break;
      }
    }
  }
  return found;
}

nlohmann::json removal(const ExperimentOptions& options) {
  ExperimentRun run(runOptions(options));
  buildMemory(run);
  const Pose2 T_odom_world = run.snapshot().T_odom_robot * inverse(run.trueRobot());
  const Eigen::Vector2d middle = transform(T_odom_world, Eigen::Vector2d(-1.5, 1.1));
  run.pipeline().memory().gazeClient().fixate({middle.x(), middle.y(), 0.0});
  run.stand(2.0);
  const auto known = onModel(run);
  if (known.empty()) return {{"known", 0}};
  const double removed_s = run.now_s();
  const PortReply reply = run.simulation().scene().remove(kRemoved);
  if (!reply.ok()) throw std::runtime_error(reply.message);
  const bool gone = run.run([](MobileBase& base) { base.setVelocity(0.0, 0.0); },
                            [&] { return onModel(run).empty(); }, 60.0);
  return {{"known", known.size()}, {"gone", gone}, {"gone_after_s", run.now_s() - removed_s}};
}

nlohmann::json outOfView(const ExperimentOptions& options) {
  ExperimentRun run(runOptions(options));
  buildMemory(run);
  const auto known = onModel(run);
  if (known.empty()) return {{"known", 0}};
  // Away from it.
  const Pose2 T_odom_robot = run.snapshot().T_odom_robot;
  const Eigen::Vector2d behind = (T_odom_robot * Pose2{-3.0, -3.0, 0.0}).position();
  run.pipeline().memory().gazeClient().fixate({behind.x(), behind.y(), 0.0});
  run.stand(1.0);
  const double turned_s = run.now_s();
  std::optional<double> first_s;
  const auto all_gone = [&] {
    std::size_t alive = 0;
    const Remembered now = memoryOf(run);
    for (const RememberedEdge& e : known) alive += now.find(e.id) != nullptr;
    if (alive < known.size() && !first_s) first_s = run.now_s() - turned_s;
    return alive == 0;
  };
  run.run([](MobileBase& base) { base.setVelocity(0.0, 0.0); }, all_gone, 60.0);
  nlohmann::json json{{"known", known.size()}, {"last_gone_after_s", run.now_s() - turned_s}};
  json["first_gone_after_s"] = first_s ? *first_s : 60.0;
  return json;
}

}  // namespace

nlohmann::json occlusion(const ExperimentOptions& options) {
  nlohmann::json json;
  if (options.wants("stand")) json["stand"] = bridge(options, false);
  if (options.wants("drive")) json["drive"] = bridge(options, true);
  if (options.wants("remove")) json["remove"] = removal(options);
  if (options.wants("unseen")) json["unseen"] = outOfView(options);
  return json;
}

}  // namespace vismem
