#include "experiments/trials/lasting_error.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>

namespace vismem {
namespace {

constexpr double kAbout_s = 0.03;  // images come every 0.1 s
constexpr double kVarianceOfRanks = 1.0 / 3.0;

double meanOf(const std::vector<double>& values, const std::vector<std::size_t>& indices) {
  double sum = 0.0;
  for (const std::size_t index : indices) sum += values[index];
  return sum / static_cast<double>(indices.size());
}

}  // namespace

void LastingError::beginRun() {
  past_.clear();
  ++run_;
}

void LastingError::add(std::int64_t thing, double time_s, double error) {
  std::deque<Seen>& past = past_[thing];
  while (!past.empty() && past.front().time_s < time_s - kLags_s.back() - kAbout_s) past.pop_front();
  for (std::size_t lag = 0; lag < kLags_s.size(); ++lag) {
    const double at_s = time_s - kLags_s[lag];
    const auto before = std::lower_bound(past.begin(), past.end(), at_s - kAbout_s,
                                         [](const Seen& one, double time) { return one.time_s < time; });
    if (before == past.end() || before->time_s > at_s + kAbout_s) continue;
    pairs_[lag].emplace_back(before->index, errors_.size());
  }
  past.push_back({time_s, errors_.size()});
  indices_[{thing, run_}].push_back(errors_.size());
  errors_.push_back(error);
  sum_ += error;
  squares_ += error * error;
}

double LastingError::mean() const {
  return errors_.empty() ? 0.0 : sum_ / count();
}

double LastingError::standardDeviation() const {
  return errors_.empty() ? 0.0 : std::sqrt(std::max(0.0, squares_ / count() - mean() * mean()));
}

double LastingError::quantile(double share) const {
  if (errors_.empty()) return 0.0;
  std::vector<double> errors = errors_;
  const auto at =
      errors.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(errors.size() - 1));
  std::nth_element(errors.begin(), at, errors.end());
  return *at;
}

std::vector<double> LastingError::ranks() const {
  std::vector<std::size_t> order(errors_.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [this](std::size_t i, std::size_t j) { return errors_[i] < errors_[j]; });
  std::vector<double> ranks(errors_.size());
  const auto half = 0.5 * static_cast<double>(errors_.size());
  for (std::size_t i = 0; i < order.size();) {
    // Equal errors get their mean rank: ranks in order of time would look correlated.
    std::size_t end = i + 1;
    while (end < order.size() && errors_[order[end]] == errors_[order[i]]) ++end;
    const double rank = 0.5 * static_cast<double>(i + end) / half - 1.0;
    for (; i < end; ++i) ranks[order[i]] = rank;
  }
  return ranks;
}

double LastingError::correlation(std::size_t lag) const {
  const auto& pairs = pairs_.at(lag);
  if (pairs.empty() || !(standardDeviation() > 0.0)) return 0.0;
  const std::vector<double> rank = ranks();
  double products = 0.0;
  for (const auto& [before, after] : pairs) products += rank[before] * rank[after];
  return products / static_cast<double>(pairs.size()) / kVarianceOfRanks;
}

double LastingError::correlationBetweenRuns() const {
  if (!(standardDeviation() > 0.0)) return 0.0;
  const std::vector<double> rank = ranks();
  double products = 0.0;
  double weights = 0.0;
  for (auto one = indices_.begin(); one != indices_.end(); ++one) {
    for (auto other = std::next(one); other != indices_.end() && other->first.thing == one->first.thing;
         ++other) {
      const auto weight = std::min(one->second.size(), other->second.size());
      if (weight < kOftenSeen) continue;
      products += static_cast<double>(weight) * meanOf(rank, one->second) * meanOf(rank, other->second);
      weights += static_cast<double>(weight);
    }
  }
  return weights > 0.0 ? products / weights / kVarianceOfRanks : 0.0;
}

}  // namespace vismem
