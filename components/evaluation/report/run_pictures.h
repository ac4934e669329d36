/// @file The figures of a run as files.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/segment_map/segment_map.h"
#include "evaluation/report/run_record.h"

namespace vismem {

/// The map of a run.
struct RunMap {
  SegmentMap map;
  SegmentMap edges;  ///< with stripes expanded by the palette
};

/// Writes top_view.png, error.png (with a truth) and last_image.png (with an analysed image). A file that
/// fails does not stop the others.
/// @param title of the pictures.
/// @return one line for each file that cannot be written.
std::vector<std::string> writePictures(const std::filesystem::path& folder, const RunRecord& record,
                                       const RunSummary& summary, const RunMap& map,
                                       const std::string& title);

}  // namespace vismem
