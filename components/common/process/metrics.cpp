#include "common/process/metrics.h"

#include <algorithm>
#include <cmath>

namespace vismem {

void RateCounter::count(SteadyTime now) {
  if (total_++ == 0) start_ = now;
  events_.push_back(now);
  while (events_.size() > kMaxEvents || events_.front() < now - window_) events_.pop_front();
}

double RateCounter::hz(SteadyTime now) const {
  const auto first = std::upper_bound(events_.begin(), events_.end(), now - window_);
  const auto count = static_cast<double>(events_.end() - first);
  if (count == 0) return 0.0;
  const bool overfull = first == events_.begin() && events_.size() == kMaxEvents;
  if (now - start_ >= window_ && !overfull) return count / std::chrono::duration<double>(window_).count();
  // The span begins with an event, which is not part of it.
  const double span_s = std::chrono::duration<double>(now - *first).count();
  return span_s > 0.0 ? (count - 1) / span_s : 0.0;
}

void LatencyHistogram::add(SteadyTime now, double duration_s) {
  const int recent = current_.samples + previous_.samples == 0 ? 0 : recentHalves(now);
  if (recent < 2) {
    previous_ = recent == 1 ? current_ : Half{};
    current_ = Half{};
    begin_ = now;
  }
  const double bucket = std::floor(kBucketsPerOctave * std::log2(duration_s / kShortest_s));
  const bool measurable = duration_s > kShortest_s;  // false for NaN
  const auto index = measurable
                         ? static_cast<std::size_t>(std::min(bucket, static_cast<double>(kBuckets - 1)))
                         : std::size_t{0};
  ++current_.counts[index];
  ++current_.samples;
  if (measurable) current_.max_s = std::max(current_.max_s, duration_s);
}

int LatencyHistogram::recentHalves(SteadyTime now) const {
  const auto age = now - begin_;
  return age < half_window_ ? 2 : age < 2 * half_window_ ? 1 : 0;
}

LatencyHistogram::Figures LatencyHistogram::figures(SteadyTime now) const {
  const int recent = recentHalves(now);
  std::array<std::int64_t, kBuckets> counts{};
  Figures figures;
  const auto take = [&](const Half& half) {
    for (std::size_t i = 0; i < kBuckets; ++i) counts[i] += half.counts[i];
    figures.samples += half.samples;
    figures.max_s = std::max(figures.max_s, half.max_s);
  };
  if (recent >= 1) take(current_);
  if (recent == 2) take(previous_);
  if (figures.samples == 0) return {};
  const auto percentile = [&](double share) {
    const auto rank = static_cast<std::int64_t>(std::ceil(share * static_cast<double>(figures.samples)));
    std::int64_t seen = 0;
    for (std::size_t i = 0; i < kBuckets; ++i) {
      seen += counts[i];
      if (seen < rank) continue;
      const double middle_s = kShortest_s * std::exp2((static_cast<double>(i) + 0.5) / kBucketsPerOctave);
      return std::min(middle_s, figures.max_s);
    }
    return figures.max_s;
  };
  figures.p50_s = percentile(0.50);
  figures.p95_s = percentile(0.95);
  figures.p99_s = percentile(0.99);
  return figures;
}

}  // namespace vismem
