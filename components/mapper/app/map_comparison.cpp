#include "mapper/app/map_comparison.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>

#include "common/config/text_file.h"
#include "common/geometry/angles.h"
#include "common/vision/app/image_file.h"
#include "evaluation/core/map_score.h"
#include "evaluation/core/trajectory_io.h"
#include "evaluation/figures/board.h"
#include "mapper/core/drive_record_io.h"

namespace vismem {
namespace {

constexpr double kReliability = 0.6;
constexpr double kAgree_m = 0.25;
constexpr double kAgree_rad = degToRad(4.0);
constexpr std::size_t kLeastEstimates = 10;
constexpr int kLeastSightings = 3;  // of a trace
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

SegmentMap moved(SegmentMap map, const Pose2& T) {
  for (MapSegment& row : map.segments) {
    for (Eigen::Vector3d* end : {&row.world.a, &row.world.b})
      end->head<2>() = transform(T, Eigen::Vector2d(end->head<2>()));
  }
  return map;
}

SeenFloor seenBy(const DriveRecord& record, const std::vector<Pose2>& poses, const Pose2& T_map_poses) {
  SeenFloor seen;
  for (std::size_t k = 0; k < poses.size() && k < record.keyframes.size(); ++k) {
    const Keyframe& keyframe = record.keyframes[k];
    const Pose3 T_map_camera = toPose3(T_map_poses * poses[k]) * keyframe.T_robot_camera;
    seen.views.push_back(
        {T_map_camera.translation().head<2>(), CameraView(keyframe.intrinsics, T_map_camera)});
  }
  for (const auto& [id, element] : record.elements) {
    const auto last = static_cast<std::size_t>(element.last_keyframe);
    if (element.sightings >= kLeastSightings && last < poses.size())
      seen.traces.push_back(transform(T_map_poses * poses[last], element.robot));
  }
  return seen;
}

/// By the drive that made a map, if its record lies beside it.
SeenFloor seenBefore(const std::filesystem::path& map, const DriveMapperParams& params) {
  const std::filesystem::path file = std::filesystem::path(map).replace_extension(".drive");
  if (!std::filesystem::exists(file)) return {};
  const SavedDrive saved = parseDriveRecord(readTextFile(file, "the record of a drive"), file.string());
  const MapState state = mapDriveAgain(saved.record, saved.closings, params).state;
  return seenBy(saved.record, state.poses, mapFrameOf(state));
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

/// "moved box_foot from 1.20 -0.40 to 1.55 -0.30".
std::string lineOf(const MapChange& change) {
  std::ostringstream line;
  line << std::fixed << std::setprecision(2) << nameOf(change.kind) << " " << change.label;
  const auto place = [&](const char* word, const std::vector<Segment2>& edges) {
    if (!edges.empty()) line << " " << word << " " << placeOf(edges).x() << " " << placeOf(edges).y();
  };
  place("from", change.before);
  place("to", change.now);
  return line.str();
}

void drawChanges(const std::vector<MapChange>& changes, const SegmentMap& map,
                 const std::filesystem::path& file) {
  const Rgb unchanged{150, 150, 150};
  const Rgb gone{200, 40, 40};
  const Rgb came{30, 140, 60};
  Plan plan;
  for (const MapSegment& row : map.segments) plan.lines.push_back({row.world.floor(), unchanged, 1.5, false});
  for (const MapChange& change : changes) {
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
  board.subtitle = std::to_string(changes.size()) + " changes";
  BoardPanel panel;
  panel.plan = std::move(plan);
  board.rows = {{std::move(panel)}};
  board.legend = {{"as before", unchanged}, {"was here", gone}, {"is here now", came}};
  writeImageFile(drawBoard(board, kChangesPicture_px), file);
}

}  // namespace

nlohmann::json compareWithMap(const RecordedDrive& drive, const SegmentMap& map,
                              const std::vector<Pose2>& poses, const std::filesystem::path& old_file,
                              const MapMakingOptions& options) {
  const SegmentMap old = expandStripes(loadSegmentMap(old_file), drive.stripes);
  const SegmentMap now = expandStripes(map, drive.stripes);
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  for (const Pose2& pose : poses) middle += pose.position() / static_cast<double>(poses.size());
  const std::vector<Pose2> places = placesInOldMap(drive, old, poses, options.drive.seed);
  const auto start = agreedPlace(places, middle);
  if (!start) {
    return {
        {"problems",
         {"the drive was not found in " + old_file.string() + ": of " + std::to_string(places.size()) +
          " reliable poses fewer than half agree (is it the same place, mapped with the same palette?)"}}};
  }
  const Pose2 T_old_map = aligned(now, old, *start);
  ChangeParams params;
  params.opaque_labels = drive.params.closing.localizer.map.opaque_labels;
  const SegmentMap in_old = moved(now, T_old_map);
  const std::vector<MapChange> changes = mapChanges(old, seenBefore(old_file, drive.params), in_old,
                                                    seenBy(drive.record, poses, T_old_map), params);
  nlohmann::json json{{"changes", nlohmann::json::array()},
                      {"T_old_map", {T_old_map.x, T_old_map.y, T_old_map.theta}}};
  std::string lines;
  for (const MapChange& change : changes) {
    json["changes"].push_back(jsonOf(change));
    lines += lineOf(change) + "\n";
  }
  writeTextFile(options.drive.out / (options.name + ".changes"), lines);
  drawChanges(changes, in_old, options.drive.out / (options.name + "_changes.png"));
  return json;
}

}  // namespace vismem
