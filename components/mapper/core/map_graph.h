/// @file The graph of a drive: poses, line landmarks, camera tilt and odometry errors in one least squares
/// problem, solved by Ceres. Pure. See B6. After F. Lu, E. Milios, "Globally consistent range scan alignment
/// for environment mapping", 1997, with lines as landmarks.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "active_visual_memory/core/estimation/map_filter.h"
#include "active_visual_memory/core/ground/camera_tilt.h"
#include "mapper/core/landmarks.h"
#include "mapper/core/pose_graph.h"

namespace vismem {

struct GraphParams {
  OdometryErrors odometry;
  TiltPrior tilt;
  /// Sigma of an observed line: a first guess, which allows for errors that successive images share.
  double across_px = 0.7;
  double along_px = 2.0;     ///< of a closed end
  double lever_m = 0.0;      ///< of the tilt of single images: MapFilter::Params::gait_height_m for legs
  double timing_s = 0.004;   ///< of joint stamps against image stamps
  double end_gate_m = 0.10;  ///< an observed end belongs to a closed one within this ..
  double end_gate_px = 6.0;  ///< .. or this
  double right_angle_rad = 0.005;      ///< sigma of a line against the dominant direction
  double right_angle_gate_rad = 0.06;  ///< lines further off do not belong to it
};

/// What a person knows of two landmarks, or of the length of one. Indices of MapState::landmarks.
struct LineConstraint {
  enum class Kind { kStraight, kSquare, kLength };
  Kind kind = Kind::kStraight;
  std::size_t one = 0;
  std::size_t other = 0;
  double length_m = 0.0;
};

/// Parts of one solve. The order matters: kernels on lines only when the graph is near its solution, right
/// angles last.
struct SolveStage {
  bool ends = true;
  double kernel = 0.0;  ///< Cauchy on lines and ends [sigma]; 0: least squares
  bool right_angles = false;
  int iterations = 50;
  /// Ends when an iteration lowers the cost by less than this share: the next stage starts near enough.
  double tolerance = 1e-4;
  std::vector<LineConstraint> constraints{};
};

struct SolveReport {
  double cost = 0.0;
  int residuals = 0;
  int iterations = 0;
  bool usable = false;
  std::string problem;  ///< of the solver; empty if usable
  double seconds = 0.0;
  double line_noise = 1.0;  ///< robust sigma of what is left of lines and ends, in those it was solved with
  double end_noise = 1.0;
};

/// With the noise of the images as a solve left it, near its solution.
GraphParams measured(const GraphParams& params, const SolveReport& report);

/// Solves in place. The first pose stays where it is.
/// @param closings  accepted ones, as factors beside the landmarks.
SolveReport solveGraph(const DriveRecord& record, const GraphParams& params, const SolveStage& stage,
                       MapState& state, const std::vector<Closing>& closings = {});

/// Covariances of lines and closed ends, relative to their anchors: sets P_line, sigma_a_m and sigma_b_m.
/// @return empty, or why the problem has no covariance.
std::string addCovariances(const DriveRecord& record, const GraphParams& params, const SolveStage& stage,
                           MapState& state, const std::vector<Closing>& closings = {});

/// Covariances of (x, y, theta) of the pose `to` in the frame of the pose `from` of each closing, without
/// that closing.
/// @return empty if the problem has none.
std::vector<Eigen::Matrix3d> relativeCovariances(const DriveRecord& record, const GraphParams& params,
                                                 const SolveStage& stage, MapState& state,
                                                 const std::vector<Closing>& pairs);

/// Distances of the observed ends from the landmark's projected line, without sign [px].
std::vector<double> lineErrors(const DriveRecord& record, const GraphParams& params, const MapState& state,
                               const LineLandmark& landmark);

}  // namespace vismem
