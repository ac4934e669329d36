/// @file How sure a figure is: 95 % intervals of shares and of quantiles. Pure. PEERS; research 6, G13.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

namespace vismem {

struct Interval {
  double low = 0.0;
  double high = 0.0;

  bool overlaps(const Interval& other) const { return low <= other.high && other.low <= high; }
};

/// Wilson's interval of a share, 95 %. @param count > 0, 0 <= hits <= count.
Interval wilsonInterval(int hits, int count);

/// The q-quantile, linear between neighbours of the sorted values; infinite values are allowed (they sort
/// last; a quantile that touches one is infinite). Empty for no values.
std::optional<double> quantile(std::vector<double> values, double q);
std::optional<double> mean(const std::vector<double>& values);

/// 95 % interval by the bootstrap's percentiles, over groups drawn whole with replacement: events of one run
/// share its odometry and its seed and are not independent of each other.
/// @param groups none may be empty. @param statistic of the joined values; empty results are left out.
/// @return empty for no groups, or where no draw has a result.
std::optional<Interval> bootstrapInterval(
    const std::vector<std::vector<double>>& groups,
    const std::function<std::optional<double>(const std::vector<double>&)>& statistic, std::uint64_t seed,
    int draws = 1000);

}  // namespace vismem
