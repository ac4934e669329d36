/// @file What the live mapper does, for clients. Pure. See B6.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/robot/samples.h"

namespace vismem {

/// What has been recorded of the drive.
struct DriveProgress {
  std::string message;  ///< why nothing is recorded; empty: it is
  int keyframes = 0;
  double way_m = 0.0;
  StampUs begin_us = 0;  ///< of the first keyframe
  StampUs end_us = 0;
  bool finished = false;  ///< the recording that is replayed has ended
};

/// What came of one map.
struct BuiltMap {
  std::filesystem::path file;  ///< empty: there is no usable map
  int edges = 0;
  int seen_again = 0;    ///< edges that a later visit saw again
  double way_m = 0.0;    ///< of the drive when it was begun
  double seconds = 0.0;  ///< from the command to the files
  std::vector<std::string> notes;
  std::vector<std::string> problems;
};

struct MapBuilderStatus {
  bool building = false;
  double progress = 0.0;  ///< share of the way that was searched for closings
  int built = 0;
  BuiltMap last;
};

}  // namespace vismem
