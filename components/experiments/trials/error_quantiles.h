/// @file A measured distribution of errors, given by its quantiles. Pure. See E5, E6, E7, E8.
#pragma once

#include <array>
#include <cstddef>

namespace vismem {

struct ErrorQuantiles {
  static constexpr std::array<double, 11> kShares{0.002, 0.01, 0.05, 0.1,  0.25, 0.5,
                                                  0.75,  0.9,  0.95, 0.99, 0.998};
  /// Increasing; the share kShares[i] of the errors is at most px[i].
  std::array<double, kShares.size()> px{};

  /// The quantile of a share, linear between the stored ones and constant beyond the outermost.
  constexpr double at(double share) const {
    if (share <= kShares.front()) return px.front();
    for (std::size_t i = 1; i < kShares.size(); ++i) {
      if (share > kShares[i]) continue;
      const double part = (share - kShares[i - 1]) / (kShares[i] - kShares[i - 1]);
      return px[i - 1] + part * (px[i] - px[i - 1]);
    }
    return px.back();
  }
};

}  // namespace vismem
