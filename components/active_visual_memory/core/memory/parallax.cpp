#include "active_visual_memory/core/memory/parallax.h"

#include <algorithm>
#include <cmath>

namespace vismem {

void ParallaxEstimate::add(Channel channel, double baseline_m, double shift_m, const TiltJacobianRow& d_tilt,
                           double variance_m2, const Params& params) {
  Sums& sums = sums_[channel];
  const double w = 1.0 / (variance_m2 + params.sample_sigma_m * params.sample_sigma_m);
  if (sums.count > 0 && std::abs(baseline_m - sums.last_b) < params.min_step_m) {
    sums.countIn(-sums.last_w);
    const double known = sums.last_single_w * sums.last_views;
    sums.last_s = (known * sums.last_s + w * shift_m) / (known + w);
    sums.last_ds = (known * sums.last_ds + w * d_tilt) / (known + w);
    sums.last_single_w = (known + w) / (sums.last_views + 1);
    ++sums.last_views;
    sums.last_w = sums.last_single_w * std::min(sums.last_views, params.views_per_place);
  } else {
    sums.low = sums.count == 0 ? baseline_m : std::min(sums.low, baseline_m);
    sums.high = sums.count == 0 ? baseline_m : std::max(sums.high, baseline_m);
    ++sums.count;
    sums.last_w = sums.last_single_w = w;
    sums.last_b = baseline_m;
    sums.last_s = shift_m;
    sums.last_ds = d_tilt;
    sums.last_views = 1;
  }
  sums.countIn(sums.last_w);
}

void ParallaxEstimate::Sums::countIn(double weight) {
  const double b = last_b;
  w += weight;
  wb += weight * b;
  wbb += weight * b * b;
  ws += weight * last_s;
  wbs += weight * b * last_s;
  ds += weight * last_ds;
  dbs += weight * b * last_ds;
}

void ParallaxEstimate::applyTiltChange(const CameraTilt& change) {
  for (Sums& sums : sums_) {
    sums.ws += sums.ds * change;
    sums.wbs += sums.dbs * change;
    sums.last_s += sums.last_ds * change;
  }
}

ParallaxEstimate::Slope ParallaxEstimate::Fit::slope(const CameraTiltCovariance& P_tilt) const {
  return {value, 1.0 / information + d_tilt * P_tilt * d_tilt.transpose()};
}

std::optional<ParallaxEstimate::Fit> ParallaxEstimate::fit(Channel channel, const Params& params) const {
  const Sums& s = sums_[channel];
  if (s.count < 2 || s.high - s.low < params.min_baseline_m) return std::nullopt;
  const double spread = s.wbb - s.wb * s.wb / s.w;
  if (!(spread > 0.0)) return std::nullopt;
  return Fit{-(s.wbs - s.wb * s.ws / s.w) / spread, spread, (s.dbs - s.wb / s.w * s.ds) / spread};
}

std::optional<ParallaxEstimate::Slope> ParallaxEstimate::slope(Channel channel,
                                                               const CameraTiltCovariance& P_tilt,
                                                               const Params& params) const {
  const auto found = fit(channel, params);
  if (!found) return std::nullopt;
  return found->slope(P_tilt);
}

std::optional<ParallaxEstimate::Slope> ParallaxEstimate::common(const CameraTiltCovariance& P_tilt,
                                                                const Params& params) const {
  Fit all;
  for (const Channel channel : {kOffset, kEndA, kEndB}) {
    const auto one = fit(channel, params);
    if (!one) continue;
    all.value += one->information * one->value;
    all.d_tilt += one->information * one->d_tilt;
    all.information += one->information;
  }
  if (!(all.information > 0.0)) return std::nullopt;
  all.value /= all.information;
  all.d_tilt /= all.information;
  for (const Channel channel : {kOffset, kEndA, kEndB}) {
    const auto one = slope(channel, P_tilt, params);
    if (one && std::abs(one->value - all.value) > params.sigmas * std::sqrt(one->variance)) {
      return std::nullopt;
    }
  }
  return all.slope(P_tilt);
}

ParallaxEstimate::Verdict ParallaxEstimate::verdict(double camera_height_m, bool not_vertical,
                                                    const CameraTiltCovariance& P_tilt,
                                                    const Params& params) const {
  if (camera_height_m <= params.least_height_m) return Verdict::kUnknown;
  const double limit = params.least_height_m / (camera_height_m - params.least_height_m);
  const auto judgeSlope = [&](const std::optional<Slope>& k) {
    if (!k) return Verdict::kUnknown;
    const double margin = params.sigmas * std::sqrt(k->variance);
    if (std::abs(k->value) + margin < limit) return Verdict::kOnFloor;
    if (std::abs(k->value) - margin > limit) return Verdict::kOffFloor;
    return Verdict::kUnknown;
  };
  const auto judge = [&](Channel channel) { return judgeSlope(slope(channel, P_tilt, params)); };
  const Verdict offset = judge(kOffset);
  if (offset != Verdict::kUnknown) return offset;
  const Verdict a = judge(kEndA);
  const Verdict b = judge(kEndB);
  if (a == Verdict::kOffFloor || b == Verdict::kOffFloor) return Verdict::kOffFloor;
  const int resting = (a == Verdict::kOnFloor) + (b == Verdict::kOnFloor);
  if (resting == 2 || (resting == 1 && not_vertical)) return Verdict::kOnFloor;
  return not_vertical ? judgeSlope(common(P_tilt, params)) : Verdict::kUnknown;
}

}  // namespace vismem
