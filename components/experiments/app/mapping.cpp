#include "experiments/app/mapping.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "common/config/project_file.h"
#include "common/config/text_format.h"
#include "common/geometry/angles.h"
#include "common/routes/route_follower.h"
#include "common/segment_map/symmetry.h"
#include "common/vision/app/image_file.h"
#include "evaluation/core/map_score.h"
#include "evaluation/figures/board.h"
#include "experiments/app/experiment_run.h"
#include "experiments/app/look_around_run.h"
#include "experiments/app/score_json.h"
#include "experiments/app/trial_report.h"
#include "experiments/app/trial_run.h"
#include "experiments/app/trial_series.h"
#include "experiments/trials/trial_score.h"
#include "mapper/core/drive_collector.h"
#include "mapper/core/drive_mapper.h"
#include "mapper/core/map_output.h"

namespace vismem {
namespace {

constexpr int kPanel_px = 1040;
constexpr double kOverlap_m = 3.5;  ///< driven on after one lap
constexpr double kSlowest_mps = 0.05;

struct Variant {
  const char* name;
  const char* world;
  const char* setup;
  double laps;
};

constexpr Variant kVariants[] = {
    {"corridor", "corridor", "sim", 1.0},
    {"corridor_irregular", "corridor_irregular", "sim", 1.0},
    {"room", "room", "sim", 1.0},
    {"corridor_humanoid", "corridor", "humanoid", 1.0},
    {"field", "field_6x4", "sim", 1.0},
    {"field_humanoid", "field_6x4", "humanoid", 1.0},
    {"alike_wings", "alike_wings", "sim", 1.0},
};

/// The drive with the true places of its keyframes.
struct Drive {
  DriveRecord record;
  std::vector<MemoryUpdate> updates;
  std::vector<Pose2> truth;  ///< of the keyframes
};

Drive driveLaps(ExperimentRun& run, const Route& route, double laps) {
  DriveCollector collected(KeyframeParams::of(run.params().pipeline.memory),
                           run.params().localizer.robust.observation.range_m);
  Drive drive;
  run.onFrame([&](const LockstepFrame& frame) {
    if (collected.add(frame.observation.frame, frame.memory.update,
                      valuesOf(run.pipeline().memory().elements())))
      drive.truth.push_back(run.trueRobot());
  });
  SimulatedOperator driver(route, RouteFollowerParams{});
  const double length_m = laps * route.length() + kOverlap_m;
  double way_m = 0.0;
  Eigen::Vector2d last = run.simulation().truth().T_world_robot.position();
  const auto done = [&] {
    const Eigen::Vector2d now = run.simulation().truth().T_world_robot.position();
    way_m += (now - last).norm();
    last = now;
    return way_m >= length_m;
  };
  const auto command = [&](MobileBase& base) {
    const DriveCommand c = driver.drive(run.simulation().truth().T_world_robot);
    base.setVelocity(c.v_mps, c.w_radps);
  };
  if (!run.run(command, done, length_m / kSlowest_mps)) {
    throw std::runtime_error("the robot did not get round: something holds it");
  }
  drive.record = collected.record();
  drive.updates = collected.updates();
  return drive;
}

/// Closings that join places further apart than this are false: no race errs so far about its own place.
constexpr double kFalseClosing_m = 0.5;

nlohmann::json closingsJson(const DriveMap& map, const std::vector<Pose2>& truth) {
  const auto isFalse = [&](const Closing& closing) {
    const Pose2 T_from_to =
        inverse(truth[static_cast<std::size_t>(closing.from)]) * truth[static_cast<std::size_t>(closing.to)];
    return (closing.T_from_to.position() - T_from_to.position()).norm() > kFalseClosing_m;
  };
  return {{"closings", map.closings.size()},
          {"false_closings", std::count_if(map.closings.begin(), map.closings.end(), isFalse)},
          {"refused_closings", map.refused.size()},
          {"refused_false_closings", std::count_if(map.refused.begin(), map.refused.end(), isFalse)}};
}

nlohmann::json toJson(const MapScore& score, const DriveMap& map, const Drive& drive) {
  nlohmann::json json = toJson(score.edges);
  json["ends_rms_m"] = score.ends_rms_m;
  json["ends_worst_m"] = score.ends_worst_m;
  json["ends"] = score.ends;
  json["across_rms_m"] = score.across_rms_m;
  json["worst_piece_rms_m"] = score.worst_piece_rms_m;
  json["scale"] = score.scale;
  json["keyframes"] = drive.record.keyframes.size();
  json["landmarks"] = map.state.landmarks.size();
  json["merged"] = map.merged;
  json["dropped"] = map.dropped;
  json["cut"] = map.cut;
  json["circles"] = map.circles;
  json["edges_twice"] = map.twice ? map.twice->edges : 0;
  json.update(closingsJson(map, drive.truth));
  for (const ClosingEvidence& search : map.searches) {
    json["searches"].push_back({{"way_m", search.way_m},
                                {"map_m", search.map_m},
                                {"closings", search.closings},
                                {"lead_nats", search.best_lead_nats},
                                {"explained", search.best_explained},
                                {"lead_s", search.longest_lead_s}});
  }
  json["solver_s"] = map.seconds;
  json["problem"] = map.problem;
  json["notes"] = map.notes;
  for (int i = 0; i < 4; ++i) json["camera_tilt_deg"].push_back(radToDeg(map.state.camera_tilt[i]));
  for (int i = 0; i < 3; ++i) json["odometry_errors"].push_back(map.state.odometry[i]);
  return json;
}

/// Explorers are drawn: which place they find first decides over seconds. A run of the robot costs ten times
/// as much as its localization.
constexpr std::uint64_t kRacesOfATrial = 8;
constexpr std::uint64_t kRaceSeedsApart = 7919;

/// E6 with the own map beside the true one, on the same observations.
nlohmann::json useOf(const SegmentMap& own, const Variant& variant, const ExperimentOptions& options) {
  std::vector<EventScore> with_own;
  std::vector<EventScore> with_true;
  for (int i = 1; i <= options.trials; ++i) {
    TrialOptions trial_options;
    trial_options.world = variant.world;
    trial_options.setup = variant.setup;
    trial_options.seed = kSeedsApart * options.seed + static_cast<std::uint64_t>(i);
    TrialRun run(trial_options);
    const Trial trial = run.record();
    ScoreParams params;
    params.symmetries = symmetriesOf(run.params().map);
    const auto localize = [&](const SegmentMap& map, std::vector<EventScore>& scores) {
      for (std::uint64_t races = 0; races < kRacesOfATrial; ++races) {
        Localizer localizer(run.params().localizer, map, trial_options.seed + kRaceSeedsApart * races);
        std::vector<PoseEstimate> estimates;
        for (const MemoryUpdate& update : trial.updates) estimates.push_back(localizer.update(update));
        const auto events = scoreEvents(trial, estimates, params);
        scores.insert(scores.end(), events.begin(), events.end());
      }
    };
    localize(own, with_own);
    localize(run.params().map_edges, with_true);
  }
  return {{"own_map", toJson(summarize(with_own))}, {"true_map", toJson(summarize(with_true))}};
}

nlohmann::json runVariant(const Variant& variant, const ExperimentOptions& options, JudgementFiles& files) {
  ExperimentRunOptions run_options;
  run_options.world = variant.world;
  run_options.setup = variant.setup;
  run_options.mode = options.mode;
  run_options.seed = options.seed;
  Route route = loadRoute(projectFile(std::string("cfg/worlds/") + variant.world + ".route"));
  const RouteStart start = startOnRoute(route, options.seed);
  run_options.start = start.T_world_robot;
  if (start.backwards) route = reversed(route);
  ExperimentRun run(run_options);
  const Drive drive = driveLaps(run, route, variant.laps);
  const DriveMap map = mapDrive(drive.record, drive.updates,
                                DriveMapperParams::of(run.params().pipeline.memory, run.params().localizer));
  std::vector<MappedRow> rows = rowsOf(map.state, Pose2{}, {});
  addStripeEnds(rows, {});
  std::vector<MappedEdge> edges;
  for (const MappedRow& row : rows) edges.push_back({row.map, row.row.label, row.closed_a, row.closed_b});
  const auto positions = [](const std::vector<Pose2>& poses) {
    std::vector<Eigen::Vector2d> found;
    for (const Pose2& pose : poses) found.push_back(pose.position());
    return found;
  };
  MapScoreParams params;
  params.memory.focal_px = drive.record.keyframes.front().intrinsics.fx;
  const Pose2 T_world_map = rigidFit(positions(map.state.poses), positions(drive.truth));
  const MapScore score = scoreMap(edges, run.truth().edges(), T_world_map, params);
  std::vector<RememberedEdge> remembered;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    remembered.push_back({i + 1, transform(score.T_world_map, edges[i].map), edges[i].label, true});
  }
  files.add(variant.name, "drive", score.edges, remembered, run.truth().edges());
  BoardPanel panel;
  panel.title = formatted("the map over the true edges: ends RMS %.1f cm", 100.0 * score.ends_rms_m);
  panel.plan = planOfScore(score.edges, remembered, run.truth().edges());
  panel.caption = {formatted("%d right, %d on an edge with a wrong end, %d false", score.edges.right,
                             score.edges.partial, score.edges.wrong),
                   formatted("precision %.3f, recall of edges of 10 px or more %.3f", score.edges.precision(),
                             score.edges.recallResolved())};
  Board board{std::string("A map from one drive: ") + variant.name,
              "seed " + std::to_string(options.seed),
              {{std::move(panel)}},
              legendOfScore()};
  writeImageFile(drawBoard(board, kPanel_px), options.out / (std::string("map_") + variant.name + ".png"));
  nlohmann::json json = toJson(score, map, drive);
  if (options.trials > 0) {
    for (MappedRow& row : rows) row.row.world = transform(score.T_world_map, row.row.world);
    json["use"] = useOf(segmentMapOf(rows), variant, options);
  }
  return json;
}

}  // namespace

nlohmann::json mapping(const ExperimentOptions& options) {
  JudgementFiles files(options.out);
  nlohmann::json json;
  for (const Variant& variant : kVariants) {
    if (options.wants(variant.name)) json[variant.name] = runVariant(variant, options, files);
  }
  files.close();
  return json;
}

}  // namespace vismem
