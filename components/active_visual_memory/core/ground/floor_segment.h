/// @file An observed segment placed on the floor, with the uncertainty of its ends. Pure. See M1.
#pragma once

#include <Eigen/Core>

#include "active_visual_memory/core/ground/camera_tilt.h"
#include "common/geometry/segment.h"
#include "common/vision/image_segment.h"

namespace vismem {

/// An observed segment under the ground hypothesis. The direction a -> b is that of the image segment: the
/// brighter side lies on the left.
struct FloorSegment {
  Segment2 odom;  ///< on the floor of the frame that the camera pose was given in [m]
  Eigen::Matrix2d P_a = Eigen::Matrix2d::Zero();  ///< covariance of end a [m^2]
  Eigen::Matrix2d P_b = Eigen::Matrix2d::Zero();
  TiltJacobian D_a = TiltJacobian::Zero();  ///< of end a by the camera tilt [m/rad]; not contained in P_a
  TiltJacobian D_b = TiltJacobian::Zero();
  double pitch_sigma_rad = 0.0;  ///< sigma of camera pitch and roll that P_a and P_b contain
  /// Censored: the segment was cut here (image border, range, horizon, occluder); the true end lies further
  /// out.
  bool censored_a = false;
  bool censored_b = false;
  Label label = kUnknownLabel;
  double strength = 0.0;  ///< as ImageSegment
  int observed = -1;      ///< index of the image segment
};

/// Conditions the covariances on the estimated tilt of this frame: its prior variance, at most that of
/// `pitch_sigma_rad`, is replaced by the posterior.
/// @param P_frame_tilt   posterior covariance about the x and y axes of the robot [rad^2].
/// @param per_frame_rad  prior sigma of the frame tilt [rad].
void conditionOnFrameTilt(FloorSegment& segment, const Eigen::Matrix2d& P_frame_tilt, double per_frame_rad);

/// Cuts a segment to a range around the point below the camera; an end that is cut is censored.
/// @return false if no part of it lies within the range.
bool cutToRange(FloorSegment& segment, const Eigen::Vector2d& below_camera, double range_m);

/// The same segment with its ends exchanged.
FloorSegment reversed(const FloorSegment& segment);

}  // namespace vismem
