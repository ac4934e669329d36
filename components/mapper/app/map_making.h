/// @file A map from a recording or a simulated drive: the drive in lock-step, the graph, all files. See B6.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

#include "evaluation/app/evaluation.h"
#include "mapper/app/map_files.h"

namespace vismem {

struct MapMakingOptions {
  /// Robot, configuration, palette and folder; its map stays empty.
  EvaluationOptions drive;
  double laps = 1.0;       ///< of a world's route, without `drive.seconds`
  double overlap_m = 4.0;  ///< driven on after them
  bool close = true;
  bool right_angles = true;
  std::filesystem::path edits;        ///< of a person (map_edits.h); empty: none
  std::filesystem::path saved_drive;  ///< NAME.drive of an earlier map, in place of a drive; empty: none
  MapFilesOptions files;              ///< whose folder, seed and source are those of `drive`
};

/// @throws ConfigError, RecordingError, std::runtime_error naming the wrong input.
RecordedDrive recordDrive(const MapMakingOptions& options);

/// Drives, maps and writes the files of writeMapFiles().
/// @return its summary.
nlohmann::json makeMapFromDrive(const MapMakingOptions& options);

}  // namespace vismem
