/// @file How long an error lasts: one that is seen again and again does not average out. Pure. SPEC E5-E8.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <vector>

namespace vismem {

/// Mean, spread, tails and autocorrelation of an error over many things that are seen again and again.
/// *Single-threaded*.
class LastingError {
 public:
  static constexpr std::array<double, 4> kLags_s{0.1, 1.0, 3.0, 10.0};

  /// @param thing whose error it is. @param time_s increases for each thing.
  void add(std::int64_t thing, double time_s, double error);

  int count() const { return count_; }
  double mean() const;
  double standardDeviation() const;
  /// So far from their median is this share of the errors at most: how heavy the tails are. 0 without errors.
  double within(double share) const;
  /// Correlation of errors of one thing that lie kLags_s[lag] apart; 0 before there were any.
  double correlation(std::size_t lag) const;

 private:
  struct Seen {
    double time_s;
    double error;
  };
  struct Pairs {
    int count = 0;
    double products = 0.0;
    double sums = 0.0;  ///< of both errors of each pair
  };
  std::map<std::int64_t, std::deque<Seen>> past_;
  std::array<Pairs, kLags_s.size()> pairs_{};
  std::vector<double> errors_;
  int count_ = 0;
  double sum_ = 0.0;
  double squares_ = 0.0;
};

}  // namespace vismem
