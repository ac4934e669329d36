/// @file The files of a map made from a drive. See B6.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "mapper/app/map_making.h"

namespace vismem {

/// Writes NAME.csv, .palette, .svg and .dxf into a folder, which is created.
/// @throws std::runtime_error naming a file that cannot be written.
void writeDrawings(const SegmentMap& map, const std::filesystem::path& palette,
                   const std::filesystem::path& out, const std::string& name);

/// Writes all files into options.drive.out, which is created.
/// @return the summary, with a list `problems` where there is no usable map.
/// @throws std::runtime_error naming a file that cannot be written.
nlohmann::json writeMapFiles(const RecordedDrive& drive, const DriveMap& map,
                             const MapMakingOptions& options);

}  // namespace vismem
