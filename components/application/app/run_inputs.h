/// @file The files that a run itself reads: route, map, and the judged images of a recording.
#pragma once

#include <filesystem>

#include "application/app/options.h"
#include "application/core/run_record.h"
#include "common/routes/route.h"
#include "common/segment_map/segment_map.h"

namespace vismem {

/// @throws ConfigError as parseRoute, also when the file cannot be read.
Route loadRoute(const std::filesystem::path& file);

struct RunMap {
  SegmentMap map;
  SegmentMap edges;  ///< with stripes expanded by the palette
};
/// @param palette may be empty.
/// @throws ConfigError.
RunMap loadRunMap(const std::filesystem::path& map, const std::filesystem::path& palette);

/// The images of a recording with a reliable camera pose, from cfg/replay/recordings.cfg by the recording's
/// name. All images of a recording that is not listed there.
/// @throws ConfigError.
ImageRange judgedImages(const RunOptions& options);

}  // namespace vismem
