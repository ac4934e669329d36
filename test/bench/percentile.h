/// @file Percentiles for the tables.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace vismem {

/// @param share share of the values below the percentile: 0.5 is the median.
/// @return 0 without values.
inline double percentile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace vismem
