/// @file A drive's map beside the map of an earlier one. See B6.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "mapper/app/map_making.h"
#include "mapper/core/map_changes.h"

namespace vismem {

/// Finds the drive in the old map by localization, from an unknown start, and aligns both maps.
/// Writes NAME.changes (a line for each change) and NAME_changes.png.
/// @param map    of the drive.
/// @param poses  T_map_robot of its keyframes.
/// @param old    file of the old map; its labels are those of the drive's palette.
/// @return {"changes": [...]}, with a list `problems` when the drive was not found in the old map.
/// @throws ConfigError for a map that cannot be used.
nlohmann::json compareWithMap(const RecordedDrive& drive, const SegmentMap& map,
                              const std::vector<Pose2>& poses, const std::filesystem::path& old,
                              const MapMakingOptions& options);

}  // namespace vismem
