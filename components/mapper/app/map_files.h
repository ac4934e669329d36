/// @file The files of a map made from a drive. See B6.
#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "evaluation/core/trajectory.h"
#include "mapper/core/drive_mapper.h"

namespace vismem {

/// A drive through the memory.
struct RecordedDrive {
  DriveRecord record;
  std::vector<MemoryUpdate> updates;
  std::vector<Closing> closings;  ///< of a saved drive
  Trajectory truth;               ///< empty: not known
  std::filesystem::path palette_file;
  std::vector<Label> labels;       ///< of edges, by the palette
  std::map<Label, Label> stripes;  ///< of the palette
  DriveMapperParams params;        ///< by the configuration
  bool broken = false;             ///< the odometry jumped: the record ends there
};

struct MapFilesOptions {
  std::filesystem::path out;  ///< folder
  std::string name = "map";
  double resolution_m = 0.05;   ///< of the occupancy grid
  std::filesystem::path since;  ///< an earlier map of the place, to list what changed; empty: none
  std::optional<Pose2> place;   ///< of the drive's map in it, within 1 m; empty: found by localization
  std::uint64_t seed = 1;       ///< of that localization
  std::string source;           ///< of the drive, for people
};

/// Writes NAME.csv, .palette, .svg and .dxf into a folder, which is created.
/// @throws std::runtime_error naming a file that cannot be written.
void writeDrawings(const SegmentMap& map, const std::filesystem::path& palette,
                   const std::filesystem::path& out, const std::string& name);

/// Writes NAME.csv, .palette, .svg, .dxf, .pgm, .yaml, .json, .drive, .history, .png and trajectory.tum into
/// the options' folder, which is created.
/// @return the summary; a list `problems` in it says why there is no usable map.
/// @throws std::runtime_error naming a file that cannot be written.
nlohmann::json writeMapFiles(const RecordedDrive& drive, const DriveMap& map, const MapFilesOptions& options);

}  // namespace vismem
