/// @file The text files of a run: trajectories, the memory at its end, the races over time.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>
#include <string_view>
#include <vector>

#include "common/visual_memory/memory_snapshot.h"
#include "evaluation/core/trajectory.h"
#include "localization/core/pose_estimate.h"

namespace vismem {

/// TUM format, as `evo` and others read it: one `t x y z qx qy qz qw` a line, seconds and metres, blanks
/// between; here z = qx = qy = 0. Stamps keep their microseconds, poses nine decimals.
void writeTum(const Trajectory& trajectory, std::ostream& out);
/// Reads TUM text; lines of blanks and those that begin with `#` are skipped. Heights, roll and pitch are
/// dropped.
/// @throws ConfigError with every problem: FILE:LINE, what was found, what was expected.
Trajectory parseTum(std::string_view text, const std::string& file_name);

/// `t_s,id,x1_m,...,label,life,position_std_m,last_seen_s`, in odom; position_std_m is the root of the larger
/// end's mean variance in the plane.
void writeMemoryCsv(const MemorySnapshot& memory, std::ostream& out);
/// The shapes in memory (M8), one a line, in the odometry frame; the corners as "x y; x y" in the order of
/// Primitive::vertices.
void writePrimitivesCsv(const MemorySnapshot& memory, std::ostream& out);

/// `t_s,race,x_m,y_m,theta_rad,health,weight,victories,age`, one row per race and estimate, in world.
void writeRacesCsv(const std::vector<PoseEstimate>& estimates, std::ostream& out);

/// Writes a file whole. @throws std::runtime_error "cannot write FILE: REASON".
void writeTextFile(const std::filesystem::path& file, const std::string& text);

}  // namespace vismem
