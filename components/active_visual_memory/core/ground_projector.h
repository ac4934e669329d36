/// @file Observed image segments placed on the floor, with the uncertainty of their ends. Pure. SPEC M1.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "active_visual_memory/core/camera_lean.h"
#include "common/geometry/camera.h"
#include "common/geometry/pose.h"
#include "common/geometry/segment.h"
#include "common/vision/image_segment.h"

namespace vismem {

/// An observed segment under the ground hypothesis. The direction a -> b is the image segment's, so the
/// brighter side stays on the left.
struct FloorSegment {
  Segment2 odom;  ///< on the floor of the frame that the camera pose was given in [m]
  Eigen::Matrix2d P_a = Eigen::Matrix2d::Zero();  ///< covariance of end a [m^2]
  Eigen::Matrix2d P_b = Eigen::Matrix2d::Zero();
  FloorLean D_a = FloorLean::Zero();  ///< how a lean of the camera moves end a [m/rad]; not part of P_a
  FloorLean D_b = FloorLean::Zero();
  double pitch_sigma_rad = 0.0;  ///< what P_a and P_b contain of it, for the camera's pitch and roll
  /// The segment was cut here (image border, range, horizon): it may go on, the end says nothing.
  bool open_a = false;
  bool open_b = false;
  Label label = kUnknownLabel;
  double strength = 0.0;  ///< as ImageSegment
  int observed = -1;      ///< index of the image segment
};

/// The body's sway in this image was estimated: what its covariances contained of it, `sway_rad` and at most
/// all of the camera's pitch, gives way to what is still unknown, `P_sway` (about the robot's x and y axes).
void knowSway(FloorSegment& segment, const Eigen::Matrix2d& P_sway, double sway_rad);

/// Keeps what lies within a range of the point below the camera; an end that is cut is open.
/// @return false when nothing of it does.
bool cutToRange(FloorSegment& segment, const Eigen::Vector2d& below_camera, double range_m);

/// *Pure.* Invariant: every result lies within max_range_m of the point below the camera.
class GroundProjector {
 public:
  struct Params {
    double max_range_m = 4.0;        ///< of a floor point from the point below the camera
    double horizon_margin_px = 3.0;  ///< nearer to the horizon nothing is placed on the floor
    double border_margin_px = 5.0;   ///< ends nearer to the image border are open: detectors stop short of it
    /// Added to ends that are none of the border's. The detector's are 0.95 px short on average; fusing them,
    /// which trusts what was seen further out more, takes half of that back already.
    double end_short_px = 0.0;
    double min_length_m = 0.04;           ///< shorter floor segments are dropped
    std::vector<Label> off_floor_labels;  ///< edges known not to lie on the floor: door jambs
    double across_sigma_px = 0.5;         ///< of a detected line across its direction
    double along_sigma_px = 1.5;          ///< of a detected end along the line
    double height_sigma_m = 0.01;         ///< of the camera's height
    double pitch_sigma_rad = 0.006;       ///< of the camera's pitch and roll
    double timing_sigma_s = 0.004;  ///< of the stamps of joints against images; counts with the turn rate
  };

  explicit GroundProjector(const Params& params) : params_(params) {}

  /// @param T_odom_camera  pose of the camera; the floor is z = 0 of its frame.
  /// @param turn_rate_radps of the camera in odom, >= 0: widens the covariances.
  /// @param robot_heading_rad in odom: the axes that the robot leans about.
  std::vector<FloorSegment> project(const CameraIntrinsics& intrinsics, const Pose3& T_odom_camera,
                                    const std::vector<ImageSegment>& observed, double turn_rate_radps = 0.0,
                                    double robot_heading_rad = 0.0) const;

  /// Covariance of the floor point under an ideal pixel. @param along unit direction of the segment [px].
  /// @return empty when the pixel's ray does not go down.
  std::optional<Eigen::Matrix2d> floorCovariance(const CameraIntrinsics& intrinsics,
                                                 const Pose3& T_odom_camera, const Eigen::Vector2d& px_ideal,
                                                 const Eigen::Vector2d& along, double turn_rate_radps) const;

 private:
  bool nearBorder(const CameraIntrinsics& intrinsics, const Eigen::Vector2d& px_ideal) const;
  std::optional<FloorSegment> place(const CameraIntrinsics& intrinsics, const Pose3& T_odom_camera,
                                    const ImageSegment& segment, double turn_rate_radps) const;

  Params params_;
};

}  // namespace vismem
