/// @file Whether a remembered edge lies on the floor, from how its floor place moves with the camera. Pure.
/// See M1.
#pragma once

#include <Eigen/Core>

#include "active_visual_memory/core/ground/floor_line.h"
#include "active_visual_memory/core/memory/parallax.h"

namespace vismem {

/// From where an image was taken.
struct PlaneView {
  Eigen::Vector2d camera = Eigen::Vector2d::Zero();            ///< the floor point below it, in odom [m]
  double height_m = 0.0;                                       ///< of the camera
  CameraTiltCovariance P_tilt = CameraTiltCovariance::Zero();  ///< of the estimated camera tilt [rad^2]
  Eigen::Matrix2d P_frame_tilt = Eigen::Matrix2d::Zero();      ///< of the tilt of this image [rad^2]
};

/// The one place that decides of a remembered edge whether it lies on the floor. Every view is compared with
/// the line at its anchor, the place of the camera in the first view. Edges that verified ones continue are
/// published as confirmed, too: see plane_confirmation.h. *Value.*
struct PlaneVerification {
  bool on_floor = false;  ///< its floor place rests while the camera moves
  bool stands = false;    ///< its floor place moves with the camera: it is off the floor or moves by itself
  bool not_vertical = false;  ///< a view across the viewing ray excluded a vertical edge
  bool anchored = true;       ///< false: the next view is the anchor
  Eigen::Vector2d first_camera = Eigen::Vector2d::Zero();  ///< of all views
  Eigen::Vector2d anchor_camera = Eigen::Vector2d::Zero();
  FloorLine anchor_line;
  ParallaxEstimate parallax;

  /// Whether it rests. Later views may still refute it.
  bool isVerified() const { return on_floor && not_vertical; }
  /// Whether it may be a vertical edge, whose floor place turns about its foot.
  bool mayBeVertical() const { return !on_floor && !not_vertical; }
  /// Distance of the camera from the anchor [m].
  double baseline(const Eigen::Vector2d& camera) const { return (camera - anchor_camera).norm(); }

  /// How far its floor place may have moved across the line since the first view [m]. On the floor 0; else
  /// the way of the camera across the line, times the slope of the parallax: at most 1, which is that of an
  /// edge that drives ahead, and 1 while it is unknown.
  double possibleShift(const PlaneView& view, const ParallaxEstimate::Params& params) const;

  /// Begins with a view of the line.
  void begin(const FloorLine& line, const PlaneView& view);
  /// Its place was seen without it: an edge that comes back there may be another one, so that verification
  /// begins anew with the next view. One off the floor stays so.
  void contradict();
  /// Compares a view with the anchor.
  /// @param line      before it is fused with `observed`.
  /// @param observed  in the direction of the line.
  void observe(const FloorLine& line, const FloorSegment& observed, const PlaneView& view,
               const ParallaxEstimate::Params& params, const FloorLine::Params& line_params);
  /// Applies a motion of the plane.
  void transform(const PlanarIncrement& motion);
  /// Follows a change of the tilt estimate.
  void applyTiltChange(const CameraTilt& change);

 private:
  void setAnchor(const FloorLine& line, const PlaneView& view);
  void addOffset(const FloorSegment& observed, const PlaneView& view, double drift_m,
                 const ParallaxEstimate::Params& params);
  void addEnd(const FloorLine& line, const FloorSegment& observed, bool at_b, const PlaneView& view,
              double drift_m, const ParallaxEstimate::Params& params, const FloorLine::Params& line_params);
};

}  // namespace vismem
