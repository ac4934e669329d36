/// @file Rates and latencies of a running component. Pure: the time is passed in. Single-threaded
/// (StatusBoard guards them).
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>

namespace vismem {

using SteadyTime = std::chrono::steady_clock::time_point;

/// Events per second over the last seconds, and their number since the start.
class RateCounter {
 public:
  explicit RateCounter(std::chrono::milliseconds window = std::chrono::seconds(5)) : window_(window) {}

  void count(SteadyTime now);
  /// @return events within the window (or since the first event, if that is less long ago) per second;
  ///         0 before the second event and when the window holds none.
  double hz(SteadyTime now) const;
  std::int64_t total() const { return total_; }

 private:
  /// Maximum number of kept events, which bounds the memory; at higher rates the window is their time span.
  static constexpr std::size_t kMaxEvents = 2048;

  std::chrono::nanoseconds window_;
  std::deque<SteadyTime> events_;
  SteadyTime start_{};
  std::int64_t total_ = 0;
};

/// Percentiles of durations over the last half to whole minute, in buckets 9 % wide: a percentile is right
/// within 5 %, the maximum exactly. Constant memory. Durations from 1 us to 100 s; others count at the ends.
class LatencyHistogram {
 public:
  explicit LatencyHistogram(std::chrono::milliseconds half_window = std::chrono::seconds(30))
      : half_window_(half_window) {}

  /// Takes one duration [s]; a negative or NaN one counts as the shortest.
  void add(SteadyTime now, double duration_s);

  struct Figures {
    std::int64_t samples = 0;
    double p50_s = 0;
    double p95_s = 0;
    double p99_s = 0;
    double max_s = 0;
  };
  /// Percentiles and maximum; all 0 without samples.
  Figures figures(SteadyTime now) const;

 private:
  static constexpr int kBucketsPerOctave = 8;
  static constexpr double kShortest_s = 1e-6;
  static constexpr std::size_t kBuckets = 27 * kBucketsPerOctave;  // 2^27 us > 100 s

  struct Half {
    std::array<std::int32_t, kBuckets> counts{};
    std::int64_t samples = 0;
    double max_s = 0;
  };
  /// @return how many of the halves (current, previous) are still recent.
  int recentHalves(SteadyTime now) const;

  std::chrono::nanoseconds half_window_;
  SteadyTime begin_{};
  Half current_;
  Half previous_;
};

}  // namespace vismem
