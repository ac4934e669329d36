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

// Each file begins with its header; rows follow as they come.

/// TUM format, as `evo` and others read it: one `t x y z qx qy qz qw` a line, seconds and metres, blanks
/// between; here z = qx = qy = 0. Stamps keep their microseconds, poses nine decimals.
void writeTumRow(const StampedPose& pose, std::ostream& out);
inline constexpr std::string_view kTumHeader = "# t x y z qx qy qz qw\n";

/// `t_s,id,x1_m,...,label,life,position_std_m,last_seen_s,confirmed,p1_xx_m2,...,p2_yy_m2`, in odom;
/// position_std_m is the root of the larger end's mean variance in the plane, the last columns are the
/// covariances of both ends in the plane.
void writeMemoryRows(const MemorySnapshot& memory, std::ostream& out);
inline constexpr std::string_view kMemoryHeader =
    "t_s,id,x1_m,y1_m,z1_m,x2_m,y2_m,z2_m,label,life,position_std_m,last_seen_s,confirmed,"
    "p1_xx_m2,p1_xy_m2,p1_yy_m2,p2_xx_m2,p2_xy_m2,p2_yy_m2\n";

/// The shapes in memory (M8), one a line, in the odometry frame; the corners as "x y; x y" in the order of
/// Primitive::vertices.
void writePrimitivesRows(const MemorySnapshot& memory, std::ostream& out);
inline constexpr std::string_view kPrimitivesHeader =
    "t_s,id,kind,x_m,y_m,heading_rad,length_m,width_m,radius_m,hidden_vertex,quality,life,vertices_m\n";

/// One row per race and estimate, in world. Reliability and covariance are the winner's, in its row alone.
void writeRacesRows(const PoseEstimate& estimate, std::ostream& out);
inline constexpr std::string_view kRacesHeader =
    "t_s,race,x_m,y_m,theta_rad,health,weight,victories,age,reliability,xx_m2,xy_m2,yy_m2,xt_mrad,yt_mrad,"
    "tt_rad2\n";

/// Writes a file whole. @throws std::runtime_error "cannot write FILE: REASON".
void writeTextFile(const std::filesystem::path& file, const std::string& text);

}  // namespace vismem
