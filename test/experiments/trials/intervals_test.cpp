#include "experiments/trials/intervals.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "experiments/trials/gaussian.h"

namespace vismem {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(WilsonInterval, GivesTheTextbooksValues) {
  // 8 of 10: centre (0.8 + 3.8415 / 20) / 1.38415 = 0.71674, half 1.95996 / 1.38415 x sqrt(0.016 + 0.0096037)
  // = 0.22658.
  const Interval eight = wilsonInterval(8, 10);
  EXPECT_NEAR(eight.low, 0.4902, 1e-3);
  EXPECT_NEAR(eight.high, 0.9433, 1e-3);
}

TEST(WilsonInterval, IsNoPointWhenAllOrNoneSucceed) {
  // The lower border of n of n is n / (n + z^2): 200 / 203.84.
  EXPECT_NEAR(wilsonInterval(200, 200).low, 0.98116, 1e-4);
  EXPECT_DOUBLE_EQ(wilsonInterval(200, 200).high, 1.0);
  EXPECT_DOUBLE_EQ(wilsonInterval(0, 24).low, 0.0);
  EXPECT_NEAR(wilsonInterval(0, 24).high, 3.8415 / 27.8415, 1e-4);
}

TEST(Quantile, InterpolatesBetweenNeighbours) {
  EXPECT_DOUBLE_EQ(*quantile({4.0, 1.0, 3.0, 2.0}, 0.5), 2.5);
  EXPECT_DOUBLE_EQ(*quantile({1.0, 2.0, 3.0}, 0.9), 2.8);
  EXPECT_DOUBLE_EQ(*quantile({5.0}, 0.9), 5.0);
  EXPECT_FALSE(quantile({}, 0.5));
}

TEST(Quantile, EventsThatNeverRecoverMakeItInfiniteOnlyWhereItReachesThem) {
  const std::vector<double> times{1.0, 2.0, 3.0, kInfinity};
  EXPECT_DOUBLE_EQ(*quantile(times, 0.5), 2.5);
  EXPECT_TRUE(std::isinf(*quantile(times, 0.9)));
  EXPECT_DOUBLE_EQ(*quantile({1.0, 2.0, kInfinity}, 0.5), 2.0);
}

TEST(Bootstrap, CoversTheTrueMeanAboutAsOftenAsItSays) {
  RandomEngine engine(5);
  int covered = 0;
  constexpr int kRepeats = 200;
  for (int repeat = 0; repeat < kRepeats; ++repeat) {
    std::vector<std::vector<double>> groups;
    for (int i = 0; i < 40; ++i) groups.push_back({3.0 + standardNormal(engine)});
    const auto interval = bootstrapInterval(groups, mean, static_cast<std::uint64_t>(repeat) + 1, 400);
    ASSERT_TRUE(interval);
    if (interval->low <= 3.0 && 3.0 <= interval->high) ++covered;
  }
  // 95 % of 200 is 190; the percentile interval is a little short, and chance adds 3 either way.
  EXPECT_GE(covered, 178);
  EXPECT_LE(covered, 199);
}

TEST(Bootstrap, EventsOfOneRunAreNotIndependent) {
  // Ten runs of five equal events: as sure as ten events, not as fifty.
  std::vector<std::vector<double>> runs;
  std::vector<std::vector<double>> singles;
  RandomEngine engine(9);
  for (int i = 0; i < 10; ++i) {
    const double value = standardNormal(engine);
    runs.push_back(std::vector<double>(5, value));
    for (int k = 0; k < 5; ++k) singles.push_back({value});
  }
  const Interval by_run = *bootstrapInterval(runs, mean, 1);
  const Interval by_event = *bootstrapInterval(singles, mean, 1);
  EXPECT_GT(by_run.high - by_run.low, 1.7 * (by_event.high - by_event.low));
}

TEST(Bootstrap, SaysNothingOfNothing) {
  EXPECT_FALSE(bootstrapInterval({}, mean, 1));
}

}  // namespace
}  // namespace vismem
