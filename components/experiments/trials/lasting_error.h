/// @file How long an error lasts: one that is seen again and again does not average out. Pure. SPEC E5-E8.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <utility>
#include <vector>

namespace vismem {

/// Mean, spread and quantiles of an error over many things that are seen again and again, in one or several
/// runs, and how much it is the same again. Correlations are Spearman's: of ranks among all errors, because a
/// few errors that are far off would hide what the others do. *Single-threaded*.
class LastingError {
 public:
  static constexpr std::array<double, 4> kLags_s{0.1, 1.0, 3.0, 10.0};

  /// What follows is of another run, whose time begins anew.
  void beginRun();
  /// @param thing whose error it is. @param time_s increases for each thing within a run.
  void add(std::int64_t thing, double time_s, double error);

  int count() const { return static_cast<int>(errors_.size()); }
  double mean() const;
  double standardDeviation() const;
  /// This share of the errors is at most so large. 0 without errors.
  double quantile(double share) const;
  /// Correlation of errors of one thing that lie kLags_s[lag] apart; 0 before there were any.
  double correlation(std::size_t lag) const;
  /// Correlation of errors of one thing in different runs: what belongs to the thing itself, as an error of
  /// the map does. Things seen fewer than kOftenSeen times in a run are left out of it; 0 before there were
  /// any.
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

  /// Of each error, its rank as a number from -1 to 1.
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
