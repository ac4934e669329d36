#include "experiments/trials/lasting_error.h"

#include <algorithm>
#include <cmath>

namespace vismem {
namespace {

constexpr double kAbout_s = 0.03;  // images come every 0.1 s

double quantile(std::vector<double> values, double share) {
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace

void LastingError::add(std::int64_t thing, double time_s, double error) {
  std::deque<Seen>& past = past_[thing];
  while (!past.empty() && past.front().time_s < time_s - kLags_s.back() - kAbout_s) past.pop_front();
  for (std::size_t lag = 0; lag < kLags_s.size(); ++lag) {
    const double at_s = time_s - kLags_s[lag];
    const auto before = std::lower_bound(past.begin(), past.end(), at_s - kAbout_s,
                                         [](const Seen& one, double time) { return one.time_s < time; });
    if (before == past.end() || before->time_s > at_s + kAbout_s) continue;
    ++pairs_[lag].count;
    pairs_[lag].products += before->error * error;
    pairs_[lag].sums += before->error + error;
  }
  past.push_back({time_s, error});
  errors_.push_back(error);
  ++count_;
  sum_ += error;
  squares_ += error * error;
}

double LastingError::mean() const {
  return count_ > 0 ? sum_ / count_ : 0.0;
}

double LastingError::standardDeviation() const {
  return count_ > 0 ? std::sqrt(std::max(0.0, squares_ / count_ - mean() * mean())) : 0.0;
}

double LastingError::within(double share) const {
  if (errors_.empty()) return 0.0;
  const double median = quantile(errors_, 0.5);
  std::vector<double> off;
  off.reserve(errors_.size());
  for (const double error : errors_) off.push_back(std::abs(error - median));
  return quantile(std::move(off), share);
}

double LastingError::correlation(std::size_t lag) const {
  const Pairs& pairs = pairs_.at(lag);
  const double variance = standardDeviation() * standardDeviation();
  if (pairs.count == 0 || !(variance > 0.0)) return 0.0;
  return (pairs.products / pairs.count - mean() * pairs.sums / pairs.count + mean() * mean()) / variance;
}

}  // namespace vismem
