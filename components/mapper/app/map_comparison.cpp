#include "mapper/app/map_comparison.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <tuple>
#include <utility>

#include "common/config/text_file.h"
#include "common/geometry/angles.h"
#include "common/vision/app/image_file.h"
#include "evaluation/core/map_score.h"
#include "evaluation/core/trajectory_io.h"
#include "evaluation/figures/board.h"
#include "mapper/core/change_list.h"
#include "mapper/core/map_history.h"
#include "mapper/core/seen_map.h"

namespace vismem {
namespace {

constexpr double kApart_m = 0.25;  ///< estimates nearer than this are of one place ..
constexpr double kApart_rad = degToRad(4.0);
constexpr double kLead = 1.25;       ///< of the length that both maps share, over any other place's
constexpr double kLeastShare = 0.4;  ///< of the smaller map
constexpr int kChangesPicture_px = 1200;

/// Places of one map in another, each once.
class Places {
 public:
  /// @param middle  of the drive, where places are told apart.
  explicit Places(Eigen::Vector2d middle) : middle_(std::move(middle)) {}

  bool areOne(const Pose2& a, const Pose2& b) const {
    return (transform(a, middle_) - transform(b, middle_)).norm() < kApart_m &&
           std::abs(angleDifference(a.theta, b.theta)) < kApart_rad;
  }
  void add(const Pose2& place) {
    const auto isKnown = [&](const Pose2& known) { return areOne(known, place); };
    if (std::none_of(all_.begin(), all_.end(), isKnown)) all_.push_back(place);
  }
  const std::vector<Pose2>& all() const { return all_; }

 private:
  Eigen::Vector2d middle_;
  std::vector<Pose2> all_;
};

/// Where the races ever placed the frame of the new map in the old one, reliably or not: where much changed,
/// few poses are reliable.
Places placesInOldMap(const RecordedDrive& drive, const SegmentMap& old, const std::vector<Pose2>& poses,
                      std::uint64_t seed) {
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  for (const Pose2& pose : poses) middle += pose.position() / static_cast<double>(poses.size());
  Places places(middle);
  Localizer localizer(drive.params.closing.localizer, old, seed);
  std::size_t k = 0;
  const auto& keyframes = drive.record.keyframes;
  for (const MemoryUpdate& update : drive.updates) {
    const PoseEstimate estimate = localizer.update(update);
    while (k + 1 < keyframes.size() && keyframes[k + 1].stamp_us <= estimate.stamp_us) ++k;
    if (!estimate.T_world_robot || k >= poses.size()) continue;
    const Pose2 T_map_robot = poses[k] * inverse(keyframes[k].T_odom_robot) * estimate.T_odom_robot;
    places.add(*estimate.T_world_robot * inverse(T_map_robot));
  }
  return places;
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

/// Length of the map's edges on edges of the old one [m].
double sharedLength(const SegmentMap& map, const SeenMap& old, const Pose2& T_old_map) {
  constexpr double kStep_m = 0.05;
  double shared_m = 0.0;
  for (const MapSegment& row : map.segments) {
    const SeenEdge edge{transform(T_old_map, row.world.floor()), row.label};
    const int steps = std::max(1, static_cast<int>(std::lround(edge.floor.length() / kStep_m)));
    for (int i = 0; i < steps; ++i) {
      const Eigen::Vector2d p = edge.floor.a + (i + 0.5) / steps * (edge.floor.b - edge.floor.a);
      if (old.liesOn(p, edge)) shared_m += edge.floor.length() / steps;
    }
  }
  return shared_m;
}

double lengthOf(const SegmentMap& map) {
  double length_m = 0.0;
  for (const MapSegment& row : map.segments) length_m += row.world.floor().length();
  return length_m;
}

/// The place where most of both maps lies on each other; empty when another place explains nearly as much.
std::optional<Pose2> commonPlace(const Places& places, const SegmentMap& map, const SegmentMap& old) {
  std::vector<CountedRow> rows;
  for (const MapSegment& row : old.segments) rows.push_back({row});
  const ChangeParams params;
  const std::vector<SeenFloor> none;
  const SeenMap old_edges(rows, none, params);
  Pose2 best;
  double most_m = 0.0;
  std::vector<std::pair<Pose2, double>> found;
  for (const Pose2& start : places.all()) {
    const Pose2 place = aligned(map, old, start);
    found.emplace_back(place, sharedLength(map, old_edges, place));
    if (found.back().second > most_m) std::tie(best, most_m) = found.back();
  }
  const bool is_clear = std::all_of(found.begin(), found.end(), [&](const auto& other) {
    return places.areOne(other.first, best) || kLead * other.second < most_m;
  });
  const double smaller_m = std::min(lengthOf(map), lengthOf(old));
  if (!is_clear || most_m < kLeastShare * smaller_m) return std::nullopt;
  return best;
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

nlohmann::json notFound(const std::filesystem::path& old) {
  return {
      {"problems",
       {"the drive was not found in " + old.string() +
        ": at no place, or at more than one, do enough edges of both maps lie on each other (is it the same "
        "place, mapped with the same palette? --place says where it is)"}}};
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
  const std::optional<Pose2> place =
      options.place ? aligned(now, old, *options.place)
                    : commonPlace(placesInOldMap(drive, old, poses, options.seed), now, old);
  if (!place) return notFound(old_file);
  const Pose2 T_old_map = *place;
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
