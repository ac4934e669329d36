#include "active_visual_memory/core/estimation/slip.h"

#include <cmath>

namespace vismem {

std::optional<SlipDetector::Slip> SlipDetector::add(StampUs stamp_us, double deviation_rad,
                                                    double variance_rad2, const Params& params) {
  deviations_.push_back({stamp_us, deviation_rad, 1.0 / variance_rad2});
  if (static_cast<int>(deviations_.size()) > params.images) deviations_.erase(deviations_.begin());
  // The slip lies between two images: of all runs of latest images, the most significant mean.
  double information = 0.0;
  double sum = 0.0;
  double most = params.sigmas;
  int images = 0;
  std::optional<Slip> slip;
  for (auto deviation = deviations_.rbegin(); deviation != deviations_.rend(); ++deviation) {
    information += deviation->information;
    sum += deviation->information * deviation->deviation_rad;
    const double mean = sum / information;
    const double sigmas = std::abs(mean) * std::sqrt(information);
    if (++images < params.least_images || sigmas <= most || std::abs(mean) < params.least_rad) continue;
    most = sigmas;
    slip = Slip{mean, 1.0 / std::sqrt(information), deviation->stamp_us};
  }
  if (slip) reset();
  return slip;
}

}  // namespace vismem
