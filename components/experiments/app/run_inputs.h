/// @file The files that a run reads itself: the route, the map, and which images of a recording count.
#pragma once

#include <filesystem>

#include "common/segment_map/segment_map.h"
#include "experiments/app/options.h"
#include "common/routes/route.h"
#include "experiments/core/run_record.h"

namespace vismem {

/// @throws ConfigError as parseRoute, also when the file cannot be read.
Route loadRoute(const std::filesystem::path& file);

struct RunMap {
  SegmentMap map;
  SegmentMap edges;  ///< with stripes expanded by the palette
};
/// @param palette may be empty. @throws ConfigError.
RunMap loadRunMap(const std::filesystem::path& map, const std::filesystem::path& palette);

/// The images of a recording whose camera pose can be trusted, by the recording's name in
/// cfg/replay/recordings.cfg; all of a recording that is not named there.
/// @throws ConfigError.
ImageRange judgedImages(const RunOptions& options);

}  // namespace vismem
