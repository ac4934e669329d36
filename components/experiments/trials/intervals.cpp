#include "experiments/trials/intervals.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "localization/core/random_engine.h"

namespace vismem {
namespace {

constexpr double kQuantile95 = 1.959964;  // two-sided, of a standard normal

}  // namespace

Interval wilsonInterval(int hits, int count) {
  const double n = count;
  const double p = hits / n;
  const double z2 = kQuantile95 * kQuantile95;
  const double centre = (p + z2 / (2.0 * n)) / (1.0 + z2 / n);
  const double half = kQuantile95 / (1.0 + z2 / n) * std::sqrt(p * (1.0 - p) / n + z2 / (4.0 * n * n));
  return {std::max(0.0, centre - half), std::min(1.0, centre + half)};
}

std::optional<double> quantile(std::vector<double> values, double q) {
  if (values.empty()) return std::nullopt;
  std::sort(values.begin(), values.end());
  const double at = std::clamp(q, 0.0, 1.0) * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(at);
  const double fraction = at - static_cast<double>(below);
  // An infinite neighbour needs a case of its own: zero times infinity is not a number.
  if (fraction == 0.0) return values[below];
  return std::isinf(values[below + 1]) ? values[below + 1]
                                       : values[below] + fraction * (values[below + 1] - values[below]);
}

std::optional<double> mean(const std::vector<double>& values) {
  if (values.empty()) return std::nullopt;
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

std::optional<Interval> bootstrapInterval(
    const std::vector<std::vector<double>>& groups,
    const std::function<std::optional<double>(const std::vector<double>&)>& statistic, std::uint64_t seed,
    int draws) {
  if (groups.empty()) return std::nullopt;
  RandomEngine engine(seed);
  std::vector<double> results;
  for (int draw = 0; draw < draws; ++draw) {
    std::vector<double> sample;
    for (std::size_t i = 0; i < groups.size(); ++i) {
      const auto& group = groups[pick(engine, groups.size())];
      sample.insert(sample.end(), group.begin(), group.end());
    }
    if (const auto result = statistic(sample)) results.push_back(*result);
  }
  if (results.empty()) return std::nullopt;
  return Interval{*quantile(results, 0.025), *quantile(results, 0.975)};
}

}  // namespace vismem
