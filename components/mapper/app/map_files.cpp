#include "mapper/app/map_files.h"

#include <cmath>
#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "common/geometry/angles.h"
#include "common/vision/app/image_file.h"
#include "evaluation/core/map_score.h"
#include "evaluation/core/trajectory_io.h"
#include "evaluation/figures/board.h"
#include "mapper/app/map_comparison.h"
#include "mapper/core/drive_record_io.h"
#include "mapper/core/map_output.h"

namespace vismem {
namespace {

namespace fs = std::filesystem;

constexpr int kPicture_px = 1200;

/// The rows in the frame of the map, and the poses in it.
struct Output {
  Pose2 T_map_world;
  std::vector<MappedRow> rows;
  std::vector<Pose2> poses;
  SegmentMap map;
};

Output outputOf(const RecordedDrive& drive, const DriveMap& map) {
  Output output;
  const MapOutputParams params;
  output.T_map_world = map.T_map_world;
  output.rows = rowsOf(map.state, output.T_map_world, params);
  addStripeEnds(output.rows, params);
  applyMoves(drive.params.edits, output.rows);
  joinIntoStripes(output.rows, drive.stripes, params);
  output.map = segmentMapOf(output.rows);
  for (const Pose2& pose : map.state.poses) output.poses.push_back(output.T_map_world * pose);
  return output;
}

nlohmann::json rowJson(const MappedRow& row) {
  const auto millimetre = [](double metres) { return std::round(metres * 1e5) / 1e5; };
  return {{"id", row.id},
          {"label", row.row.label},
          {"a_m", {millimetre(row.map.a.x()), millimetre(row.map.a.y())}},
          {"b_m", {millimetre(row.map.b.x()), millimetre(row.map.b.y())}},
          {"width_m", row.row.width_m},
          {"closed", {row.closed_a, row.closed_b}},
          {"across_sigma_m", millimetre(row.across_sigma_m)},
          {"direction_sigma_rad", millimetre(row.direction_sigma_rad)},
          {"end_sigma_m", {millimetre(row.sigma_a_m), millimetre(row.sigma_b_m)}},
          {"times_seen", row.times_seen},
          {"sessions", row.sessions},
          {"derived", row.derived}};
}

nlohmann::json estimatesJson(const DriveMap& map) {
  nlohmann::json json;
  for (const double angle : map.state.camera_tilt) json["camera_tilt_deg"].push_back(radToDeg(angle));
  json["odometry"] = {{"travel_scale", map.state.odometry[0]},
                      {"turn_scale", map.state.odometry[1]},
                      {"turn_degpm", radToDeg(map.state.odometry[2])}};
  return json;
}

void drawPicture(const Output& output, const RecordedDrive& drive, const std::string& source,
                 const DriveMap& map, const fs::path& file) {
  Plan plan;
  Eigen::Vector2d low = output.map.low();
  Eigen::Vector2d high = output.map.high();
  std::map<Label, int> index_of;
  for (const MappedRow& row : output.rows) {
    const int index = index_of.try_emplace(row.row.label, static_cast<int>(index_of.size())).first->second;
    const bool can_be_edited = !row.derived && !row.is_chord;
    plan.lines.push_back({row.row.world.floor(), categoryColor(index), row.row.width_m > 0.0 ? 3.0 : 2.0,
                          false, can_be_edited ? std::to_string(row.id) : ""});
  }
  std::vector<Eigen::Vector2d> path;
  for (const Pose2& pose : output.poses) {
    path.push_back(pose.position());
    low = low.cwiseMin(pose.position());
    high = high.cwiseMax(pose.position());
  }
  plan.paths.push_back(std::move(path));
  const Eigen::Vector2d margin = Eigen::Vector2d::Constant(0.5);
  plan.low = low - margin;
  plan.high = high + margin;
  Board board;
  board.title = "A map from a drive";
  board.subtitle = (drive.truth.empty() ? "" : "the path of the robot is the estimated one; ") + source;
  BoardPanel panel;
  panel.title = std::to_string(output.rows.size()) + " edges, " + std::to_string(map.seen_again) +
                " seen again by a later visit";
  panel.plan = std::move(plan);
  board.rows = {{std::move(panel)}};
  for (const auto& [label, index] : index_of) board.legend.push_back({label, categoryColor(index)});
  writeImageFile(drawBoard(board, kPicture_px), file);
}

/// Distance of the keyframes from the true way after rigid alignment.
nlohmann::json againstTruth(const RecordedDrive& drive, const Output& output) {
  std::vector<Eigen::Vector2d> mapped;
  std::vector<Eigen::Vector2d> truth;
  for (std::size_t k = 0; k < output.poses.size(); ++k) {
    const auto pose = poseAt(drive.truth, drive.record.keyframes[k].stamp_us);
    if (!pose) continue;
    mapped.push_back(output.poses[k].position());
    truth.push_back(pose->position());
  }
  if (mapped.size() < 3) return nullptr;
  const Pose2 T = rigidFit(mapped, truth);
  double sum = 0.0;
  double worst = 0.0;
  for (std::size_t k = 0; k < mapped.size(); ++k) {
    const double off = (transform(T, mapped[k]) - truth[k]).norm();
    sum += off * off;
    worst = std::max(worst, off);
  }
  return {{"path_rms_m", std::sqrt(sum / static_cast<double>(mapped.size()))},
          {"path_worst_m", worst},
          {"T_world_map", {T.x, T.y, T.theta}}};
}

/// What the user must know of places that stand twice in the map.
std::string twiceNote(const EdgesTwice& twice, const Pose2& T_map_world) {
  const Eigen::Vector2d at = transform(T_map_world, twice.world);
  char text[200];
  std::snprintf(
      text, sizeof text,
      "%d edges stand twice, up to %.2f m apart, the worst at x %.1f, y %.1f m: two visits of this place "
      "were not joined; drive round it once more",
      twice.edges, twice.across_m, at.x(), at.y());
  return text;
}

nlohmann::json summaryOf(const RecordedDrive& drive, const DriveMap& map, const Output& output) {
  nlohmann::json json{{"keyframes", drive.record.keyframes.size()},
                      {"way_m", drive.record.keyframes.empty() ? 0.0 : drive.record.keyframes.back().way_m},
                      {"landmarks", map.state.landmarks.size()},
                      {"merged", map.merged},
                      {"circles", map.circles},
                      {"segments", output.rows.size()},
                      {"closings", map.closings.size()},
                      {"seen_again", map.seen_again},
                      {"refused_closings", map.refused.size()},
                      {"solver_s", map.seconds}};
  json.update(estimatesJson(map));
  std::map<Label, int> labels;
  for (const MappedRow& row : output.rows) ++labels[row.row.label];
  json["labels"] = labels;
  if (!drive.truth.empty()) json["truth"] = againstTruth(drive, output);
  json["notes"] = map.notes;
  if (map.twice) json["notes"].push_back(twiceNote(*map.twice, output.T_map_world));
  constexpr int kLeastSeenAgain = 3;
  if (map.closings.empty() && map.seen_again < kLeastSeenAgain) {
    json["notes"].push_back(
        "no place was found again: drive on until the robot has seen its start from the same side for 3 m, "
        "or the map keeps the drift of one way");
  }
  return json;
}

void writeTrajectory(const RecordedDrive& drive, const Output& output, const fs::path& file) {
  std::ostringstream tum;
  tum << kTumHeader;
  for (std::size_t k = 0; k < output.poses.size(); ++k) {
    writeTumRow({drive.record.keyframes[k].stamp_us, output.poses[k]}, tum);
  }
  writeTextFile(file, tum.str());
}

MapHistory historyOf(const RecordedDrive& drive, const DriveMap& map, const Output& output) {
  MapHistory history;
  history.seen.sessions.push_back(seenBy(drive.record, output.poses, map.state.overruled));
  for (const MappedRow& row : output.rows) {
    if (row.row.world.length() > 0.0) history.rows.push_back({row.row, row.times_seen, row.sessions});
  }
  return history;
}

}  // namespace

void writeDrawings(const SegmentMap& map, const fs::path& palette, const fs::path& out,
                   const std::string& name) {
  fs::create_directories(out);
  const auto file = [&](const char* ending) { return out / (name + ending); };
  saveSegmentMap(map, file(".csv"));
  if (!fs::exists(file(".palette")) || !fs::equivalent(palette, file(".palette")))
    fs::copy_file(palette, file(".palette"), fs::copy_options::overwrite_existing);
  writeTextFile(file(".svg"), svgOf(map));
  writeTextFile(file(".dxf"), dxfOf(map));
}

nlohmann::json writeMapFiles(const RecordedDrive& drive, const DriveMap& map,
                             const MapFilesOptions& options) {
  const fs::path& out = options.out;
  fs::create_directories(out);
  const Output output = outputOf(drive, map);
  nlohmann::json summary = summaryOf(drive, map, output);
  if (drive.broken) summary["problems"].push_back("the odometry jumped: the map ends there");
  if (!map.problem.empty()) summary["problems"].push_back(map.problem);
  if (output.map.segments.empty()) {
    summary["problems"].push_back("no labelled edge on the floor was confirmed: no map");
    return summary;
  }
  const auto file = [&](const char* ending) { return out / (options.name + ending); };
  writeDrawings(output.map, drive.palette_file, out, options.name);
  GridParams grid_params;
  grid_params.resolution_m = options.resolution_m;
  grid_params.obstacles = drive.params.closing.localizer.map.opaque_labels;
  const GridImage grid = gridOf(output.map, drive.record, output.poses, grid_params);
  writeTextFile(file(".pgm"), pgmOf(grid));
  writeTextFile(file(".yaml"), gridYamlOf(grid, options.name + ".pgm"));
  writeTrajectory(drive, output, out / "trajectory.tum");
  nlohmann::json segments{{"segments", nlohmann::json::array()}};
  segments.update(estimatesJson(map));
  for (const MappedRow& row : output.rows) segments["segments"].push_back(rowJson(row));
  writeTextFile(file(".json"), segments.dump(1) + "\n");
  writeTextFile(file(".drive"), writeDriveRecord({drive.record, map.closings}));
  const MapHistory history = historyOf(drive, map, output);
  writeTextFile(file(".history"), writeMapHistory(history));
  drawPicture(output, drive, options.source, map, file(".png"));
  summary["file"] = file(".csv").string();
  if (!options.since.empty()) {
    nlohmann::json compared = compareWithMap(drive, output.map, history, output.poses, options);
    for (auto& problem : compared["problems"]) summary["problems"].push_back(problem);
    compared.erase("problems");
    summary.update(compared);
  }
  return summary;
}

}  // namespace vismem
