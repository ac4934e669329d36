/// @file Does an element really lie on the floor? Its height from how its floor place moves. Pure. SPEC M1.
#pragma once

#include <array>
#include <optional>

#include "active_visual_memory/core/camera_lean.h"

namespace vismem {

/// An edge at height h, back-projected to the floor from a camera at height H, moves by -b h / (H - h) for a
/// camera displacement b. The slope h / (H - h) is estimated by weighted least squares on three channels:
/// the line's offset, and the places of its two ends along it. A camera that leans moves what lies on the
/// floor, too: the slopes are kept with their derivatives by the lean. *Pure value.*
class ParallaxEstimate {
 public:
  enum Channel { kOffset = 0, kEndA = 1, kEndB = 2 };

  struct Params {
    double min_step_m = 0.03;      ///< a sample counts only when the camera moved this far since the last
    double min_baseline_m = 0.12;  ///< no verdict from a smaller spread of camera places
    double least_height_m = 0.06;  ///< lower things count as lying on the floor
    double sigmas = 2.0;
    double sample_sigma_m = 0.006;  ///< least sigma of a sample: errors of near views are correlated
    int views_per_place = 4;        ///< so many views from one place are worth more than one
  };

  enum class Verdict { kUnknown, kOnFloor, kOffFloor };

  /// Views from one place make one sample, their mean.
  /// @param baseline_m  displacement of the camera along the channel's axis since the first sample.
  /// @param shift_m     displacement of the floor place along the same axis.
  /// @param d_lean     how the lean of the camera changes the shift [m/rad].
  void add(Channel channel, double baseline_m, double shift_m, const LeanRow& d_lean, double variance_m2,
           const Params& params);

  /// The line's offset decides. Where it tells nothing (the camera moved along the line) the ends do: off the
  /// floor both would move, so one that rests is enough, except for what may be a vertical edge, whose foot
  /// rests too: there both must. Where each by itself tells too little they may do so together.
  Verdict verdict(double camera_height_m, bool not_vertical, const LeanCovariance& P_lean,
                  const Params& params) const;

  /// The lean is believed to be another, by so much.
  void lean(const Lean& change);

  /// Begins a channel anew: its samples were of something else.
  void forget(Channel channel) { sums_[channel] = {}; }

  struct Slope {
    double value = 0.0;
    double variance = 0.0;
  };
  /// All channels together, for an edge that is as high everywhere.
  /// @return empty when they do not agree, or while none has a slope.
  std::optional<Slope> common(const LeanCovariance& P_lean, const Params& params) const;
  /// @return empty while the baseline is too short.
  std::optional<Slope> slope(Channel channel, const LeanCovariance& P_lean, const Params& params) const;

 private:
  /// A channel's slope as far as it is known for a given lean.
  struct Fit {
    double value = 0.0;
    double information = 0.0;
    LeanRow d_lean = LeanRow::Zero();

    Slope slope(const LeanCovariance& P_lean) const;
  };
  std::optional<Fit> fit(Channel channel, const Params& params) const;

  struct Sums {
    double w = 0, wb = 0, wbb = 0, ws = 0, wbs = 0;
    double low = 0, high = 0;
    int count = 0;
    // The newest sample, which may become better.
    double last_w = 0, last_b = 0, last_s = 0;
    double last_single_w = 0;
    int last_views = 0;
    LeanRow ds = LeanRow::Zero(), dbs = LeanRow::Zero(), last_ds = LeanRow::Zero();  ///< of ws, wbs, last_s
    void countIn(double weight);
  };
  std::array<Sums, 3> sums_;
};

}  // namespace vismem
