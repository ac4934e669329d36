#include "active_visual_memory/core/slip_detector.h"

#include <cmath>

namespace vismem {

std::optional<SlipDetector::Slip> SlipDetector::add(StampUs stamp_us, double deviation_rad,
                                                    double variance_rad2, const Params& params) {
  told_.push_back({stamp_us, deviation_rad, 1.0 / variance_rad2});
  if (static_cast<int>(told_.size()) > params.images) told_.pop_front();
  // The slip lies somewhere between the images: the latest of them, as many as tell of it most surely.
  double information = 0.0;
  double sum = 0.0;
  double most = params.sigmas;
  int images = 0;
  std::optional<Slip> slip;
  for (auto told = told_.rbegin(); told != told_.rend(); ++told) {
    information += told->information;
    sum += told->information * told->deviation_rad;
    const double mean = sum / information;
    const double sigmas = std::abs(mean) * std::sqrt(information);
    if (++images < params.least_images || sigmas <= most || std::abs(mean) < params.least_rad) continue;
    most = sigmas;
    slip = Slip{mean, 1.0 / std::sqrt(information), told->stamp_us};
  }
  if (slip) reset();
  return slip;
}

}  // namespace vismem
