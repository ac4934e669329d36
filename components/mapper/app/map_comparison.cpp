#include "mapper/app/map_comparison.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "common/config/text_file.h"
#include "common/geometry/angles.h"
#include "common/vision/app/image_file.h"
#include "evaluation/core/map_score.h"
#include "evaluation/core/trajectory_io.h"
#include "evaluation/figures/board.h"
#include "mapper/core/change_list.h"
#include "mapper/core/map_history.h"

namespace vismem {
namespace {

constexpr double kReliability = 0.6;
constexpr double kAgree_m = 0.25;
constexpr double kAgree_rad = degToRad(4.0);
constexpr std::size_t kLeastEstimates = 10;
constexpr int kChangesPicture_px = 1200;

/// Where the races placed the frame of the new map in the old one, at every reliable estimate.
std::vector<Pose2> placesInOldMap(const RecordedDrive& drive, const SegmentMap& old,
                                  const std::vector<Pose2>& poses, std::uint64_t seed) {
  Localizer localizer(drive.params.closing.localizer, old, seed);
  std::vector<Pose2> places;
  std::size_t k = 0;
  const auto& keyframes = drive.record.keyframes;
  for (const MemoryUpdate& update : drive.updates) {
    const PoseEstimate estimate = localizer.update(update);
    while (k + 1 < keyframes.size() && keyframes[k + 1].stamp_us <= estimate.stamp_us) ++k;
    if (!estimate.T_world_robot || estimate.reliability < kReliability || k >= poses.size()) continue;
    const Pose2 T_map_robot = poses[k] * inverse(keyframes[k].T_odom_robot) * estimate.T_odom_robot;
    places.push_back(*estimate.T_world_robot * inverse(T_map_robot));
  }
  return places;
}

/// The place that most others agree with; empty when fewer than half do. Early races may have been wrong.
std::optional<Pose2> agreedPlace(const std::vector<Pose2>& places, const Eigen::Vector2d& middle) {
  const Pose2* best = nullptr;
  std::size_t most = 0;
  for (const Pose2& place : places) {
    const auto agree =
        static_cast<std::size_t>(std::count_if(places.begin(), places.end(), [&](const Pose2& other) {
          return (transform(place, middle) - transform(other, middle)).norm() < kAgree_m &&
                 std::abs(angleDifference(place.theta, other.theta)) < kAgree_rad;
        }));
    if (agree > most) best = &place, most = agree;
  }
  if (!best || most < kLeastEstimates || 2 * most < places.size()) return std::nullopt;
  return *best;
}

Pose2 aligned(const SegmentMap& map, const SegmentMap& old, const Pose2& start) {
  std::vector<MappedEdge> edges;
  for (const MapSegment& row : map.segments) edges.push_back({row.world.floor(), row.label, false, false});
  std::vector<TrueEdge> truth;
  for (const MapSegment& row : old.segments) {
    TrueEdge edge;
    edge.label = row.label;
    edge.pieces = {row.world.floor()};
    truth.push_back(std::move(edge));
  }
  return alignToTruth(edges, truth, start);
}

nlohmann::json jsonOf(const MapChange& change) {
  const auto edges = [](const std::vector<Segment2>& segments) {
    nlohmann::json json = nlohmann::json::array();
    for (const Segment2& one : segments) json.push_back({one.a.x(), one.a.y(), one.b.x(), one.b.y()});
    return json;
  };
  nlohmann::json json{{"kind", nameOf(change.kind)},
                      {"label", change.label},
                      {"before", edges(change.before)},
                      {"now", edges(change.now)}};
  if (!change.before.empty()) json["from_m"] = {placeOf(change.before).x(), placeOf(change.before).y()};
  if (!change.now.empty()) json["to_m"] = {placeOf(change.now).x(), placeOf(change.now).y()};
  return json;
}

void drawChanges(const MapComparison& found, const SegmentMap& map, const std::filesystem::path& file) {
  const Rgb unchanged{150, 150, 150};
  const Rgb gone{200, 40, 40};
  const Rgb came{30, 140, 60};
  const Rgb added{40, 90, 200};
  Plan plan;
  for (const MapSegment& row : map.segments) plan.lines.push_back({row.world.floor(), unchanged, 1.5, false});
  for (const MapSegment& row : found.added) plan.lines.push_back({row.world.floor(), added, 3.0, false});
  for (const MapChange& change : found.changes) {
    for (const Segment2& edge : change.before) plan.lines.push_back({edge, gone, 3.0, true});
    for (const Segment2& edge : change.now) plan.lines.push_back({edge, came, 3.0, false});
    if (change.kind == MapChange::Kind::kMoved)
      plan.paths.push_back({placeOf(change.before), placeOf(change.now)});
  }
  const Eigen::Vector2d margin = Eigen::Vector2d::Constant(0.5);
  plan.low = map.low() - margin;
  plan.high = map.high() + margin;
  for (const PlanLine& line : plan.lines) {
    plan.low = plan.low.cwiseMin(line.world.a - margin);
    plan.high = plan.high.cwiseMax(line.world.a + margin);
  }
  Board board;
  board.title = "What changed since the last map";
  board.subtitle = std::to_string(found.changes.size()) + " changes";
  BoardPanel panel;
  panel.plan = std::move(plan);
  board.rows = {{std::move(panel)}};
  board.legend = {{"as before", unchanged},
                  {"was here", gone},
                  {"is here now", came},
                  {"seen for the first time", added}};
  writeImageFile(drawBoard(board, kChangesPicture_px), file);
}

nlohmann::json notFound(const std::filesystem::path& old, std::size_t places) {
  return {{"problems",
           {"the drive was not found in " + old.string() + ": of " + std::to_string(places) +
            " reliable poses fewer than half agree (is it the same place, mapped with the same palette? "
            "--place says where it is)"}}};
}

}  // namespace

MapHistory historyBeside(const std::filesystem::path& map) {
  const std::filesystem::path file = std::filesystem::path(map).replace_extension(".history");
  if (!std::filesystem::exists(file)) return {.seen = {{}, true}, .rows = {}, .rejected = {}};
  return parseMapHistory(readTextFile(file, "the history of a map"), file.string());
}

nlohmann::json compareWithMap(const RecordedDrive& drive, const SegmentMap& map, const MapHistory& today,
                              const std::vector<Pose2>& poses, const MapFilesOptions& options) {
  const std::filesystem::path& old_file = options.since;
  const SegmentMap rows = loadSegmentMap(old_file);
  const SegmentMap old = expandStripes(rows, drive.stripes);
  const SegmentMap now = expandStripes(map, drive.stripes);
  const MapHistory history = historyBeside(old_file);
  std::optional<Pose2> start = options.place;
  if (!start) {
    Eigen::Vector2d middle = Eigen::Vector2d::Zero();
    for (const Pose2& pose : poses) middle += pose.position() / static_cast<double>(poses.size());
    const std::vector<Pose2> places = placesInOldMap(drive, old, poses, options.seed);
    start = agreedPlace(places, middle);
    if (!start) return notFound(old_file, places.size());
  }
  const Pose2 T_old_map = aligned(now, old, *start);
  ChangeParams params;
  params.opaque_labels = drive.params.closing.localizer.map.opaque_labels;
  const SegmentMap in_old = transform(T_old_map, now);
  const MapHistory seen = transform(T_old_map, today);
  const MapComparison found = compareMaps(expandStripes(countedRows(rows, history), drive.stripes),
                                          history.seen, expandStripes(seen.rows, drive.stripes),
                                          seen.seen.sessions.front(), params, history.rejected);
  nlohmann::json json{{"changes", nlohmann::json::array()},
                      {"added", found.added.size()},
                      {"T_old_map", {T_old_map.x, T_old_map.y, T_old_map.theta}}};
  for (const MapChange& change : found.changes) json["changes"].push_back(jsonOf(change));
  writeTextFile(options.out / (options.name + ".changes"),
                writeChangeList(changeListOf(found, T_old_map, rows)));
  drawChanges(found, in_old, options.out / (options.name + "_changes.png"));
  return json;
}

}  // namespace vismem
