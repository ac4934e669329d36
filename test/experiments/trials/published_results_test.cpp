// Tests L11.
#include "experiments/trials/published_results.h"

#include <gtest/gtest.h>

#include <limits>

namespace vismem {
namespace {

Figure figure(double value) {
  return {value, {value, value}};
}

TrialSummary summaryOf(double position_error_m, double heading_error_deg, double median_s) {
  TrialSummary summary;
  summary.position_error_m = figure(position_error_m);
  summary.heading_error_rad = figure(degToRad(heading_error_deg));
  summary.median_s = figure(median_s);
  return summary;
}

TEST(PublishedResults, EveryFigureMustBeBetter) {
  EXPECT_TRUE(isBetterThan(kPublishedKidnapping, summaryOf(0.148, 3.1, 29.5)));
  EXPECT_FALSE(isBetterThan(kPublishedKidnapping, summaryOf(0.150, 3.1, 29.5)));
  EXPECT_FALSE(isBetterThan(kPublishedKidnapping, summaryOf(0.148, 3.3, 29.5)));
  EXPECT_FALSE(isBetterThan(kPublishedKidnapping, summaryOf(0.148, 3.1, 29.7)));
}

TEST(PublishedResults, ARunWithoutKidnappingHasNoRecoveryTime) {
  EXPECT_TRUE(isBetterThan(kPublishedTravel, summaryOf(0.117, 2.0, std::numeric_limits<double>::infinity())));
  EXPECT_FALSE(isBetterThan(kPublishedTravel, summaryOf(0.119, 2.0, 0.0)));
}

TEST(PublishedResults, WithoutARecoveredEventNothingIsBetter) {
  EXPECT_FALSE(isBetterThan(kPublishedTravel, {}));
  TrialSummary never = summaryOf(0.01, 0.1, 1.0);
  never.median_s.reset();
  EXPECT_FALSE(isBetterThan(kPublishedKidnapping, never));
}

}  // namespace
}  // namespace vismem
