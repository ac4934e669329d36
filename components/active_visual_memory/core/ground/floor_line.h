/// @file A straight line on the floor with its covariance and its observed extent.
/// Pure. Implements M3.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "active_visual_memory/core/ground/floor_segment.h"
#include "common/geometry/planar_increment.h"
#include "common/geometry/plane.h"
#include "common/geometry/segment.h"

namespace vismem {

/// One end of the observed extent.
struct ExtentEnd {
  double t_m = 0.0;                                  ///< along the line from its origin
  double variance_m2 = 0.0;                          ///< of t_m
  bool censored = false;                             ///< only a bound: the line may continue
  double best_m2 = 0.0;                              ///< variance of the best single view of this end
  int views = 1;                                     ///< observations that agreed on it
  TiltJacobianRow d_tilt = TiltJacobianRow::Zero();  ///< derivative of t_m by the camera tilt [m/rad]
  bool split = false;                                ///< behind a gap the line continues as another element
};

/// A supporting line (offset and direction with a 2x2 covariance) and the extent on it. The direction a -> b
/// carries the polarity. *Pure value.* Invariant: end a lies before end b, covariances are positive.
/// MapFilter estimates the supporting line of most landmarks; `fuseLine` is for those outside it, `fuse` for
/// merging. The ends are always estimated here, by fuseEnds. The camera tilt is common to all lines: the
/// state is conditional on the present estimate of the tilt, its derivatives by the tilt are kept, and the
/// covariance is that for a known tilt. `P_tilt` adds the rest.
class FloorLine {
 public:
  struct Params {
    double offset_floor_m = 0.003;  ///< sigma that remains after any number of observations
    double angle_floor_rad = 0.003;
    double offset_noise_m = 0.0015;  ///< added per fusion: errors of successive images are correlated
    double angle_noise_rad = 0.0010;
    double end_floor_m = 0.005;
    double end_noise_m = 0.003;  ///< process noise per fusion of an end
    double end_outward_m =
        0.010;  ///< the same of an end that is observed further out: an occluder may have moved
    double end_gate_sigmas = 3.0;    ///< two true ends nearer than this are one
    double end_gate_m = 0.03;        ///< or nearer than this
    int known_views = 3;             ///< a true end seen this often moves out of the gate only by good views
    double worse_view = 4.0;         ///< a good view has at most this many times its best variance
    double measure_floor_m = 0.004;  ///< least sigma of an observed offset
  };

  FloorLine() = default;
  explicit FloorLine(const FloorSegment& segment, const Params& params);

  Segment2 segment() const;
  double direction() const { return direction_rad_; }
  const Eigen::Vector2d& along() const { return along_; }
  Eigen::Vector2d normal() const { return turned90(along_); }  ///< left of the direction
  /// Place of an end in odom, with its covariance and derivative by the camera tilt.
  FloorEnd floorEnd(bool at_b) const;
  /// An observed end as one view of an end of this extent.
  ExtentEnd project(const FloorEnd& seen) const;
  /// Derivative of the offset at t by the camera tilt [m/rad].
  TiltJacobianRow offsetTiltJacobian(double t_m) const { return J_.row(0) + t_m * J_.row(1); }
  const ExtentEnd& endA() const { return a_; }
  const ExtentEnd& endB() const { return b_; }
  const ExtentEnd& end(bool at_b) const { return at_b ? b_ : a_; }
  double length() const { return b_.t_m - a_.t_m; }

  Eigen::Vector2d pointAt(double t_m) const { return origin_ + t_m * along(); }
  double tOf(const Eigen::Vector2d& p_odom) const { return along().dot(p_odom - origin_); }
  double offsetOf(const Eigen::Vector2d& p_odom) const { return normal().dot(p_odom - origin_); }
  /// Variance of the offset at t [m^2].
  double offsetVariance(double t_m) const;
  /// The part of it that comes from the direction alone.
  double turnVariance(double t_m) const { return t_m * t_m * P_(1, 1); }

