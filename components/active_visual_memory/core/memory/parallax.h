/// @file Height of an edge above the floor, from how its floor place moves with the camera. Pure. See M1.
#pragma once

#include <array>
#include <optional>

#include "active_visual_memory/core/ground/camera_tilt.h"

namespace vismem {

/// An edge at height h, back-projected to the floor from a camera at height H, moves by -b h / (H - h) when
/// the camera moves by b. The slope h / (H - h) is estimated by weighted least squares on three channels: the
/// offset of the line, and the places of both ends along it. A camera tilt also moves floor points, so the
/// derivatives of the slopes by the tilt are kept. *Pure value.*
class ParallaxEstimate {
 public:
  enum Channel { kOffset = 0, kEndA = 1, kEndB = 2 };

  struct Params {
    double min_step_m = 0.03;       ///< motion of the camera between two samples
    double min_baseline_m = 0.12;   ///< spread of camera places that a verdict needs
    double least_height_m = 0.06;   ///< lower edges count as lying on the floor
    double sigmas = 2.0;            ///< of a verdict
    double sample_sigma_m = 0.006;  ///< least sigma of a sample: errors of near views are correlated
    int views_per_place = 4;        ///< views from one place that count as independent, at most

    /// Slope of an edge at the least height; 0 if the camera is not higher.
    double slopeLimit(double camera_height_m) const;
  };

  enum class Verdict { kUnknown, kOnFloor, kOffFloor };

  /// Adds a view; views from one place are averaged into one sample.
  /// @param baseline_m   displacement of the camera along the axis of the channel since the first sample [m].
  /// @param shift_m      displacement of the floor place along the same axis [m].
  /// @param d_tilt       derivative of the shift by the camera tilt [m/rad].
  /// @param variance_m2  of the shift.
  void add(Channel channel, double baseline_m, double shift_m, const TiltJacobianRow& d_tilt,
           double variance_m2, const Params& params);

  /// The offset decides. Without a verdict of the offset (the camera moved along the line) the ends decide:
  /// one that moves is off the floor, or hidden by what moves. Off the floor both would move, so one resting
  /// end is enough beside an undecided one, unless the offset lies a sigma off the floor. A possibly vertical
  /// edge needs both, since its foot rests. Channels too weak alone decide together.
  Verdict verdict(double camera_height_m, bool not_vertical, const CameraTiltCovariance& P_tilt,
                  const Params& params) const;

  /// Moves the samples by a change of the tilt estimate.
  void applyTiltChange(const CameraTilt& change);

  /// Drops the samples of a channel: they belonged to another end.
  void forget(Channel channel) { sums_[channel] = {}; }

  struct Slope {
    double value = 0.0;
    double variance = 0.0;
  };
  /// Joint slope of all channels, for an edge of constant height.
  /// @return empty if they disagree, or if none has a slope.
  std::optional<Slope> common(const CameraTiltCovariance& P_tilt, const Params& params) const;
  /// @return empty while the baseline is too short.
  std::optional<Slope> slope(Channel channel, const CameraTiltCovariance& P_tilt, const Params& params) const;

 private:
  /// A shift [m] and its derivative by the camera tilt [m/rad], or slopes of both.
  using Sample = Eigen::Matrix<double, 1, 5>;
  /// Slope of a channel for a known camera tilt.
  struct Fit {
    Sample slope = Sample::Zero();
    double information = 0.0;

    Slope given(const CameraTiltCovariance& P_tilt) const;
  };
  std::optional<Fit> fit(Channel channel, const Params& params) const;

  /// Normal equations of shift = (1, baseline) * unknowns.
  struct Sums {
    Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
    Eigen::Matrix<double, 2, 5> right = Eigen::Matrix<double, 2, 5>::Zero();
    double low = 0.0, high = 0.0;  ///< baselines [m]
    int count = 0;                 ///< samples
    // The newest sample, which further views from its place improve.
    Sample newest = Sample::Zero();
    double baseline_m = 0.0;
    double weight = 0.0;
    double view_weight = 0.0;  ///< mean of its views
    int views = 0;

    void addNewest(double with_weight);
  };
  std::array<Sums, 3> sums_;
};

}  // namespace vismem
