/// @file The files that a run itself reads: map, and the judged images of a recording.
#pragma once

#include <filesystem>

#include "application/app/options.h"
#include "evaluation/core/trajectory.h"
#include "evaluation/report/run_pictures.h"

namespace vismem {

/// Prints where map and palette do not fit each other (checkMap), as localization does.
/// @param palette may be empty.
/// @throws ConfigError.
RunMap loadRunMap(const std::filesystem::path& map, const std::filesystem::path& palette);

/// The images of a recording with a reliable camera pose, from cfg/SETUP/recordings.cfg by the recording's
/// name. All images of a recording that is not listed there, or of a setup without that file.
/// @throws ConfigError.
ImageRange judgedImages(const RunOptions& options);

/// The true poses in a recording (readTruth), by options.topics; empty where it has none or cannot be read:
/// replay_server says why.
/// @throws RecordingError when the topic that options.topics names for the truth has no poses.
Trajectory recordedTruth(const RunOptions& options);

}  // namespace vismem
