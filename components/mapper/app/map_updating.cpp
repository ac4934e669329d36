#include "mapper/app/map_updating.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "common/config/config_error.h"
#include "common/config/text_file.h"
#include "common/vision/palette.h"
#include "evaluation/core/trajectory_io.h"
#include "mapper/app/map_comparison.h"
#include "mapper/app/map_files.h"
#include "mapper/core/change_list.h"
#include "mapper/core/map_update.h"

namespace vismem {
namespace {

namespace fs = std::filesystem;

nlohmann::json jsonOf(const CountedRow& row) {
  const Segment2 floor = row.row.world.floor();
  return {
      {"label", row.row.label},     {"a_m", {floor.a.x(), floor.a.y()}}, {"b_m", {floor.b.x(), floor.b.y()}},
      {"width_m", row.row.width_m}, {"times_seen", row.times_seen},      {"sessions", row.sessions}};
}

MapHistory historyOfDrive(const fs::path& changes) {
  const fs::path file = fs::path(changes).replace_extension(".history");
  return parseMapHistory(readTextFile(file, "the history of the drive, beside its changes"), file.string());
}

int count(const ChangeList& list, Decision decision) {
  return static_cast<int>(
      std::count_if(list.changes.begin(), list.changes.end(),
                    [&](const ListedChange& listed) { return listed.decision == decision; }));
}

}  // namespace

nlohmann::json updateMapFiles(const MapUpdateOptions& options) {
  const fs::path palette_file = fs::path(options.map).replace_extension(".palette");
  MapHistory old = historyBeside(options.map);
  const SegmentMap rows = loadSegmentMap(options.map);
  old.rows = countedRows(rows, old);
  ChangeList list =
      parseChangeList(readTextFile(options.changes, "a list of changes"), options.changes.string());
  if (list.map && *list.map != checksumOf(rows)) {
    throw ConfigError(
        {options.changes.string() + ": is about other rows than those of " + options.map.string() +
         " (must be what map_from_drive --since found against this map; it takes a list once)"});
  }
  decide(list, options.accept, options.reject);
  const Palette palette = loadPalette(palette_file);
  const UpdatedMap updated = updateMap(old, palette.stripes(), list, historyOfDrive(options.changes));
  const SegmentMap map = updated.map();
  if (map.segments.empty())
    throw ConfigError({options.changes.string() + ": no row would be left (must be 1 or more)"});
  writeDrawings(map, palette_file, options.out, options.name);
  const auto file = [&](const char* ending) { return options.out / (options.name + ending); };
  nlohmann::json segments{{"segments", nlohmann::json::array()}};
  for (const CountedRow& row : updated.history.rows) segments["segments"].push_back(jsonOf(row));
  writeTextFile(file(".json"), segments.dump(1) + "\n");
  writeTextFile(file(".history"), writeMapHistory(updated.history));
  return {{"file", file(".csv").string()},
          {"accepted", count(list, Decision::kAccept)},
          {"rejected", count(list, Decision::kReject)},
          {"open", count(list, Decision::kOpen)},
          {"sessions", updated.history.seen.sessions.size()},
          {"rows",
           {{"kept", updated.kept},
            {"cut", updated.cut},
            {"gone", updated.gone},
            {"came", updated.came},
            {"added", updated.added},
            {"seen_again", updated.seen_again}}}};
}

}  // namespace vismem
