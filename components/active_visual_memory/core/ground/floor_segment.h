/// @file An observed segment placed on the floor, with the uncertainty of its ends. Pure. See M1.
#pragma once

#include <Eigen/Core>

#include "active_visual_memory/core/ground/camera_tilt.h"
#include "common/geometry/segment.h"
#include "common/vision/image_segment.h"

namespace vismem {

/// One end of a floor segment.
struct FloorEnd {
  Eigen::Vector2d p = Eigen::Vector2d::Zero();  ///< on the floor of the frame of the camera pose [m]
  Eigen::Matrix2d P = Eigen::Matrix2d::Zero();  ///< covariance of p [m^2]
  TiltJacobian D = TiltJacobian::Zero();  ///< derivative of p by the camera tilt [m/rad]; not contained in P
  /// The segment was cut here (image border, range, horizon, occluder): the true end lies further out.
  bool censored = false;

  /// Variance of p along a unit vector [m^2].
  double varianceAlong(const Eigen::Vector2d& direction) const { return direction.dot(P * direction); }
};

/// An observed segment under the ground hypothesis. The direction a -> b is that of the image segment: the
/// brighter side lies on the left.
struct FloorSegment {
  FloorEnd a;
  FloorEnd b;
  double pitch_sigma_rad = 0.0;  ///< sigma of camera pitch and roll that the covariances contain
  Label label = kUnknownLabel;
  double strength = 0.0;  ///< as ImageSegment
  int observed = -1;      ///< index of the image segment

  Segment2 odom() const { return {a.p, b.p}; }
  void place(const Segment2& odom) { a.p = odom.a, b.p = odom.b; }
  const FloorEnd& end(bool at_b) const { return at_b ? b : a; }
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

/// The segment, reversed if it runs against a direction.
FloorSegment runningAlong(const Eigen::Vector2d& direction, const FloorSegment& segment);

}  // namespace vismem
