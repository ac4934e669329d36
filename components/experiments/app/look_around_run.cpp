#include "experiments/app/look_around_run.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "common/config/text_format.h"
#include "common/geometry/angles.h"
#include "common/kinematics/kinematics.h"
#include "common/visual_memory/overlay.h"
#include "experiments/app/score_json.h"
#include "localization/core/random_engine.h"

namespace vismem {
namespace {

constexpr double kClearance_m = 0.3;

/// Estimated camera tilt error about the robot's x and y and the camera's x and z axes, with its standard
/// deviations.
nlohmann::json cameraTiltOf(const AttentiveVisualMemory& memory) {
  constexpr const char* kNames[] = {"robot_x_deg", "robot_y_deg", "camera_x_deg", "camera_z_deg"};
  nlohmann::json json;
  const CameraTiltCovariance P = memory.cameraTiltCovariance();
  for (int i = 0; i < 4; ++i) {
    json[kNames[i]] = radToDeg(memory.cameraTilt()[i]);
    json[kNames[i] + std::string("_sigma")] = radToDeg(std::sqrt(P(i, i)));
  }
  return json;
}

/// The stretches of an edge that were visible, from its beginning [m]: "0.00-0.42 0.78-2.00".
std::string seenOf(const TrueEdge& edge) {
  std::string spans;
  const auto& samples = edge.samples;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (!samples[i].seen) continue;
    const bool begins = i == 0 || !samples[i - 1].seen;
    const bool ends = i + 1 == samples.size() || !samples[i + 1].seen;
    if (begins) spans += formatted("%s%.2f-", spans.empty() ? "" : " ", samples[i].along_m);
    if (ends) spans += formatted("%.2f", samples[i].along_m);
  }
  return spans;
}

}  // namespace

JudgementFiles::JudgementFiles(const std::filesystem::path& folder)
    : elements_(folder / "elements.csv", "variant,after,id,x1_m,y1_m,x2_m,y2_m,label,verdict,true_edge"),
      edges_(folder / "edges.csv",
             "variant,after,edge,x1_m,y1_m,x2_m,y2_m,label,curve,longest_view_px,state,seen_m") {}

void JudgementFiles::add(const std::string& variant, const std::string& after, const MemoryScore& score,
                         const std::vector<RememberedEdge>& memory, const std::vector<TrueEdge>& edges) {
  const auto row = [&](const RememberedEdge& e, const char* verdict, int edge) {
    elements_.row(formatted("%s,%s,%llu,%.4f,%.4f,%.4f,%.4f,%s,%s,%d", variant.c_str(), after.c_str(),
                            static_cast<unsigned long long>(e.id), e.world.a.x(), e.world.a.y(),
                            e.world.b.x(), e.world.b.y(), e.label.c_str(), verdict, edge));
  };
  for (const auto& judged : score.judged) {
    constexpr const char* kNames[] = {"right", "partial", "false"};
    row(judged.edge, kNames[static_cast<int>(judged.verdict)], judged.true_edge);
  }
  for (const RememberedEdge& e : memory) {
    if (!e.confirmed) row(e, "unconfirmed", -1);
  }
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const TrueEdge& edge = edges[i];
    const bool missed = std::count(score.missed.begin(), score.missed.end(), static_cast<int>(i)) > 0;
    const Eigen::Vector2d a = edge.pieces.front().a;
    const Eigen::Vector2d b = edge.pieces.back().b;
    edges_.row(formatted("%s,%s,%zu,%.3f,%.3f,%.3f,%.3f,%s,%d,%.1f,%s,%s", variant.c_str(), after.c_str(), i,
                         a.x(), a.y(), b.x(), b.y(), edge.label.c_str(), edge.curve ? 1 : 0,
                         edge.longest_view_px,
                         !edge.shown_in_full ? "not shown in full"
                         : missed            ? "missed"
                                             : "found",
                         seenOf(edge).c_str()));
  }
}

void JudgementFiles::close() {
  elements_.close();
  edges_.close();
}

MemoryScore lookAroundTwice(ExperimentRun& run, const std::string& variant, const LookAroundWay& way,
                            JudgementFiles& files, nlohmann::json& json) {
  const auto judge = [&](const char* after) {
    const MemoryScore score = run.score();
    files.add(variant, after, score, rememberedIn(run.snapshot(), run.trueRobot()), run.truth().edges());
    json[after] = toJson(score);
    json[after]["edges_per_image_mean"] = run.meanEdgesPerImage();
    json[after]["edges_per_image_most"] = run.mostEdgesInAnImage();
    json[after]["camera_tilt"] = cameraTiltOf(run.pipeline().memory());
    json[after]["memory_over_image"] = score.right / std::max(1.0, run.meanEdgesPerImage());
    return score;
  };
  run.turn(2.0 * std::numbers::pi, way.turn_rate_radps);
  judge("turn");
  run.drive(way.way_m, way.speed_mps);
  run.turn(2.0 * std::numbers::pi, way.turn_rate_radps);
  const MemoryScore score = judge("drive");
  json["seconds"] = run.now_s();
  return score;
}

Pose2 placeWithFreeWay(const World& world, double way_m, const std::function<Pose2()>& draw) {
  const auto obstacles = obstaclesOf(world);
  constexpr int kTries = 1000;
  for (int i = 0; i < kTries; ++i) {
    const Pose2 start = draw();
    bool free = true;
    for (double way = 0.0; way <= way_m + 0.05 && free; way += 0.05) {
      const Eigen::Vector2d at = (start * Pose2{way, 0.0, 0.0}).position();
      free = std::all_of(obstacles.begin(), obstacles.end(), [&](const WorldObstacle& obstacle) {
        return distanceToOutline(at, obstacle.outline) > kClearance_m;
      });
    }
    if (free) return start;
  }
  throw std::runtime_error(world.name + formatted(": no place drawn has %.1f m of free way ahead", way_m));
}

Pose2 startNearMiddle(const World& world, std::uint64_t seed) {
  RandomEngine random(seed * 7919 + 17);
  return placeWithFreeWay(world, LookAroundWay{}.way_m, [&] {
    return Pose2{uniform(random, -0.6, 0.6), uniform(random, -0.3, 0.3),
                 uniform(random, -std::numbers::pi, std::numbers::pi)};
  });
}

BoardPanel imagePanel(const ExperimentRun& run, std::string title) {
  return {std::move(title), {}, drawAnalysis(run.lastImage()->image, run.analysis(), 2), {}};
}

BoardPanel scorePanel(const ExperimentRun& run, const MemoryScore& score, std::string title) {
  BoardPanel panel;
  panel.title = std::move(title);
  panel.plan = planOfScore(score, rememberedIn(run.snapshot(), run.trueRobot()), run.truth().edges());
  panel.plan->robot = run.trueRobot();
  panel.plan->view = viewOf(run.trueRobot(), run.analysis(), 4.0);
  panel.caption = {
      formatted("%d right, %d on an edge with a wrong end, %d false; %d not confirmed", score.right,
                score.partial, score.wrong, score.unconfirmed),
      formatted("precision %.3f, recall %.3f (of edges of 10 px or more %.3f), %.2f elements per edge",
                score.precision(), score.recall(), score.recallResolved(), score.duplicates())};
  return panel;
}

}  // namespace vismem