  /// Applies a motion of the plane.
  void transform(const PlanarIncrement& motion);

  /// Moves line and extent by a change of the tilt estimate.
  void applyTiltChange(const CameraTilt& change);

  /// Adds odometry drift: sigmas of offset and angle.
  void drift(double offset_sigma_m, double angle_sigma_rad);

  /// Squared Mahalanobis distance of the observed ends from the line, the larger of both.
  /// @param slack_m  sigma of errors that the covariances do not model [m].
  double disagreement(const FloorSegment& observed, double slack_m,
                      const CameraTiltCovariance& P_tilt = CameraTiltCovariance::Zero()) const;

  /// fuseLine and fuseExtent. @param observed  of the same line, directions within 90 degrees.
  void fuse(const FloorSegment& observed, const Params& params);
  /// Kalman update of the supporting line by the offsets of both observed ends.
  void fuseLine(const FloorSegment& observed, const Params& params);
  /// Fuses both ends.
  void fuseExtent(const FloorSegment& observed, const Params& params);
  /// Applies a correction of the supporting line.
  /// @param reference  point that offset and turn are counted at [m].
  void correct(const Eigen::Vector2d& reference, double offset_m, double turn_rad);
  /// Sets the uncertainty of the supporting line.
  /// @param P  covariance of (offset, angle) for a known camera tilt.
  /// @param J  derivative of (offset, angle) by the camera tilt.
  void know(const Eigen::Vector2d& reference, const Eigen::Matrix2d& P, const Eigen::Matrix<double, 2, 4>& J);
  /// Moves the extent alone by a change of the tilt estimate.
  void tiltExtent(const CameraTilt& change);
  /// Fusion of the chapter (M3): place and orientation of the newer, longest extent of both.
  void replaceKeepingExtent(const FloorSegment& observed, const Params& params);
  /// Fuses another estimate of the same line.
  void absorb(const FloorLine& other, const Params& params);

  /// Replaces an end by a place further in, where the line was seen to stop.
  void shorten(bool at_b, const ExtentEnd& end);

  /// The line as if it had been observed now.
  FloorSegment asObservation() const;

 private:
  void updateOffset(double t_m, double offset_m, double variance_m2, const TiltJacobianRow& d_tilt);
  void turnTo(double direction_rad);
  void applyCorrection();
  void applyFloor(const Params& params);
  void recentre();

  Eigen::Vector2d origin_ = Eigen::Vector2d::Zero();
  double direction_rad_ = 0.0;
  Eigen::Vector2d along_ = Eigen::Vector2d::UnitX();      ///< unit vector of the direction
  Eigen::Vector2d correction_ = Eigen::Vector2d::Zero();  ///< offset and angle gathered in one update
  Eigen::Matrix2d P_ = Eigen::Matrix2d::Identity();       ///< of (offset, angle) at the origin
  Eigen::Matrix<double, 2, 4> J_ =
      Eigen::Matrix<double, 2, 4>::Zero();  ///< d (offset, angle) / d camera tilt
  ExtentEnd a_;
  ExtentEnd b_;
};

/// Whether a split separates both lines; false if one covers more than half of the other.
bool areSplit(const FloorLine& one, const FloorLine& other);

/// Distance up to which two observations of an end are of one end [m]. @param one, other  their variances
/// [m^2].
double endGate(double one, double other, const FloorLine::Params& params);

/// Fusion of one end. True ends within the gate have a Kalman update. A true or censored observation beyond
/// the gate replaces a true end, unless that is split, or well known and this view is worse: blurred views
/// join neighbouring edges. A censored end is replaced by a true one not further in than the gate, or by a
/// censored one further out. SegmentMemory::updateEndpoints moves ends inwards.
/// @param outward  +1 for end b, -1 for end a.
ExtentEnd fuseEnds(const ExtentEnd& known, const ExtentEnd& seen, double outward,
                   const FloorLine::Params& params);

}  // namespace vismem
