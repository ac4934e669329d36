/// @file Autocorrelation of an error over repeated observations of the same thing. Pure. See E5, E6, E7, E8.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <utility>
#include <vector>

namespace vismem {

/// Mean, spread, quantiles and autocorrelation of an error over many things that are seen repeatedly, in one
/// or several runs. Correlations are Spearman's (of ranks), because a few outliers would dominate others.
/// *Single-threaded*.
class LastingError {
 public:
  static constexpr std::array<double, 4> kLags_s{0.1, 1.0, 3.0, 10.0};

  /// Begins another run, with its own time.
  void beginRun();
  /// @param thing the error belongs to it.
  /// @param time_s increases for each thing within a run.
  void add(std::int64_t thing, double time_s, double error);

  int count() const { return static_cast<int>(errors_.size()); }
  double mean() const;
  double standardDeviation() const;
  /// The quantile of this share; 0 without errors.
  double quantile(double share) const;
  /// Correlation of errors of one thing that lie kLags_s[lag] apart; 0 without such pairs.
  double correlation(std::size_t lag) const;
  /// Correlation of errors of one thing in different runs: the share that belongs to the thing itself, such
  /// as a map error. Things seen fewer than kOftenSeen times in a run are left out; 0 without such pairs.
  double correlationBetweenRuns() const;

 private:
  static constexpr int kOftenSeen = 10;
  struct Seen {
    double time_s;
    std::size_t index;  ///< among the errors
  };
  struct ThingInRun {
    std::int64_t thing;
    int run;
    bool operator<(const ThingInRun& other) const {
      return thing != other.thing ? thing < other.thing : run < other.run;
    }
  };

  /// The rank of each error as a number from -1 to 1.
  std::vector<double> ranks() const;

  std::map<std::int64_t, std::deque<Seen>> past_;  ///< of this run
  std::array<std::vector<std::pair<std::size_t, std::size_t>>, kLags_s.size()> pairs_;
  std::map<ThingInRun, std::vector<std::size_t>> indices_;
  int run_ = 0;
  std::vector<double> errors_;
  double sum_ = 0.0;
  double squares_ = 0.0;
};

}  // namespace vismem
