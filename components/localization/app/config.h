/// @file Configuration of localization: every key, checked once at start. Pure except for reading files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "common/config/config_reader.h"
#include "common/geometry/pose.h"
#include "common/segment_map/segment_map.h"
#include "localization/core/gaze/gaze_planner.h"
#include "localization/core/localizer.h"

namespace vismem {

/// See C2. All keys begin with "Localization."; the table is in the component's README.
struct LocalizationConfig {
  std::string visual_memory_proxy;
  std::filesystem::path map;
  std::filesystem::path palette;  ///< of the map's stripes; empty: the map has no stripes
  std::uint64_t seed = 1;
  std::optional<Pose2> start;  ///< known from outside; empty: unknown
  double pose3d_scale = 1.0;   ///< of JdeRobot positions: 1 metres, 1000 for old millimetre clients
  std::string gaze_proxy;      ///< empty: no gaze requests
  GazePlannerParams gaze;
  LocalizerParams params;
};

/// Reads and checks every key of the component but the process's own. Problems are collected in `reader`;
/// the caller finishes it.
/// @param reader at the prefix "Localization".
LocalizationConfig readLocalizationConfig(ConfigReader& reader);

/// The part that lock-step tools share: mode and parameters. Keys and prefix as above.
LocalizerParams readLocalizerParams(ConfigReader& reader);

/// The same of the gaze requests.
/// @param reader at the prefix "Localization".
GazePlannerParams readGazePlannerParams(ConfigReader& reader);

struct LoadedMap {
  SegmentMap rows;                    ///< as in its file
  SegmentMap edges;                   ///< with stripes expanded, as the Localizer takes it
  std::vector<std::string> warnings;  ///< of the palette, and where map and palette do not fit each other
};

/// @param palette may be empty.
/// @throws ConfigError with the problems of both files, or if the palette names no label of the map.
LoadedMap loadMapEdges(const std::filesystem::path& map, const std::filesystem::path& palette);

}  // namespace vismem
