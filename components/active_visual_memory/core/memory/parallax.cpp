#include "active_visual_memory/core/memory/parallax.h"

#include <algorithm>
#include <cmath>

namespace vismem {

double ParallaxEstimate::Params::slopeLimit(double camera_height_m) const {
  return camera_height_m > least_height_m ? least_height_m / (camera_height_m - least_height_m) : 0.0;
}

void ParallaxEstimate::add(Channel channel, double baseline_m, double shift_m, const TiltJacobianRow& d_tilt,
                           double variance_m2, const Params& params) {
  Sums& sums = sums_[channel];
  Sample sample;
  sample << shift_m, d_tilt;
  const double w = 1.0 / (variance_m2 + params.sample_sigma_m * params.sample_sigma_m);
  if (sums.count > 0 && std::abs(baseline_m - sums.baseline_m) < params.min_step_m) {
    sums.addNewest(-sums.weight);
    const double known = sums.view_weight * sums.views;
    sums.newest = (known * sums.newest + w * sample) / (known + w);
    sums.view_weight = (known + w) / (sums.views + 1);
    ++sums.views;
    sums.weight = sums.view_weight * std::min(sums.views, params.views_per_place);
  } else {
    sums.low = sums.count == 0 ? baseline_m : std::min(sums.low, baseline_m);
    sums.high = sums.count == 0 ? baseline_m : std::max(sums.high, baseline_m);
    ++sums.count;
    sums.weight = sums.view_weight = w;
    sums.baseline_m = baseline_m;
    sums.newest = sample;
    sums.views = 1;
  }
  sums.addNewest(sums.weight);
}

void ParallaxEstimate::Sums::addNewest(double with_weight) {
  const Eigen::Vector2d h{1.0, baseline_m};
  normal += with_weight * h * h.transpose();
  right += with_weight * h * newest;
}

void ParallaxEstimate::applyTiltChange(const CameraTilt& change) {
  for (Sums& sums : sums_) {
    sums.right.col(0) += sums.right.rightCols<4>() * change;
    sums.newest[0] += sums.newest.tail<4>() * change;
  }
}

ParallaxEstimate::Slope ParallaxEstimate::Fit::given(const CameraTiltCovariance& P_tilt) const {
  const TiltJacobianRow d_tilt = slope.tail<4>();
  return {slope[0], 1.0 / information + d_tilt * P_tilt * d_tilt.transpose()};
}

std::optional<ParallaxEstimate::Fit> ParallaxEstimate::fit(Channel channel, const Params& params) const {
  const Sums& s = sums_[channel];
  if (s.count < 2 || s.high - s.low < params.min_baseline_m) return std::nullopt;
  const double mean = s.normal(0, 1) / s.normal(0, 0);
  const double spread = s.normal(1, 1) - mean * s.normal(0, 1);
  if (!(spread > 0.0)) return std::nullopt;
  return Fit{(mean * s.right.row(0) - s.right.row(1)) / spread, spread};
}

std::optional<ParallaxEstimate::Slope> ParallaxEstimate::slope(Channel channel,
                                                               const CameraTiltCovariance& P_tilt,
                                                               const Params& params) const {
  const auto found = fit(channel, params);
  if (!found) return std::nullopt;
  return found->given(P_tilt);
}

std::optional<ParallaxEstimate::Slope> ParallaxEstimate::common(const CameraTiltCovariance& P_tilt,
                                                                const Params& params) const {
  Fit all;
  for (const Channel channel : {kOffset, kEndA, kEndB}) {
    const auto one = fit(channel, params);
    if (!one) continue;
    all.slope += one->information * one->slope;
    all.information += one->information;
  }
  if (!(all.information > 0.0)) return std::nullopt;
  all.slope /= all.information;
  for (const Channel channel : {kOffset, kEndA, kEndB}) {
    const auto one = slope(channel, P_tilt, params);
    if (one && std::abs(one->value - all.slope[0]) > params.sigmas * std::sqrt(one->variance)) {
      return std::nullopt;
    }
  }
  return all.given(P_tilt);
}

ParallaxEstimate::Verdict ParallaxEstimate::verdict(double camera_height_m, bool not_vertical,
                                                    const CameraTiltCovariance& P_tilt,
                                                    const Params& params) const {
  const double limit = params.slopeLimit(camera_height_m);
  if (limit <= 0.0) return Verdict::kUnknown;
  const auto judgeSlope = [&](const std::optional<Slope>& k) {
    if (!k) return Verdict::kUnknown;
    const double margin = params.sigmas * std::sqrt(k->variance);
    if (std::abs(k->value) + margin < limit) return Verdict::kOnFloor;
    if (std::abs(k->value) - margin > limit) return Verdict::kOffFloor;
    return Verdict::kUnknown;
  };
  const auto judge = [&](Channel channel) { return judgeSlope(slope(channel, P_tilt, params)); };
  const auto offset = slope(kOffset, P_tilt, params);
  if (const Verdict sure = judgeSlope(offset); sure != Verdict::kUnknown) return sure;
  const Verdict a = judge(kEndA);
  const Verdict b = judge(kEndB);
  if (a == Verdict::kOffFloor || b == Verdict::kOffFloor) return Verdict::kOffFloor;
  // The line moves: an end that rests is probably that of another edge.
  if (offset && std::abs(offset->value) - std::sqrt(offset->variance) > limit) return Verdict::kUnknown;
  const int resting = (a == Verdict::kOnFloor) + (b == Verdict::kOnFloor);
  if (resting == 2 || (resting == 1 && not_vertical)) return Verdict::kOnFloor;
  return not_vertical ? judgeSlope(common(P_tilt, params)) : Verdict::kUnknown;
}

}  // namespace vismem
