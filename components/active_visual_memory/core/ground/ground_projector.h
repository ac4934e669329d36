/// @file Observed image segments placed on the floor, with the uncertainty of their ends.
/// Pure. Implements M1. See G2.
#pragma once

#include <Eigen/Core>
#include <memory_resource>
#include <optional>
#include <vector>

#include "active_visual_memory/core/ground/floor_segment.h"
#include "common/config/parameter_visitor.h"
#include "common/geometry/camera.h"
#include "common/geometry/pose.h"
#include "common/geometry/segment.h"
#include "common/vision/image_segment.h"

namespace vismem {

/// Back-projects image segments to the ground plane. *Pure.* Invariant: every result lies within max_range_m
/// of the point below the camera.
class GroundProjector {
 public:
  struct Params {
    double max_range_m = 4.0;        ///< of a floor point from the point below the camera
    double horizon_margin_px = 3.0;  ///< pixels nearer to the horizon are not placed on the floor
    double border_margin_px =
        5.0;  ///< ends nearer to the image border are censored: detectors stop short of it
    /// Added to ends away from the border. The detector `solis` ends 0.95 px short on average; fusion weights
    /// ends that were seen further out and removes half of that.
    double end_short_px = 0.0;
    double min_length_m = 0.04;           ///< shorter floor segments are dropped
    std::vector<Label> off_floor_labels;  ///< labels of edges off the floor, such as door jambs
    double across_sigma_px = 0.5;         ///< of a detected line across its direction
    double along_sigma_px = 1.5;          ///< of a detected end along the line
    double height_sigma_m = 0.0;          ///< of the height of the camera in single images
    double pitch_sigma_rad = 0.006;       ///< of the pitch and roll of the camera
    double timing_sigma_s = 0.004;  ///< of joint stamps against image stamps; multiplied by the turn rate

    void visit(ParameterVisitor& v);
  };

  explicit GroundProjector(const Params& params) : params_(params) {}

  /// @param T_odom_camera      pose of the camera [m]; the floor is z = 0 of its frame.
  /// @param turn_rate_radps    of the camera in odom, >= 0: widens the covariances.
  /// @param robot_heading_rad  heading in odom: the axes of the mount tilt.
  /// @return the floor segments, with the index of their image segment.
  std::pmr::vector<FloorSegment> project(
      const CameraIntrinsics& intrinsics, const Pose3& T_odom_camera,
      const std::vector<ImageSegment>& observed, double turn_rate_radps = 0.0, double robot_heading_rad = 0.0,
      std::pmr::memory_resource* scratch = std::pmr::get_default_resource()) const;

  /// Covariance of the floor point under an ideal pixel [m^2], by first-order propagation of pixel, height,
  /// rotation and timing errors of single images. A lasting error of the height is none of them: it scales
  /// all places alike, as an error of the travelled way does, which MapFilter estimates.
  /// @param along  unit direction of the segment [px].
  /// @return empty if the pixel's ray does not meet the floor.
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
