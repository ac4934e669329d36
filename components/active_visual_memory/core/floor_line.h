/// @file A straight line on the floor with its uncertainty and the extent that was really seen. Pure. SPEC
/// M3.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "active_visual_memory/core/drift_alignment.h"
#include "active_visual_memory/core/ground_projector.h"
#include "common/geometry/segment.h"

namespace vismem {

/// One end of the seen extent.
struct ExtentEnd {
  double t_m = 0.0;                  ///< along the line from its origin
  double variance_m2 = 0.0;          ///< of t_m
  bool open = false;                 ///< the line may go on: only a bound is known
  double best_m2 = 0.0;              ///< variance of the best single view of this end
  int views = 1;                     ///< that agreed on it
  LeanRow d_lean = LeanRow::Zero();  ///< how the lean of the camera moves t_m [m/rad]
  bool parted = false;               ///< behind a gap the line goes on as another element: it ends here
};

/// A supporting line (offset and direction with a 2x2 covariance) and the extent on it. The direction a -> b
/// carries the polarity. *Pure value.* Invariant: end a lies before end b, covariances are positive.
/// Default fusion: the line is updated by the observed ends' offsets, weighted by their covariances; the
/// extent is the union of what was seen, true ends averaged, open ends only moved outwards.
/// The camera's lean (CameraLean) is common to all lines: a line is kept given the lean that is believed now,
/// with the derivatives of its parameters by it. The covariance is that for a known lean; `P_lean` adds the
/// rest.
class FloorLine {
 public:
  struct Params {
    double offset_floor_m = 0.003;  ///< uncertainty that remains after any number of observations
    double angle_floor_rad = 0.003;
    double offset_noise_m = 0.0015;  ///< added per fusion: errors of successive images are correlated
    double angle_noise_rad = 0.0010;
    double end_floor_m = 0.005;
    double end_noise_m = 0.003;
    double end_outward_m = 0.010;  ///< the same for an end that is seen further out: what hid it may give way
    double end_gate_sigmas = 3.0;  ///< two true ends nearer than this are one
    double end_gate_m = 0.03;      ///< or nearer than this
    int known_views = 3;           ///< a true end seen this often is moved outwards only ..
    double worse_view = 4.0;       ///< .. by views of at most this many times its best variance
    double measure_floor_m = 0.004;  ///< least sigma of an observed offset
  };

  FloorLine() = default;
  explicit FloorLine(const FloorSegment& segment, const Params& params);

  Segment2 segment() const;
  double direction() const { return direction_rad_; }
  const Eigen::Vector2d& along() const { return along_; }
  Eigen::Vector2d normal() const { return {-along_.y(), along_.x()}; }  ///< left of the direction
  Eigen::Matrix2d covarianceA() const { return covarianceAt(a_); }
  Eigen::Matrix2d covarianceB() const { return covarianceAt(b_); }
  /// How the lean moves the places of the ends [m/rad].
  FloorLean leanOfA() const { return leanOf(a_); }
  FloorLean leanOfB() const { return leanOf(b_); }
  /// How it moves the line across its direction at t [m/rad].
  LeanRow offsetLean(double t_m) const { return J_.row(0) + t_m * J_.row(1); }
  const ExtentEnd& endA() const { return a_; }
  const ExtentEnd& endB() const { return b_; }
  double length() const { return b_.t_m - a_.t_m; }

  Eigen::Vector2d pointAt(double t_m) const { return origin_ + t_m * along(); }
  double tOf(const Eigen::Vector2d& p_odom) const { return along().dot(p_odom - origin_); }
  double offsetOf(const Eigen::Vector2d& p_odom) const { return normal().dot(p_odom - origin_); }
  /// Variance of the line's place across its direction, at t [m^2].
  double offsetVariance(double t_m) const;
  /// The part of it that comes from the direction alone.
  double turnVariance(double t_m) const { return t_m * t_m * P_(1, 1); }

  /// Carries the line along with a motion of the plane.
  void move(const SmallMotion& motion);

  /// The lean is believed to be another, by so much.
  void lean(const Lean& change);

  /// Grows the uncertainty by what odometry may have drifted: offset sigma and angle sigma are added.
  void drift(double offset_sigma_m, double angle_sigma_rad);

  /// Squared normalised distances of the observed ends from the line, the larger of both. `slack_m` is a
  /// sigma added for what the covariances do not model.
  double disagreement(const FloorSegment& observed, double slack_m,
                      const LeanCovariance& P_lean = LeanCovariance::Zero()) const;

  /// Default fusion with an observation of the same line (directions within 90 degrees).
  void fuse(const FloorSegment& observed, const Params& params);
  /// The extent alone: where the line lies is estimated elsewhere (JointAlignment), and told by ..
  void fuseExtent(const FloorSegment& observed, const Params& params);
  /// .. the change of its place, counted at a point beside it, ..
  void correct(const Eigen::Vector2d& reference, double offset_m, double turn_rad);
  /// .. how well that is known for a known lean, and how it follows the lean.
  void know(const Eigen::Vector2d& reference, const Eigen::Matrix2d& P, const Eigen::Matrix<double, 2, 4>& J);
  void leanExtent(const Lean& change);
  /// Fusion as the chapter has it: place and orientation of the newer, longest extent of both.
  void replaceKeepingExtent(const FloorSegment& observed, const Params& params);
  /// Takes in another estimate of the same line.
  void absorb(const FloorLine& other, const Params& params);

  /// Moves an end inwards to where the line was seen to stop.
  void shorten(bool at_b, const ExtentEnd& end);
  /// What is seen across this end from now on is another element.
  void part(bool at_b) { (at_b ? b_ : a_).parted = true; }

  /// The line as if it had been observed now.
  FloorSegment asObservation() const;

 private:
  ExtentEnd endAt(double t_m, const Eigen::Matrix2d& P, const FloorLean& D, bool open) const;
  FloorLean leanOf(const ExtentEnd& end) const;
  Eigen::Matrix2d covarianceAt(const ExtentEnd& end) const;
  void updateOffset(double t_m, double offset_m, double variance_m2, const LeanRow& d_lean);
  void fuseExtent(double ta, double tb, const FloorSegment& observed, const Params& params);
  void turnTo(double direction_rad);
  void applyCorrection();
  void applyFloor(const Params& params);
  void recentre();

  Eigen::Vector2d origin_ = Eigen::Vector2d::Zero();
  double direction_rad_ = 0.0;
  Eigen::Vector2d along_ = Eigen::Vector2d::UnitX();      ///< of the direction: asked for many times an image
  Eigen::Vector2d correction_ = Eigen::Vector2d::Zero();  ///< offset and angle gathered in one update
  Eigen::Matrix2d P_ = Eigen::Matrix2d::Identity();       ///< of (offset, angle) at the origin
  Eigen::Matrix<double, 2, 4> J_ = Eigen::Matrix<double, 2, 4>::Zero();  ///< d (offset, angle) / d lean
  ExtentEnd a_;
  ExtentEnd b_;
};

/// Was the line parted between these two? Then they stay two, unless one lies over most of the other.
bool arePartedFrom(const FloorLine& one, const FloorLine& other);

/// The union rule for one end: true ends that agree are averaged; what was seen further out moves the end
/// there, unless a well-known true end would be moved by a worse view (which runs neighbouring edges
/// together).
/// @param outward +1 for end b, -1 for end a.
ExtentEnd fuseEnds(const ExtentEnd& known, const ExtentEnd& seen, double outward,
                   const FloorLine::Params& params);

}  // namespace vismem
