/// @file A map from a recording or a simulated drive: the drive in lock-step, the graph, all files. See B6.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>

#include "evaluation/app/evaluation.h"
#include "evaluation/core/trajectory.h"
#include "mapper/core/drive_mapper.h"

namespace vismem {

struct MapMakingOptions {
  /// Robot, configuration, palette and folder; its map stays empty.
  EvaluationOptions drive;
  double laps = 1.0;       ///< of a world's route, without `drive.seconds`
  double overlap_m = 4.0;  ///< driven on after them
  bool close = true;
  bool right_angles = true;
  double resolution_m = 0.05;         ///< of the occupancy grid
  std::filesystem::path edits;        ///< of a person (map_edits.h); empty: none
  std::filesystem::path saved_drive;  ///< NAME.drive of an earlier map, in place of a drive; empty: none
  std::filesystem::path since;        ///< an earlier map of the place, to list what changed; empty: none
  std::optional<Pose2> place;         ///< of the drive's map in it, within 1 m; empty: found by localization
  std::string name = "map";           ///< of the files
};

/// A drive through the memory.
struct RecordedDrive {
  DriveRecord record;
  std::vector<MemoryUpdate> updates;
  std::vector<Closing> closings;  ///< of a saved drive
  Trajectory truth;               ///< empty: not known
  std::filesystem::path palette_file;
  std::map<Label, Label> stripes;  ///< of the palette
  DriveMapperParams params;        ///< by the configuration
  bool broken = false;             ///< the odometry jumped: the record ends there
};

/// @throws ConfigError, RecordingError, std::runtime_error naming the wrong input.
RecordedDrive recordDrive(const MapMakingOptions& options);

/// Drives, maps and writes NAME.csv, .palette, .svg, .dxf, .pgm, .yaml, .json, .drive,
/// .history, .png and trajectory.tum.
/// @return the summary; a list `problems` in it says why there is no usable map.
nlohmann::json makeMapFromDrive(const MapMakingOptions& options);

}  // namespace vismem
