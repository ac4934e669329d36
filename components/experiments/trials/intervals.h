/// @file 95 % intervals of shares (Wilson) and of other statistics (Efron's bootstrap). Pure.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

namespace vismem {

struct Interval {
  double low = 0.0;
  double high = 0.0;
};

/// Wilson's score interval of a share, 95 %.
/// @param count above 0; 0 <= hits <= count.
Interval wilsonInterval(int hits, int count);

/// The q-quantile, linear between neighbours of the sorted values. Infinite values are allowed: a quantile
/// next to one is infinite.
/// @return empty for no values.
std::optional<double> quantile(std::vector<double> values, double q);
std::optional<double> mean(const std::vector<double>& values);

/// 95 % interval by the percentiles of a bootstrap over whole groups: events of one run share its odometry
/// and seed, so they are not independent.
/// @param groups none may be empty.
/// @param statistic of the joined values; empty results are left out.
/// @return empty without groups, or when no draw has a result.
std::optional<Interval> bootstrapInterval(
    const std::vector<std::vector<double>>& groups,
    const std::function<std::optional<double>(const std::vector<double>&)>& statistic, std::uint64_t seed,
    int draws = 1000);

}  // namespace vismem
