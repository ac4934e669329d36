/// @file A drive's map beside the map of an earlier one. See B6.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "mapper/app/map_files.h"
#include "mapper/core/map_history.h"

namespace vismem {

/// Finds the drive in the old map by localization, from an unknown start, and aligns both maps.
/// Writes NAME.changes (change_list.h, all open) and NAME_changes.png. The old map's history is read from
/// beside it.
/// @param map    of the drive.
/// @param today  its history: one session.
/// @param poses  T_map_robot of its keyframes.
/// @param options  `since` is the old map; its labels are those of the drive's palette.
/// @return {"changes": [...], "added": rows, "T_old_map": [...]}, with a list `problems` when the drive was
/// not found in the old map.
/// @throws ConfigError for a map that cannot be used.
nlohmann::json compareWithMap(const RecordedDrive& drive, const SegmentMap& map, const MapHistory& today,
                              const std::vector<Pose2>& poses, const MapFilesOptions& options);

/// What lies beside a map as NAME.history; without it the map is complete: all of the place counts as seen.
/// @throws ConfigError for one that cannot be used.
MapHistory historyBeside(const std::filesystem::path& map);

}  // namespace vismem
